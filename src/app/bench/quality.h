// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "image/image.h"
#include "render/settings.h"
#include "scene/scene.h"
#include "trace/trace_scene.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace isophote::bench {

/// One way to make a picture: settings as --set takes them.
struct QualityWay {
  std::string name;
  std::vector<std::string> assignments;
  /// More of them, each tried besides the way as it is; the one whose picture is best at the end is told.
  std::vector<std::string> variants = {};
};

/// The ways that are measured unless one is given: what suits little time, then every estimator.
const std::vector<QualityWay>& qualityWays();

/// A picture after so many passes.
struct QualityPoint {
  std::uint32_t passes = 0;
  double seconds = 0;           ///< Of rendering, from the first photon on, without loading and comparing.
  double processorSeconds = 0;  ///< The same of all threads together: bears a machine with other work.
  double psnr = 0;              ///< [dB], as `compare` judges.
  std::optional<double> flip;   ///< Judged where a tenth more time has gone by than at the one before.
};

/// How pictures are judged: the path-traced one that they are compared with.
struct QualityBench {
  std::uint32_t width = 512, height = 512;
  std::uint32_t spp = 1024;          ///< Of the path-traced picture.
  double seconds = 5;                ///< Of rendering, for each way.
  std::filesystem::path references;  ///< Keeps path-traced pictures; empty: none are kept.
};

/// The converged picture with a box filter over the pixels: path-traced, or from the folder of references
/// where one of the same scene, size, bounces and paths lies there.
Image convergedPicture(const Scene& scene, const std::string& name, const Camera& camera,
                       const QualityBench& bench, std::uint32_t bounces, const Job& job);

/// Adds passes for so long as `bench` says, and judges the picture after each; the last one is in `last`.
std::vector<QualityPoint> convergence(const TraceScene& trace, const Camera& camera,
                                      const RenderSettings& settings, double seconds, const Image& reference,
                                      Image& last, const Job& job);

/// The last picture that was done by then; nothing before the first.
std::optional<double> psnrAt(const std::vector<QualityPoint>& points, double seconds);
/// When the picture first was that good.
std::optional<double> secondsTo(const std::vector<QualityPoint>& points, double psnr);
/// When FLIP first was that low.
std::optional<double> secondsToFlip(const std::vector<QualityPoint>& points, double flip);

}  // namespace isophote::bench

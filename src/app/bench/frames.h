// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/samples.h"
#include "app/bench/suite.h"
#include "base/stats.h"
#include "image/image.h"
#include "render/settings.h"
#include "scene/scene.h"
#include "trace/trace_scene.h"

#include <string>
#include <utility>
#include <vector>

namespace isophote::bench {

/// Frames of one renderer, one after the other as a program shows them: everything is computed anew in each,
/// in the memory of the one before. No layers, nothing loaded or written.
struct FrameTimes {
  Samples clockMs;
  Samples processorMs;    ///< Of all threads together.
  Samples primaryRaysMs;  ///< The yardstick: Embree alone on the primary rays, after each frame.
  std::vector<std::pair<std::string, Samples>> stagesMs;  ///< By the clock, in the frame's order.
  Stats last;                                             ///< Counters and bytes are those of the last frame.
  Film film;

  /// Of a stage; empty samples where it did not run.
  const Samples& stage(std::string_view name) const;
  /// The sum of the medians of several stages [ms].
  double stagesMedian(std::initializer_list<std::string_view> names) const;
  /// The frame's median over the yardstick's.
  double overPrimaryRays() const { return clockMs.median() / primaryRaysMs.median(); }
};

FrameTimes measureFrames(Context& context, const TraceScene& trace, const Camera& camera,
                         const RenderSettings& settings, std::uint32_t mostRepeats = 1000);

/// The mean of so many progressive passes by `tiles` with those photons, bounces and size: what pictures are
/// judged by where the path tracer finds no way to the lights (caustics of lights without extent).
Image convergedByPhotons(Context& context, const TraceScene& trace, const Camera& camera,
                         const RenderSettings& like, std::uint32_t photons, std::uint32_t passes);

/// What Embree alone takes for the primary rays of such a picture, in packets, on all threads [ms].
double primaryRaysMs(const TraceScene& trace, const Camera& camera, std::uint32_t width,
                     std::uint32_t height);

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of the photon mapper against the path tracer share: means with their deviations, and the
// extrapolation of a picture's mean to radius 0.
#pragma once

#include "image/compare.h"
#include "render/cpu_frame.h"
#include "render/reference.h"
#include "support/files.h"
#include "support/images.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace isophote {

/// A picture small enough to be traced in seconds, at radii small enough that the bias is nearly linear in
/// them.
struct Case {
  std::string scene;
  std::uint32_t width, height;
  std::uint32_t spp;      ///< Of the reference.
  std::uint32_t photons;  ///< Emitted, for each of the seeds.
  std::uint32_t seeds;
  float radius;  ///< The larger of the two [m].
};

struct Mean {
  double value;
  double deviation;  ///< Standard deviation of `value`.
};

inline double meanOfImage(const Image& image) {
  double sum = 0;
  for (const vec3& p : image.pixels) sum += double(p.x) + double(p.y) + double(p.z);
  return sum / (3.0 * double(image.pixels.size()));
}

inline Mean meanOfReference(const Film& film) {
  const Image& variance = film.layers.at("variance");
  // The channels of a path go together: the mean of their deviations bounds that of their mean.
  double sum = 0;
  for (const vec3& v : variance.pixels) {
    const double deviation = (std::sqrt(double(v.x)) + std::sqrt(double(v.y)) + std::sqrt(double(v.z))) / 3.0;
    sum += deviation * deviation;
  }
  return {meanOfImage(film.colour), std::sqrt(sum) / double(variance.pixels.size())};
}

inline Film reference(const TraceScene& trace, const Case& c) {
  ReferenceSettings settings;
  settings.width = c.width;
  settings.height = c.height;
  settings.spp = c.spp;
  settings.aa = 1;
  settings.indirectOnly = true;
  Stats stats;
  return renderReference(trace.scene(), trace.scene().cameras.front(), settings, stats);
}

/// Sums of one quantity over independent seeds.
struct Trials {
  double sum = 0;
  double squares = 0;
  std::uint32_t count = 0;

  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  Mean mean() const {
    const double n = count;
    const double mean = sum / n;
    return {mean, std::sqrt(std::max(squares / n - mean * mean, 0.0) / (n - 1.0))};
  }
};

/// Within 0.5 % of the reference. The test could not tell if its own noise were as large: it must be below
/// 0.3 %, or, where `noisy` scenes would take minutes for that, below 0.6 %, of which twice is then allowed
/// for.
inline void expectMeanAgrees(const Case& c, const char* estimator, const Mean& mean, const Mean& expected,
                             bool noisy = false) {
  const double ratio = mean.value / expected.value;
  const double deviation = std::hypot(mean.deviation / mean.value, expected.deviation / expected.value);
  const std::string figures = fmt::format("{} {}: extrapolated mean / reference = {:.4f} +- {:.4f}", c.scene,
                                          estimator, ratio, deviation);
  std::printf("%s\n", figures.c_str());
  EXPECT_LT(deviation, noisy ? 0.006 : 0.003) << figures;
  EXPECT_NEAR(ratio, 1.0, 0.005 + (noisy ? 2.0 * deviation : 0.0)) << figures;
}

/// Mean of the picture's indirect light.
inline double meanOfIndirect(const TraceScene& trace, const RenderSettings& settings) {
  Stats stats;
  return meanOfImage(renderCpu(trace, trace.scene().cameras.front(), settings, stats).layers.at("indirect"));
}

/// Extrapolates the mean of the indirect light, by photon volumes, to radius 0, over seeds.
inline Mean extrapolatedIndirect(const TraceScene& trace, RenderSettings settings, const Case& c) {
  Trials trials;
  for (settings.frame.seed = 0; settings.frame.seed < c.seeds; ++settings.frame.seed) {
    settings.photonVolumes.radius = c.radius;
    const double whole = meanOfIndirect(trace, settings);
    settings.photonVolumes.radius = 0.5f * c.radius;
    const double half = meanOfIndirect(trace, settings);
    trials.add(2.0 * half - whole);
  }
  return trials.mean();
}

/// Public scenes take minutes together: they are for ./check --all, and for ./check NAME, which set this.
inline bool wantsLongTests() { return std::getenv("ISOPHOTE_LONG_TESTS") != nullptr; }

/// Why sceneOf() gave nothing.
inline const char* whyNoScene() {
  return publicScenes().empty() ? "the public test scenes are not on this machine"
                                : "takes long: ./check --all runs it, or ./check with its name";
}

/// A built-in scene, or one of scenes/ where the public scenes are on this machine and wanted; nothing
/// otherwise.
inline std::optional<Scene> sceneOf(const std::string& name) {
  const std::filesystem::path own = std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "scenes" / name;
  if (own.extension() != ".json") return loadScene(name);
  if (publicScenes().empty() || !wantsLongTests()) return std::nullopt;
  SceneOptions options;
  options.assetFolders.push_back(publicScenes());
  return loadScene(own.string(), options);
}

}  // namespace isophote

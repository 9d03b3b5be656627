// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Caustics of --preset ispm against converged pictures. These are made in another way: photons traced from
// the light, ten times as many, gathered from a kd-tree within a third of the radius.
#include "agreement/agreement.h"

#include <array>
#include <vector>

namespace isophote {
namespace {

constexpr int kWidth = 160, kHeight = 120;

struct Picture {
  Image indirect;
  float radius;
};

Picture pictureOf(const TraceScene& trace, const RenderSettings& settings) {
  Stats stats;
  const Film film = renderCpu(trace, trace.scene().cameras.front(), settings, stats);
  return {film.layers.at("indirect"), float(stats.counter("radiusMetres"))};
}

RenderSettings ispmSettings(std::uint32_t seed) {
  RenderSettings settings = presetSettings("ispm");
  settings.frame.subsample = 1;  // Every pixel: what upsampling adds is tested by itself.
  settings.frame.width = kWidth;
  settings.frame.height = kHeight;
  settings.frame.seed = seed;
  settings.direct.areaSamples = 1;
  settings.direct.shadowResolution = 64;
  return settings;
}

Picture converged(const TraceScene& trace, float radius) {
  RenderSettings settings = presetSettings("jensen");
  settings.frame.width = kWidth;
  settings.frame.height = kHeight;
  settings.frame.seed = 1000;
  settings.photonTrace.photons = 2'000'000;
  settings.photonKdtree.nearest = 0;
  settings.photonKdtree.radius = radius / 3.0f;
  settings.direct.areaSamples = 1;
  return pictureOf(trace, settings);
}

/// The pixels of the caustic: those brighter than four times the median of what is lit indirectly, and those
/// near them, so that a kernel's blur keeps its light within.
std::vector<bool> causticOf(const Image& picture) {
  std::vector<float> values;
  for (const vec3 p : picture.pixels)
    if (meanOf(p) > 0.0f) values.push_back(meanOf(p));
  std::ranges::nth_element(values, values.begin() + std::ssize(values) / 2);
  const float bright = 4.0f * values[values.size() / 2];
  constexpr int kReach = 6;
  std::vector<bool> region(picture.pixels.size(), false);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (!(meanOf(picture.pixels[std::size_t(y * kWidth + x)]) > bright)) continue;
      for (int j = std::max(y - kReach, 0); j <= std::min(y + kReach, kHeight - 1); ++j)
        for (int i = std::max(x - kReach, 0); i <= std::min(x + kReach, kWidth - 1); ++i)
          region[std::size_t(j * kWidth + i)] = true;
    }
  return region;
}

double meanOver(const Image& picture, const std::vector<bool>& region) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < region.size(); ++i)
    if (region[i]) {
      sum += double(meanOf(picture.pixels[i]));
      ++count;
    }
  return sum / double(count);
}

void expectCaustic(const std::string& name, bool fromPoint) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  std::optional<Scene> scene = sceneOf(name);
  if (!scene) GTEST_SKIP() << whyNoScene();
  if (fromPoint)
    for (Light& light : scene->lights) light.radius = 0.0f;
  const TraceScene trace(*scene);
  Trials trials;
  std::vector<Picture> pictures;
  for (std::uint32_t seed = 0; seed < 4; ++seed) pictures.push_back(pictureOf(trace, ispmSettings(seed)));
  const Picture expected = converged(trace, pictures.front().radius);
  const std::vector<bool> region = causticOf(expected.indirect);
  const double mean = meanOver(expected.indirect, region);
  for (const Picture& picture : pictures) trials.add(meanOver(picture.indirect, region) / mean);
  const Mean ratio = trials.mean();
  const auto pixels = std::ranges::count(region, true);
  std::printf("%s: mean over the caustic's %d pixels / converged = %.4f +- %.4f, kernels of %.3g m\n",
              name.c_str(), int(pixels), ratio.value, ratio.deviation, double(pictures.front().radius));
  EXPECT_GT(pixels, 200);
  EXPECT_LT(pixels, kWidth * kHeight / 2);
  // What the wider kernels spread beyond the region, and three deviations.
  EXPECT_NEAR(ratio.value, 1.0, 0.05 + 3.0 * ratio.deviation)
      << writeFailure(pictures.front().indirect, expected.indirect);
}

TEST(Caustics, Ring) { expectCaustic("caustic-ring", true); }
TEST(Caustics, RingByALampWithARadius) { expectCaustic("caustic-ring", false); }
TEST(Caustics, MnCardioid) { expectCaustic("mn-cardioid.json", true); }
TEST(Caustics, MnRing) { expectCaustic("mn-ring.json", true); }
TEST(Caustics, GlassSphere) { expectCaustic("glass-sphere", false); }

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/environment.h"

#include "math/bounds.h"
#include "support/statistics.h"

#include <cmath>

namespace isophote {
namespace {

/// Weights that rise over many orders, with a row and scattered texels of none.
float weightAt(int x, int y) {
  if (y == 2 || (x + y) % 3 == 0) return 0.0f;
  return x == 4 && y == 1 ? 300.0f : 1.0f + float(x * y);
}

TexelDistribution distribution(int width, int height) {
  return TexelDistribution(width, height, [=](int y, float* weights) {
    for (int x = 0; x < width; ++x) weights[x] = weightAt(x, y);
  });
}

TEST(TexelDistribution, SamplesFollowTheInterpolatedWeights) {
  constexpr int kSizes[][2] = {{7, 5}, {1, 4}, {8, 1}, {2, 2}, {32, 16}};
  std::uint32_t stream = 40;
  for (const auto& [width, height] : kSizes) {
    const TexelDistribution d = distribution(width, height);
    ++stream;
    const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
      const vec3 u = randomTriple(stream, i);
      const TexelDistribution::Point p = d.sample(vec2(u.x, u.y));
      EXPECT_GT(p.density, 0.0f);
      return vec3(p.uv, 0.0f);
    };
    const auto pdf = [&](vec3 p) { return double(d.density(vec2(p.x, p.y))); };
    EXPECT_TRUE(samplesFollow(kSquareDomain, sample, pdf, {.tests = int(std::size(kSizes)), .depth = 3}))
        << width << " x " << height;
  }
}

TEST(TexelDistribution, IsEmptyWithoutWeights) {
  const TexelDistribution d(3, 2, [](int, float* weights) { std::fill_n(weights, 3, 0.0f); });
  EXPECT_TRUE(d.empty());
  EXPECT_EQ(d.sample(vec2(0.5f)).density, 0.0f);
  EXPECT_EQ(d.density(vec2(0.5f)), 0.0f);
}

TEST(TexelDistribution, StratifiedNumbersGiveStratifiedPoints) {
  // The same weight everywhere: an even grid stays one to within a texel.
  const TexelDistribution d(64, 32, [](int, float* weights) { std::fill_n(weights, 64, 2.0f); });
  EXPECT_NEAR(d.total(), 2.0 * 64 * 32, 1e-3);
  for (int i = 0; i < 100; ++i) {
    const vec2 u((float(i % 10) + 0.5f) / 10.0f, (float(i / 10) + 0.5f) / 10.0f);
    const TexelDistribution::Point p = d.sample(u);
    EXPECT_NEAR(p.uv.x, u.x, 1.0f / 64);
    EXPECT_NEAR(p.uv.y, u.y, 1.0f / 32);
    EXPECT_NEAR(p.density, 1.0f, 1e-4f);
  }
}

Light mapLight() {
  Light light{};
  light.type = kLightEnvironment;
  light.mapped = 1u;
  light.colour = vec3(1.0f);
  light.edgeU = vec3(1, 0, 0);
  light.edgeV = vec3(0, 1, 0);
  return light;
}

TEST(EnvironmentMap, ShowsTheWorldFromInside) {
  const Light light = mapLight();
  const auto uvOf = [&](vec3 d) { return mapUv(mapFromWorld(light, d)); };
  const auto expectUv = [](vec2 uv, float u, float v) {
    EXPECT_NEAR(uv.x, u, 1e-6f);
    EXPECT_NEAR(uv.y, v, 1e-6f);
  };
  expectUv(uvOf({0, 0, -1}), 0.5f, 0.5f);
  expectUv(uvOf({1, 0, 0}), 0.75f, 0.5f);
  expectUv(uvOf({-1, 0, 0}), 0.25f, 0.5f);
  EXPECT_NEAR(uvOf({0, 1, 0}).y, 0.0f, 1e-6f);
  EXPECT_NEAR(uvOf({0, -1, 0}).y, 1.0f, 1e-6f);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const vec3 d = sampleSphere(vec2(randomTriple(50, i)));
    ASSERT_LT(length(mapDirection(mapUv(d)) - d), 2e-6f);
  }
}

/// Sky over ground with a bright sun in it, seen by a light that is turned and coloured.
struct SunnySky {
  EnvironmentMap map;
  Light light = mapLight();

  SunnySky() {
    map.radiance = Image(32, 16, vec3(0.2f, 0.3f, 0.5f));
    for (int y = 8; y < 16; ++y)
      for (int x = 0; x < 32; ++x) map.radiance.at(x, y) = vec3(0.1f, 0.05f, 0.0f);
    map.radiance.at(20, 3) = vec3(90.0f, 80.0f, 70.0f);
    light.colour = vec3(1.0f, 2.0f, 0.5f);
    light.edgeU = normalize(vec3(0.3f, 0.1f, -1.0f));
    light.edgeV = normalize(cross(light.edgeU, vec3(1.0f, 0.0f, 0.1f)));
    Bounds bounds;
    bounds.extend(vec3(-1.0f, -2.0f, -0.5f));
    bounds.extend(vec3(1.0f, 2.0f, 0.5f));
    prepareEnvironment(map, light, bounds);
  }
};

TEST(EnvironmentMap, SamplesFollowTheirDensity) {
  const SunnySky sky;
  const vec3 n = normalize(vec3(1.0f, -2.0f, 0.5f));
  const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
    const LightSample s = sampleEnvironmentLight(sky.map, sky.light, n, randomTriple(51, i));
    const EnvironmentView view = viewEnvironment(sky.map, sky.light, s.wi, n);
    EXPECT_EQ(s.pdf, view.pdf);
    EXPECT_EQ(s.radiance, view.radiance);
    EXPECT_EQ(s.radiance, environmentRadiance(sky.map, sky.light, s.wi));
    return s.wi;
  };
  const auto pdf = [&](vec3 w) { return double(viewEnvironment(sky.map, sky.light, w, n).pdf); };
  EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf, {.tests = 2, .depth = 4}));
}

TEST(EnvironmentMap, PhotonsFollowRadianceTimesOutline) {
  const SunnySky sky;
  const vec3 halfSize(1.0f, 2.0f, 0.5f);
  const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
    return -emitFromMap(sky.map, sky.light, vec3(0.0f), halfSize, vec2(0.5f), vec2(randomTriple(52, i)))
                .direction;
  };
  const auto pdf = [&](vec3 w) {
    const vec2 uv = mapUv(mapFromWorld(sky.light, w));
    return double(sky.map.entering.density(uv)) / (2 * M_PI * M_PI * double(std::max(mapSine(uv.y), 1e-9f)));
  };
  EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf, {.tests = 2, .depth = 4}));
}

TEST(EnvironmentMap, PowerIsRadianceTimesOutlineOverAllDirections) {
  const SunnySky sky;
  const vec3 halfSize(1.0f, 2.0f, 0.5f);
  const double expected = integrateOver(kSphereDomain, [&](vec3 w) {
    const vec3 radiance = environmentRadiance(sky.map, sky.light, w);
    return double((radiance.x + radiance.y + radiance.z) / 3.0f * boxOutline(w, halfSize));
  });
  EXPECT_NEAR(double(environmentPower(sky.map)) / expected, 1.0, 3e-3);
}

}  // namespace
}  // namespace isophote

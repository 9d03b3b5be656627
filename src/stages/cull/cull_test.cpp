// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/cull/cull.h"

#include "math/rng.shared.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isophote {
namespace {

using Stays = std::vector<std::uint8_t>;

Light pointAt(float x, float power) {
  Light light{};
  light.type = kLightPoint;
  light.position = vec3(x, 0, 0);
  light.power = power;
  return light;
}

Stays stayingLights(const std::vector<Light>& lights, CullSettings settings, Stats& stats) {
  Scene scene;
  scene.lights = lights;
  Stays stays;
  Cull(settings).lights(scene, scene.lights, vec3(0.0f), stays, stats);
  return stays;
}

TEST(Cull, LeavesAllLightsUnlessAsked) {
  Stats stats;
  EXPECT_EQ(stayingLights({pointAt(1, 1), pointAt(1e6f, 1e-6f)}, {}, stats), (Stays{1, 1}));
  EXPECT_EQ(stats.counter("cull.lightPowerLeftOut"), 0);
}

TEST(Cull, LeavesOutDistantLightsButNeverTheSun) {
  Light sun{};
  sun.type = kLightDirectional;
  sun.power = 1;
  Stats stats;
  EXPECT_EQ(stayingLights({pointAt(9, 1), pointAt(11, 4), sun}, {.distance = 10}, stats), (Stays{1, 0, 1}));
  EXPECT_EQ(stats.counter("cull.lightPowerLeftOut"), 4);
  EXPECT_EQ(stats.counter("cull.lightsLeftOut"), 1);
}

/// Brightness 1, 0.04, 0.05 and 1: of 2.09 the two faint ones are 4.3 %.
TEST(Cull, LeavesOutFaintLights) {
  const std::vector<Light> lights{pointAt(1, 1), pointAt(5, 1), pointAt(1, 0.05f), pointAt(2, 4)};
  Stats stats;
  EXPECT_EQ(stayingLights(lights, {.lights = 0.01f}, stats), (Stays{1, 1, 1, 1}));
  EXPECT_EQ(stayingLights(lights, {.lights = 0.03f}, stats), (Stays{1, 0, 1, 1}));
  EXPECT_EQ(stayingLights(lights, {.lights = 0.05f}, stats), (Stays{1, 0, 0, 1}));
}

TEST(Cull, OneLightStays) {
  Stats stats;
  EXPECT_EQ(stayingLights({pointAt(100, 1), pointAt(100, 2)}, {.distance = 10}, stats), (Stays{0, 1}));
}

PhotonMap photonsOfPowers() {
  PhotonMap map;
  for (std::uint32_t i = 0; i < 40'000; ++i) {
    Photon photon{};
    photon.position = vec3(float(i % 20), 0, 0);
    photon.power = vec3(0.1f + 2.0f * random3(7, i, 0).x);
    map.photons.push_back(photon);
  }
  return map;
}

double powerOf(const PhotonMap& map) {
  double sum = 0;
  for (const Photon& photon : map.photons) sum += double(photon.power.x);
  return sum;
}

TEST(Cull, PhotonsBeyondTheDistanceAreCounted) {
  PhotonMap map = photonsOfPowers();
  const double before = powerOf(map);
  Stats stats;
  Cull({.distance = 9.5f}).photons(vec3(0.0f), 1, map, stats);
  EXPECT_EQ(map.photons.size(), 20'000u);
  EXPECT_NEAR(powerOf(map) + stats.counter("cull.photonPowerLeftOut"), before, 1e-3);
  for (const Photon& photon : map.photons) EXPECT_LT(photon.position.x, 9.6f);
}

/// A photon of power p below the threshold t survives with p / t and then carries t: the variance is p (t -
/// p) each.
TEST(Cull, ThinningKeepsThePower) {
  PhotonMap map = photonsOfPowers();
  const double before = powerOf(map);
  const double threshold = before / double(map.photons.size());
  double variance = 0;
  for (const Photon& photon : map.photons) {
    const double p = double(photon.power.x);
    if (p < threshold) variance += p * (threshold - p);
  }
  Stats stats;
  Cull({.photons = 1}).photons(vec3(0.0f), 1, map, stats);
  EXPECT_LT(map.photons.size(), 35'000u);
  EXPECT_NEAR(powerOf(map), before, 4.0 * std::sqrt(variance));
  EXPECT_EQ(stats.counter("cull.photonPowerLeftOut"), 0);
}

}  // namespace
}  // namespace isophote

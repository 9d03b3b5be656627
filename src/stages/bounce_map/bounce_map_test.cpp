// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/bounce_map/bounce_map.h"

#include "physics/bsdf.shared.h"
#include "scene/builtin/shapes.h"
#include "stages/light_gbuffer/light_gbuffer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace isophote {
namespace {

Light pointLight() {
  Light light{};
  light.type = kLightPoint;
  light.position = vec3(0.3f, 0.4f, -0.2f);
  light.colour = vec3(3, 2, 1);
  return light;
}

Light spotLight(float innerDegrees, float outerDegrees) {
  Light light = pointLight();
  light.type = kLightSpot;
  light.direction = normalize(vec3(0.4f, -1, 0.3f));
  light.cosInner = std::cos(innerDegrees * kPi / 180.0f);
  light.cosOuter = std::cos(outerDegrees * kPi / 180.0f);
  return light;
}

Light sun() {
  Light light{};
  light.type = kLightDirectional;
  light.direction = normalize(vec3(0.3f, -1, 0.2f));
  light.colour = vec3(2, 3, 4);
  return light;
}

/// A grey room with a white block in it; open above, so that a sun shines in and photons escape.
Scene roomWith(const std::vector<Light>& lights) {
  Scene scene;
  const std::uint32_t grey = addMaterial(scene, lambert("grey", {0.6f, 0.5f, 0.4f}));
  NamedMaterial glossy{makeMaterial(), "glossy"};
  glossy.baseColour = vec3(0.7f);
  glossy.roughness = 0.4f;
  Mesh room, block;
  addQuad(room, {-1, -1, 1}, {2, 0, 0}, {0, 0, -2});
  addQuad(room, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
  addQuad(room, {-1, -1, 1}, {0, 0, -2}, {0, 2, 0});
  addBox(block, {-0.6f, -1, -0.5f}, {0, -0.3f, 0.2f});
  addObject(scene, "room", grey, room);
  addObject(scene, "block", addMaterial(scene, glossy), block);
  scene.lights = lights;
  finishScene(scene, "room");
  return scene;
}

BouncedPhotons bounced(const TraceScene& trace, std::uint32_t pixels, std::uint32_t seed = 0,
                       std::uint32_t pass = 0) {
  Stats stats;
  LightSamples samples;
  BouncedPhotons out;
  const std::vector<std::uint32_t> budget(trace.scene().lights.size(), pixels);
  LightGbuffer().run({trace, budget, seed, pass}, samples, stats);
  BounceMap().run({trace, samples, seed, pass}, out, stats);
  return out;
}

/// What leaves through a light's views: all of its power, but of a sun what falls through the rectangle that
/// encloses the scene.
double powerOfViews(const Scene& scene) {
  const Light& light = scene.lights[0];
  if (light.type != kLightDirectional) return double(light.power);
  const vec3 extents = projectedHalfExtents(light.direction, 0.5f * scene.bounds.size());
  return double(meanOf(light.colour)) * 4.0 * double(extents.x) * double(extents.y);
}

/// What leaves through the pixels is what the light emits, however many pixels there are.
TEST(BounceMap, PowerIsThatOfTheLight) {
  const std::vector<Light> lights{pointLight(),     spotLight(20, 35), spotLight(40, 40),
                                  spotLight(0, 60), spotLight(85, 89), sun()};
  for (const Light& light : lights) {
    const Scene scene = roomWith({light});
    const TraceScene trace(scene);
    for (const std::uint32_t pixels : {1u, 10u, 1000u, 30'000u}) {
      const BouncedPhotons out = bounced(trace, pixels, 1, 3);
      EXPECT_NEAR(out.powerEmitted / powerOfViews(scene), 1.0, 1e-3)
          << "type " << light.type << ", " << pixels << " pixels";
      if (pixels < 1000) continue;
      EXPECT_GT(double(out.emitted), 0.85 * pixels) << "type " << light.type;
      EXPECT_LT(double(out.emitted), 1.2 * pixels) << "type " << light.type;
    }
  }
}

/// The sampling of a spot's falloff needs little correction where it has many pixels.
TEST(BounceMap, SpotsNeedLittleCorrection) {
  const Scene scene = roomWith({spotLight(20, 35)});
  const TraceScene trace(scene);
  Stats stats;
  LightSamples samples;
  LightGbuffer().run({trace, std::vector<std::uint32_t>{20'000}}, samples, stats);
  EXPECT_NEAR(samples.maps.at(0).powerScale, 1.0f, 1e-3f);
}

TEST(BounceMap, PowerIsKept) {
  const Scene scene = roomWith({pointLight(), spotLight(20, 35), sun()});
  const TraceScene trace(scene);
  const BouncedPhotons out = bounced(trace, 20'000);
  double carried = 0, squares = 0;
  for (const PathState& photon : out.photons) {
    carried += double(meanOf(photon.power));
    squares += double(meanOf(photon.power)) * double(meanOf(photon.power));
  }
  EXPECT_GT(out.powerAbsorbed, 0);
  EXPECT_GT(out.powerEscaped, 0);
  EXPECT_LT(out.hits, out.emitted);
  // Roulette keeps about half of the photons: its variance is at most the sum of the survivors' squares.
  EXPECT_NEAR(out.powerAbsorbed + out.powerEscaped + carried, out.powerEmitted, 4.0 * std::sqrt(squares));
}

TEST(BounceMap, SameAtAnyNumberOfThreads) {
  const Scene scene = roomWith({pointLight(), spotLight(20, 35), sun()});
  const TraceScene trace(scene);
  const BouncedPhotons all = bounced(trace, 10'000);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const BouncedPhotons alone = bounced(trace, 10'000);
  ASSERT_EQ(all.photons.size(), alone.photons.size());
  EXPECT_EQ(std::memcmp(all.photons.data(), alone.photons.data(), all.photons.size() * sizeof(PathState)), 0);
  EXPECT_EQ(all.powerAbsorbed, alone.powerAbsorbed);
}

TEST(BounceMap, PhotonsLeaveTheSurfaceThatTheLightSees) {
  const Scene scene = roomWith({spotLight(20, 35)});
  const TraceScene trace(scene);
  for (const PathState& photon : bounced(trace, 2000).photons) {
    const vec3 d = photon.origin - scene.lights[0].position;
    const Hit hit = trace.closestHit({scene.lights[0].position, 0.0f, normalize(d)});
    ASSERT_TRUE(hit.valid());
    EXPECT_NEAR(hit.t, length(d), 1e-4f * hit.t);
    EXPECT_NEAR(length(photon.direction), 1.0f, 1e-5f);
    EXPECT_GT(photon.density, 0.0f);
  }
}

// ---------------------------------------------------------------- passes

/// Power that leaves the floor in each of 4 x 4 cells.
std::array<double, 16> floorPowers(const BouncedPhotons& photons) {
  std::array<double, 16> cells{};
  for (const PathState& p : photons.photons) {
    if (p.origin.y > -0.999f) continue;
    const int x = std::clamp(int((p.origin.x + 1) * 2), 0, 3);
    const int z = std::clamp(int((p.origin.z + 1) * 2), 0, 3);
    cells[std::size_t(4 * z + x)] += double(meanOf(p.power));
  }
  return cells;
}

/// The mean over passes nears the truth, as it would not if every pass looked through the same points: of a
/// small map most of the error is that of its fixed pixels.
TEST(BounceMap, PassesConverge) {
  for (const Light& light : {pointLight(), spotLight(30, 45), sun()}) {
    const Scene scene = roomWith({light});
    const TraceScene trace(scene);
    const std::array<double, 16> expected = floorPowers(bounced(trace, 2'000'000, 77));
    std::array<double, 3> error{};
    constexpr std::array<std::uint32_t, 3> kPasses{1, 8, 64};
    constexpr std::uint32_t kSeeds = 8;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      std::array<double, 16> sum{};
      for (std::uint32_t pass = 0, step = 0; pass < kPasses.back(); ++pass) {
        const std::array<double, 16> cells = floorPowers(bounced(trace, 200, seed, pass));
        for (std::size_t c = 0; c < 16; ++c) sum[c] += cells[c];
        if (pass + 1 != kPasses[step]) continue;
        for (std::size_t c = 0; c < 16; ++c) {
          const double d = sum[c] / (pass + 1) - expected[c];
          error[step] += d * d / (16 * kSeeds);
        }
        ++step;
      }
    }
    // The variance of independent passes falls as their number, 8-fold; half of that allows for the scatter
    // of squared errors, of which those of one pass are correlated.
    EXPECT_GT(error[0] / error[1], 4) << "type " << light.type;
    EXPECT_GT(error[1] / error[2], 4) << "type " << light.type;
  }
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/direct/light_lanes.h"

#include "physics/shading_normal.shared.h"
#include "physics/test_materials.h"
#include "scene/builtin/scenes.h"
#include "trace/light_sampler.h"

#include <gtest/gtest.h>

namespace isophote {
namespace {

using namespace direct;

constexpr std::uint32_t kSeed = 5, kPass = 3, kSamples = 4;

/// A room with every kind of light that is sampled in lanes; the last is its lamp, a mesh.
Scene litRoom() {
  Scene scene = makeCornellBox();
  Light rectangle{};
  rectangle.type = kLightRectangle;
  rectangle.position = vec3(-0.9f, 0.4f, -0.5f);
  rectangle.edgeU = vec3(0.0f, 0.3f, 0.0f);
  rectangle.edgeV = vec3(0.0f, 0.0f, 0.5f);
  rectangle.direction = vec3(1.0f, 0.0f, 0.0f);
  rectangle.area = 0.15f;
  rectangle.colour = vec3(3.0f, 2.0f, 1.0f);
  Light sphere{};
  sphere.type = kLightPoint;
  sphere.position = vec3(0.2f, 1.1f, 0.3f);
  sphere.radius = 0.15f;
  sphere.colour = vec3(1.0f, 2.0f, 4.0f);
  Light sky{};
  sky.type = kLightEnvironment;
  sky.colour = vec3(0.3f, 0.5f, 0.7f);
  for (const Light& light : {rectangle, sphere, sky}) scene.lights.push_back(light);
  finishScene(scene, "room");
  return scene;
}

/// A tile of samples spread over the room, two lanes of them empty.
ViewTile scatteredTile(const Bsdf& bsdf) {
  ViewTile tile;
  clearTile(tile);
  for (int lane = 0; lane < kTileLanes - 2; ++lane) {
    const vec3 u = random3(kSeed, std::uint32_t(lane), 0), v = random3(kSeed, std::uint32_t(lane), 1);
    ViewSample s{};
    s.position = vec3(1.8f * u.x - 0.9f, 1.8f * u.y + 0.05f, 1.8f * u.z - 0.9f);
    s.ng = sampleSphere(vec2(v.x, v.y));
    s.ns = normalize(s.ng + 0.3f * sampleSphere(vec2(v.y, v.z)));
    s.wo = basisAround(s.ng) * sampleCosineHemisphere(vec2(v.z, u.x));
    s.bsdf = bsdf;
    s.throughput = vec3(1.0f);
    s.pixel = std::uint32_t(1000 + 7 * lane);
    setLane(tile, lane, s);
  }
  return tile;
}

/// What AreaLanes says of one lane, formed from the scalar sampler, BSDF and densities.
vec3 expectedRadiance(const LightSampler& lights, std::uint32_t light, const ViewSample& s, vec3 u) {
  const LightSample l = lights.sample(light, s.position, s.ng, u);
  if (!(l.pdf > 0.0f) || dot(l.wi, s.ng) <= 0.0f) return vec3(0.0f);
  const float own = l.pdf * float(kSamples);
  const float other = reflectsSharply(s.bsdf) ? pdfBsdf(s.bsdf, l.wi, s.wo, s.ng, s.ns, 1.0f) : 0.0f;
  return evalBsdf(s.bsdf, l.wi, s.wo, s.ng, s.ns) * l.radiance *
         (std::abs(dot(l.wi, s.ns)) * lightFade(l.wi, s.ng, s.ns) / (own + other));
}

class AreaLanesTest : public ::testing::TestWithParam<SimdLevel> {};

TEST_P(AreaLanesTest, SampleLikeTheScalarSampler) {
  if (GetParam() > bestSimdLevel()) GTEST_SKIP() << "this processor has no " << name(GetParam());
  const Scene scene = litRoom();
  const TraceScene trace(scene);
  const LightSampler lights(trace);
  ASSERT_EQ(scene.lights.size(), 4u);
  ASSERT_EQ(scene.lights[3].type, kLightMesh);
  const Bsdf materials[] = {bsdfOf({.specular = 0}).bsdf, bsdfOf({.roughness = 0.2f, .metallic = 1}).bsdf,
                            bsdfOf({.roughness = 0.8f}).bsdf};
  for (const Bsdf& bsdf : materials) {
    const ViewTile tile = scatteredTile(bsdf);
    for (std::uint32_t light = 0; light < scene.lights.size(); ++light) {
      ASSERT_TRUE(isSampledInLanes(scene.lights[light]));
      const AreaLanes area(
          {trace.scene(), scene.lights[light], tile, kSeed, kPass, light, kSamples, GetParam()});
      int lit = 0;
      for (std::uint32_t i = 0; i < kSamples; ++i) {
        LightLanes lanes;
        area.sample(i, lanes);
        for (std::uint32_t lane = 0; lane < std::uint32_t(kTileLanes); ++lane) {
          const bool reaches = (lanes.lit >> lane & 1u) != 0u;
          if (tile.pixel[lane] == kNoPixel) {
            EXPECT_FALSE(reaches);
            continue;
          }
          const uvec3 scramble = lightScramble(laneKey(kSeed, kPass, lane, tile.pixel[lane]), light);
          const vec3 u = scrambled(unscrambledSample(i), scramble);
          const vec3 expected = expectedRadiance(lights, light, laneOf(tile, int(lane)), u);
          const vec3 got = reaches ? lanes.radiance[lane] : vec3(0.0f);
          EXPECT_NEAR(got.x, expected.x, 1e-3f * expected.x + 1e-6f) << "light " << light << " lane " << lane;
          EXPECT_NEAR(got.z, expected.z, 1e-3f * expected.z + 1e-6f) << "light " << light << " lane " << lane;
          lit += reaches ? 1 : 0;
        }
      }
      EXPECT_GT(lit, 20) << "light " << light;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, AreaLanesTest,
                         ::testing::Values(SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512),
                         [](const auto& level) { return std::string(name(level.param)); });

}  // namespace
}  // namespace isophote

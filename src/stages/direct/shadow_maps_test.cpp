// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/direct/shadow_maps.h"

#include "math/sampling.shared.h"
#include "physics/emission.shared.h"
#include "scene/builtin/shapes.h"
#include "stages/direct/direct.h"
#include "stages/gbuffer/gbuffer.h"
#include "trace/light_views.h"
#include "trace/surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace isophote {
namespace {

constexpr ShadowMapOptions kOptions{512, 2, 1.0f};

/// The light as seen from a point: direction and distance.
LightSample sampleOf(const Light& light, vec3 from) {
  return light.type == kLightPoint  ? samplePoint(light, from, vec2(0.5f))
         : light.type == kLightSpot ? sampleSpot(light, from)
                                    : sampleDirectional(light);
}

/// What a texel of the light's map covers at that distance, or a little more [m].
float footprint(const Scene& scene, float distance) {
  const Light& light = scene.lights[0];
  const float texels = float(kOptions.resolution) - 6.0f;
  const bool cube = light.type == kLightPoint || light.cosOuter < kWidestSingleView;
  if (cube && light.type != kLightDirectional) return 2.0f * distance / texels;
  if (light.type == kLightSpot)
    return 2.0f * distance * std::sqrt(1.0f - light.cosOuter * light.cosOuter) / light.cosOuter / texels;
  const vec3 extents = projectedHalfExtents(light.direction, 0.5f * scene.bounds.size());
  return 2.0f * std::max(extents.x, extents.y) / texels;
}

bool isLit(const TraceScene& trace, vec3 position, vec3 ng) {
  const LightSample l = sampleOf(trace.scene().lights[0], position);
  return !trace.occluded(rayFrom(position, ng, l.wi, l.distance * (1.0f - 1e-4f)));
}

/// Whether an edge of a shadow, or of the surface, may lie within the reach of the filter and the bias.
bool nearEdge(const TraceScene& trace, const ViewSample& s, vec3 toLight, float texel) {
  const bool lit = isLit(trace, s.position, s.ng);
  const mat3 frame = basisAround(s.ng);
  const float reach = texel * (0.5f * float(kOptions.filter) + 1.0f + kOptions.bias);
  // Along the plane that contains the light a texel is stretched.
  const vec3 across = cross(s.ng, toLight);
  const vec3 u = dot(across, across) > 1e-8f ? normalize(across) : frame[0];
  const vec3 v = cross(s.ng, u) / std::max(dot(toLight, s.ng), 0.05f);
  for (int ring = 1; ring <= 6; ++ring)
    for (int i = 0; i < 24; ++i) {
      const float angle = float(i) * kPi / 12.0f;
      const vec3 at = s.position + (u * std::cos(angle) + v * std::sin(angle)) * (reach * float(ring) / 6.0f);
      if (isLit(trace, at, s.ng) != lit) return true;
    }
  return false;
}

struct Verdict {
  int judged = 0, wrong = 0, near = 0;
};

Verdict judge(const Scene& scene) {
  const TraceScene trace(scene);
  Stats stats;
  ViewSamples view;
  constexpr int kWidth = 240, kHeight = 136;
  Gbuffer({}).run({trace, cameraRays(scene.cameras.front(), kWidth, kHeight), kWidth, kHeight}, view, stats);
  ShadowMaps maps;
  maps.build(RasterScene(trace), trace.lights(), std::vector<std::uint8_t>{1}, kOptions, {});
  Verdict verdict;
  for (std::size_t t = 0; t < view.primaryTiles; ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (view.tiles[t].pixel[lane] == kNoPixel) continue;
      const ViewSample s = laneOf(view.tiles[t], lane);
      const LightSample l = sampleOf(scene.lights[0], s.position);
      if (dot(l.wi, s.ng) <= 0.0f || maxOf(l.radiance) <= 0.0f) continue;
      if (nearEdge(trace, s, l.wi, footprint(scene, l.distance))) {
        ++verdict.near;
        continue;
      }
      ++verdict.judged;
      const float expected = isLit(trace, s.position, s.ng) ? 1.0f : 0.0f;
      verdict.wrong += std::abs(maps.visibility(0, s.position, s.ng) - expected) > 1e-3f;
    }
  return verdict;
}

Scene atriumWith(const Light& light) {
  Scene scene = loadScene("atrium");
  scene.lights = {light};
  finishScene(scene, "atrium");
  return scene;
}

/// Outside a band of the filter's and the bias's reach around the edges of shadows, maps and rays agree: no
/// surface shadows itself, and no shadow comes loose by more.
void expectAgreement(const char* name, const Light& light) {
  const Verdict verdict = judge(atriumWith(light));
  std::printf("%s: %d of %d differ, %d near an edge\n", name, verdict.wrong, verdict.judged, verdict.near);
  EXPECT_GT(verdict.judged, 3000);
  EXPECT_LT(verdict.near, verdict.judged);
  EXPECT_LE(double(verdict.wrong), 0.002 * double(verdict.judged));
}

TEST(ShadowMaps, AgreeWithRaysForAPoint) { expectAgreement("point", loadScene("atrium").lights.at(0)); }

/// Where the atrium's own light is. Half angles [rad].
Light spotInAtrium(float inner, float outer) {
  Light light = loadScene("atrium").lights.at(0);
  light.type = kLightSpot;
  light.direction = normalize(vec3(0.2f, -1, 0.1f));
  light.cosInner = std::cos(inner);
  light.cosOuter = std::cos(outer);
  return light;
}

TEST(ShadowMaps, AgreeWithRaysForASpot) { expectAgreement("spot", spotInAtrium(0.6f, 0.8f)); }

TEST(ShadowMaps, AgreeWithRaysForAWideSpot) { expectAgreement("wide spot", spotInAtrium(1.0f, 1.4f)); }

TEST(ShadowMaps, AgreeWithRaysForTheSun) {
  Light light{};
  light.type = kLightDirectional;
  light.direction = normalize(vec3(-0.3f, -1, 0.2f));
  light.colour = vec3(10);
  expectAgreement("sun", light);
}

/// A sphere lit from nearby, of facets as coarse as 3 degrees: no facet shadows the next.
TEST(ShadowMaps, CurvedSurfacesDoNotShadowThemselves) {
  Scene scene;
  Mesh ball;
  addSphere(ball, vec3(0.0f), 1.0f, 120, 60);
  addObject(scene, "ball", addMaterial(scene, lambert("white", vec3(0.8f))), ball);
  Light light{};
  light.type = kLightPoint;
  light.position = vec3(1, 2, 2);
  light.colour = vec3(1);
  scene.lights = {light};
  finishScene(scene, "ball");
  const TraceScene trace(scene);
  ShadowMaps maps;
  maps.build(RasterScene(trace), trace.lights(), std::vector<std::uint8_t>{1}, kOptions, {});
  int lit = 0, shadowed = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const vec3 from = sampleSphere(vec2(float(i) / 20'000.0f, std::fmod(float(i) * 0.618f, 1.0f))) * 3.0f;
    const Ray ray{from, 0.0f, normalize(-from)};
    const Hit hit = trace.closestHit(ray);
    if (!hit.valid()) continue;
    const Surface s = surfaceAt(trace, ray, hit);
    // Facets that turn away from the light throw the ball's own shadow.
    if (dot(normalize(light.position - s.position), s.ng) < 0.1f) continue;
    ++lit;
    shadowed += maps.visibility(0, s.position, s.ng) < 1.0f;
  }
  EXPECT_GT(lit, 4000);
  EXPECT_EQ(shadowed, 0);
}

TEST(ShadowMaps, OnlyLightsWithoutAreaHaveThem) {
  const Scene scene = loadScene("cornell-box");
  const TraceScene trace(scene);
  ShadowMaps maps;
  maps.build(RasterScene(trace), trace.lights(), {}, kOptions, {});
  EXPECT_EQ(maps.texels(), 0u);
  EXPECT_FALSE(maps.has(0));
}

/// Every kind of map, every lane that a light shines on, every instruction set.
TEST(ShadowMaps, LanesGiveTheBytesOfSinglePoints) {
  Light sun{};
  sun.type = kLightDirectional;
  sun.direction = normalize(vec3(-0.3f, -1, 0.2f));
  sun.colour = vec3(10);
  Scene scene = loadScene("atrium");
  scene.lights = {scene.lights.at(0), spotInAtrium(0.6f, 0.8f), spotInAtrium(1.0f, 1.4f), sun};
  finishScene(scene, "atrium");
  const TraceScene trace(scene);
  Stats stats;
  ViewSamples view;
  Gbuffer({}).run({trace, cameraRays(scene.cameras.front(), 100, 60), 100, 60}, view, stats);
  ShadowMaps maps;
  maps.build(RasterScene(trace), trace.lights(), {}, {200, 3, 1.0f}, {});
  int between = 0;
  for (std::uint32_t light = 0; light < 4; ++light)
    for (const SimdLevel level : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
      if (level > bestSimdLevel()) continue;
      for (std::size_t t = 0; t < view.primaryTiles; ++t) {
        const ViewTile& tile = view.tiles[t];
        const std::uint64_t lanes =
            bitsWhere([&](int lane) { return tile.pixel[lane] != kNoPixel && lane % 5 != 0; });
        Lanes<float, kTileLanes> got;
        maps.visibility(light, tile, lanes, got, level);
        for (int lane = 0; lane < kTileLanes; ++lane) {
          if ((lanes >> lane & 1u) == 0u) continue;
          const float expected = maps.visibility(light, positionOf(tile, lane), ngOf(tile, lane));
          ASSERT_EQ(got[std::uint32_t(lane)], expected) << "light " << light << ", tile " << t;
          between += expected > 0.0f && expected < 1.0f;
        }
      }
    }
  EXPECT_GT(between, 100);
}

// ---------------------------------------------------------------- the stage

double meanOfLight(const Scene& scene, DirectSettings settings) {
  const TraceScene trace(scene);
  Stats stats;
  ViewSamples view;
  Gbuffer({}).run({trace, cameraRays(scene.cameras.front(), 160, 90), 160, 90}, view, stats);
  Direct direct(settings);
  Radiance radiance;
  direct.prepare(RasterScene(trace), {}, stats);
  direct.run({trace, view}, radiance, stats);
  double sum = 0;
  for (const RadianceTile& tile : radiance)
    for (int lane = 0; lane < kTileLanes; ++lane)
      sum += double(tile.r[lane]) + double(tile.g[lane]) + double(tile.b[lane]);
  return sum;
}

/// Twice the resolution halves what the maps' biases let by.
TEST(Direct, MapsNearTracedShadowsWithTheirResolution) {
  const Scene scene = loadScene("atrium");
  const double traced = meanOfLight(scene, {});
  const double coarse = meanOfLight(scene, {.shadows = Shadows::kMap, .shadowResolution = 256}) / traced - 1;
  const double fine = meanOfLight(scene, {.shadows = Shadows::kMap, .shadowResolution = 2048}) / traced - 1;
  std::printf("light beyond that of traced shadows: %.2f %% at 256 texels, %.2f %% at 2048\n", 100 * coarse,
              100 * fine);
  EXPECT_LT(std::abs(coarse), 0.03);
  EXPECT_LT(std::abs(fine), 0.01);
  EXPECT_LT(std::abs(fine), 0.5 * std::abs(coarse));
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/gbuffer.h"

#include "scene/builtin/builtin.h"
#include "trace/surface.h"
#include "trace/surface_lanes.h"

#include <gtest/gtest.h>

#include <cstring>

namespace isophote {
namespace {

ViewSamples seen(const TraceScene& trace, PrimaryVisibility visibility, int width, int height) {
  ViewSamples view;
  Stats stats;
  Gbuffer gbuffer({.visibility = visibility});
  gbuffer.run({.trace = trace,
               .camera = cameraRays(trace.scene().cameras.front(), width, height),
               .width = width,
               .height = height,
               .subpixel = vec2(0.3f, 0.6f),
               .surfaceLayers = true},
              view, stats);
  return view;
}

/// Rasterised and traced primary visibility give the same view samples, but where a ray passes an edge within
/// float precision; sizes that are not a multiple of a tile.
TEST(Gbuffer, RasterAndTracedSeeTheSame) {
  constexpr int kWidth = 203, kHeight = 117;
  for (const char* name : {"cornell-box", "atrium", "glass-sphere"}) {
    SCOPED_TRACE(name);
    Scene scene = findBuiltinScene(name)->make();
    finishScene(scene, name);
    const TraceScene trace(scene);
    const ViewSamples raster = seen(trace, PrimaryVisibility::kRaster, kWidth, kHeight);
    const ViewSamples traced = seen(trace, PrimaryVisibility::kTraced, kWidth, kHeight);
    ASSERT_EQ(raster.primaryTiles, traced.primaryTiles);
    int lit = 0, differing = 0;
    for (std::size_t t = 0; t < raster.primaryTiles; ++t)
      for (int lane = 0; lane < kTileLanes; ++lane) {
        const ViewTile &a = raster.tiles[t], &b = traced.tiles[t];
        const bool none = a.pixel[lane] == kNoPixel;
        lit += !none;
        if (none && b.pixel[lane] == kNoPixel) continue;
        const vec3 between = vec3(a.positionX[lane], a.positionY[lane], a.positionZ[lane]) -
                             vec3(b.positionX[lane], b.positionY[lane], b.positionZ[lane]);
        differing += a.pixel[lane] != b.pixel[lane] || length(between) > 1e-3f;
      }
    EXPECT_GT(lit, kWidth * kHeight / 4);
    EXPECT_LE(differing, lit / 500);
  }
}

constexpr int kWidth = 150, kHeight = 85;  // Tiles that reach over the picture's edges.

bool same(vec3 a, vec3 b) { return std::memcmp(&a, &b, sizeof(vec3)) == 0; }

/// Lanes leave out the white of vertices without a colour, which interpolation rounds.
bool nearly(vec3 a, vec3 b) { return maxOf(abs(a - b)) <= 1e-6f; }

/// What a tile keeps of a BSDF.
bool same(const Bsdf& kept, const Bsdf& bsdf) {
  if (!nearly(kept.diffuse, bsdf.diffuse)) return false;
  if (isLambertian(bsdf)) return isLambertian(kept);
  return kept.alpha == bsdf.alpha && nearly(kept.f0, bsdf.f0) && kept.f90 == bsdf.f90 &&
         kept.coupling0 == bsdf.coupling0 && kept.coupling90 == bsdf.coupling90;
}

class GbufferTest : public testing::TestWithParam<const char*> {};

/// Lanes and single surfaces share every formula.
TEST_P(GbufferTest, HoldsWhatEachRayMeets) {
  const Scene scene = loadScene(GetParam());
  const TraceScene trace(scene);
  const CameraRays camera = cameraRays(scene.cameras.front(), kWidth, kHeight);
  Stats stats;
  ViewSamples view;
  Gbuffer({.visibility = PrimaryVisibility::kTraced})
      .run({.trace = trace, .camera = camera, .width = kWidth, .height = kHeight, .surfaceLayers = true},
           view, stats);
  int met = 0, compared = 0, plain = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const vec2 p = imagePlaneFromPixel(vec2(float(x), float(y)) + vec2(0.5f), vec2(kWidth, kHeight));
      const Ray ray{cameraRayOrigin(camera, p), 0.0f, cameraRayDirection(camera, p), 1e30f};
      const Hit hit = trace.closestHit(ray);
      const ViewTile& tile = view.tiles[std::size_t(y / kTileSide * view.tilesX + x / kTileSide)];
      const int lane = y % kTileSide * kTileSide + x % kTileSide;
      // Packets and single rays may choose different triangles where two meet.
      if (!hit.valid()) continue;
      ++met;
      if (view.depth.at(x, y).x != hit.t) continue;
      const Surface s = surfaceAt(trace, ray, hit);
      const bool expected = hasNonDeltaLobe(s.bsdf) > 0.5f;
      ASSERT_EQ(tile.pixel[lane] != kNoPixel, expected) << x << ", " << y;
      if (!expected) continue;
      plain += SurfaceLanes::isPlain(trace.instance(hit.instance)) ? 1 : 0;
      const ViewSample sample = laneOf(tile, lane);
      ASSERT_EQ(sample.pixel, std::uint32_t(y * kWidth + x));
      if (!same(sample.position, s.position) || !same(sample.ng, s.ng)) continue;
      ++compared;
      EXPECT_TRUE(same(sample.ns, s.ns) && same(sample.wo, -ray.direction)) << x << ", " << y;
      EXPECT_TRUE(same(sample.bsdf, s.bsdf)) << x << ", " << y;
      EXPECT_TRUE(nearly(view.albedo.at(x, y), s.baseColour) && same(view.normal.at(x, y), s.ns));
      EXPECT_TRUE(glm::all(glm::greaterThanEqual(s.position, tile.bounds.lower)) &&
                  glm::all(glm::lessThanEqual(s.position, tile.bounds.upper)));
    }
  EXPECT_GT(compared, met / 2);
  EXPECT_GT(plain, met / 2);
}

INSTANTIATE_TEST_SUITE_P(Scenes, GbufferTest,
                         testing::Values("cornell-box", "glass-sphere", "caustic-ring", "atrium"),
                         [](const auto& suite) {
                           std::string name = suite.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace isophote

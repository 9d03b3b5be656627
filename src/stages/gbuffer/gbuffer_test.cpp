// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/gbuffer.h"

#include "scene/builtin/builtin.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace isophote

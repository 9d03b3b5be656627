// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/irradiance_blur/irradiance_blur.h"

#include "stages/irradiance_blur/irradiance_blur.shared.h"
#include "stages/photon_volumes/test_view.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cstring>

namespace isophote {
namespace {

using namespace photon_volumes_test;

/// Light by a function of the sample.
template <class LightAt>
Radiance lightOf(const ViewSamples& view, LightAt&& lightAt) {
  Radiance light(view.tiles.size());
  for (std::size_t i = 0; i < view.tiles.size(); ++i)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      const float value = view.tiles[i].pixel[lane] == kNoPixel ? 0.0f : lightAt(view.tiles[i], lane);
      light[i].r[lane] = light[i].g[lane] = light[i].b[lane] = value;
    }
  return light;
}

Radiance blurred(const ViewSamples& view, const Radiance& irradiance, IrradianceBlurSettings settings,
                 SimdLevel simd = bestSimdLevel()) {
  Radiance light = lightOf(view, [](const ViewTile&, int) { return 1.0f; });
  Stats stats;
  IrradianceBlur(settings).run({view, irradiance, simd}, light, stats);
  return light;
}

template <class Check>
void forSamples(const ViewSamples& view, std::size_t tiles, Check&& check) {
  for (std::size_t i = 0; i < tiles; ++i)
    for (int lane = 0; lane < kTileLanes; ++lane)
      if (view.tiles[i].pixel[lane] != kNoPixel) check(i, lane);
}

const ViewOptions kViews[] = {
    {.width = 150, .height = 110, .secondaryTiles = 9},
    {.width = 90, .height = 70, .eye = {0, 0, 0.5f}, .orthographic = 1},
    {.width = 40, .height = 30, .eye = {0.9f, 0.9f, 0.9f}, .forward = {-1, -1, -1}},
    {.width = 7, .height = 3},
};

TEST(IrradianceBlur, LeavesConstantLightAsItIs) {
  for (const ViewOptions& options : kViews) {
    const ViewSamples view = makeView(options);
    const Radiance out =
        blurred(view, lightOf(view, [](const ViewTile&, int) { return 3.0f; }), {.radius = 9, .step = 2});
    forSamples(view, view.tiles.size(),
               [&](std::size_t i, int lane) { EXPECT_NEAR(out[i].g[lane], 3.0f, 1e-5f); });
  }
}

// Every wall of the cube has a light of its own, and meets others in corners.
TEST(IrradianceBlur, MixesNoLightAcrossCorners) {
  const auto byWall = [](const ViewTile& tile, int lane) {
    const vec3 n = ngOf(tile, lane);
    return 10.0f + 3.0f * n.x + 2.0f * n.y + n.z;
  };
  for (const ViewOptions& options : kViews) {
    const ViewSamples view = makeView(options);
    const Radiance light = lightOf(view, byWall);
    const Radiance out = blurred(view, light, {.radius = 12, .step = 1});
    forSamples(view, view.tiles.size(),
               [&](std::size_t i, int lane) { EXPECT_NEAR(out[i].g[lane], light[i].g[lane], 1e-4f); });
  }
}

// A step across a wall becomes a ramp: each pixel lies between its neighbours, and none jumps any more.
TEST(IrradianceBlur, SmoothsBlocksOnAWallAtAnySlope) {
  for (const vec3 forward : {vec3(0, 0, -1), vec3(0.95f, 0, -0.3f)}) {
    ViewSamples view = makeView({.width = 160, .height = 16, .forward = forward});
    const auto blocks = [](const ViewTile& tile, int lane) {
      return 1.0f + 0.2f * float(int(tile.pixel[lane] % 160) / 16 % 2);
    };
    const Radiance out = blurred(view, lightOf(view, blocks), {.radius = 16, .step = 2});
    float largest = 0;
    for (std::size_t t = 0; t + 1 < std::size_t(view.tilesX); ++t)
      for (int lane = 0; lane < kTileSide; ++lane) {
        const bool last = lane == kTileSide - 1;
        const ViewTile& next = last ? view.tiles[t + 1] : view.tiles[t];
        const int nextLane = last ? 0 : lane + 1;
        if (dot(ngOf(view.tiles[t], lane), ngOf(next, nextLane)) < 0.99f) continue;
        const float other = last ? out[t + 1].g[0] : out[t].g[lane + 1];
        largest = std::max(largest, std::abs(other - out[t].g[lane]));
      }
    EXPECT_LT(largest, 0.2f * 0.25f) << "of a step of 0.2";
    EXPECT_GT(largest, 0.0f);
  }
}

// A wall half a metre before another: same normals, so only depth parts them.
TEST(IrradianceBlur, MixesNoLightOverDepthEdges) {
  ViewSamples view = makeView({.width = 128, .height = 96, .eye = {0, 0, 0.9f}});
  const auto isNear = [&](std::size_t t) { return int(t) % view.tilesX < view.tilesX / 2; };
  for (std::size_t t = 0; t < view.tiles.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      ViewTile& tile = view.tiles[t];
      tile.ngX[lane] = tile.ngY[lane] = 0.0f;
      tile.ngZ[lane] = 1.0f;
      if (!isNear(t)) continue;
      const float scale = 0.6f;
      tile.positionX[lane] *= scale;
      tile.positionY[lane] *= scale;
      tile.positionZ[lane] = 0.9f + scale * (tile.positionZ[lane] - 0.9f);
    }
  Radiance light(view.tiles.size());
  for (std::size_t t = 0; t < view.tiles.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane)
      light[t].r[lane] = light[t].g[lane] = light[t].b[lane] = isNear(t) ? 1.0f : 5.0f;
  const Radiance out = blurred(view, light, {.radius = 12, .step = 1});
  forSamples(view, view.primaryTiles, [&](std::size_t i, int lane) {
    const vec3 p = positionOf(view.tiles[i], lane);
    if (std::abs(p.z + (isNear(i) ? -0.9f + 0.6f * 1.9f : 1.0f)) < 1e-3f) {
      EXPECT_NEAR(out[i].g[lane], light[i].g[lane], 1e-4f);
    }
  });
}

TEST(IrradianceBlur, KeepsWhatMirrorsShowAndMultipliesByTheReflectance) {
  const ViewSamples view = makeView({.secondaryTiles = 5});
  const Radiance irradiance =
      lightOf(view, [](const ViewTile& tile, int lane) { return 1.0f + tile.positionX[lane]; });
  Radiance light = lightOf(view, [](const ViewTile& tile, int lane) { return tile.diffuseG[lane]; });
  const Radiance reflectance = light;
  Stats stats;
  IrradianceBlur blur({.radius = 4, .step = 1});
  blur.run({view, irradiance}, light, stats);
  for (std::size_t i = view.primaryTiles; i < view.tiles.size(); ++i)
    for (int lane = 0; lane < kTileLanes; ++lane)
      EXPECT_EQ(light[i].g[lane], reflectance[i].g[lane] * irradiance[i].g[lane]);
  const Radiance mixed = blurred(view, irradiance, {.radius = 4, .step = 1});
  forSamples(view, view.primaryTiles, [&](std::size_t i, int lane) {
    EXPECT_EQ(light[i].g[lane], reflectance[i].g[lane] * mixed[i].g[lane]);
  });
  const Radiance none = blurred(view, irradiance, {.radius = 0});
  forSamples(view, view.tiles.size(),
             [&](std::size_t i, int lane) { EXPECT_EQ(none[i].g[lane], irradiance[i].g[lane]); });
}

TEST(IrradianceBlur, TheSameBytesOfEveryInstructionSetAndOnReusedMemory) {
  const ViewSamples view = makeView({.width = 150, .height = 70});
  const ViewSamples wider = makeView({.width = 160, .height = 70});  // A tile more in a row.
  const auto byPlace = [](const ViewTile& tile, int lane) { return 2.0f + tile.positionX[lane]; };
  const Radiance irradiance = lightOf(view, byPlace);
  const auto same = [](const Radiance& a, const Radiance& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(RadianceTile)) == 0;
  };
  const Radiance baseline = blurred(view, irradiance, {}, SimdLevel::kBaseline);
  for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512})
    if (level <= bestSimdLevel()) {
      EXPECT_TRUE(same(blurred(view, irradiance, {}, level), baseline)) << name(level);
    }
  IrradianceBlur blur({});
  Stats stats;
  const Radiance widerLight = lightOf(wider, byPlace);
  for (int i = 0; i < 2; ++i) {
    Radiance light = lightOf(wider, [](const ViewTile&, int) { return 1.0f; });
    blur.run({wider, widerLight}, light, stats);
    light = lightOf(view, [](const ViewTile&, int) { return 1.0f; });
    tbb::task_arena(1 + i).execute([&] { blur.run({view, irradiance}, light, stats); });
    EXPECT_TRUE(same(light, baseline));
  }
}

TEST(IrradianceBlur, PackedNormalsAreNearTheNormals) {
  for (std::uint32_t i = 0; i < 200; ++i) {
    const vec3 u = random3(3, i, 0);
    const vec3 n = sampleSphere(vec2(u.x, u.y));
    EXPECT_LT(length(unpackBlurNormal(packBlurNormal(n)) * kBlurNormalScale - n), 0.87f / 511.0f);
  }
}

}  // namespace
}  // namespace isophote

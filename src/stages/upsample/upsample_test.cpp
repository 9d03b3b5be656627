// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/upsample/upsample.h"

#include "stages/photon_volumes/test_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace isophote {
namespace {

using photon_volumes_test::makeView;

/// Light that a sample of white surface would reflect: smooth in space.
vec3 lightAt(vec3 p) { return vec3(2.0f + p.x, 2.0f + 0.5f * p.y, 2.0f + 0.3f * p.z); }

/// Estimates without photons: diffuse surfaces receive lightAt(), others reflect it by f0 as well.
Radiance estimate(const ViewSamples& view) {
  Radiance out(view.tiles.size());
  for (std::size_t t = 0; t < view.tiles.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (view.tiles[t].pixel[lane] == kNoPixel) continue;
      const ViewSample s = laneOf(view.tiles[t], lane);
      const float cosO = std::abs(dot(s.wo, s.ns));
      const bool glossy = s.bsdf.alpha > 0.0f && s.bsdf.f90 > 0.0f;
      const vec3 light = lightAt(s.position);
      const vec3 value = s.bsdf.diffuse * light * (kInvPi * upsampleCoupling(s.bsdf, cosO)) +
                         (glossy ? upsampleGlossy(s.bsdf, cosO) * light : vec3(0.0f));
      out[t].r[lane] = value.x;
      out[t].g[lane] = value.y;
      out[t].b[lane] = value.z;
    }
  return out;
}

Radiance upsampled(const ViewSamples& view, std::uint32_t side, UpsampleWeights weights,
                   SimdLevel simd = bestSimdLevel(), std::uint32_t pass = 0, Stats* statsOut = nullptr) {
  Stats stats;
  Upsample upsample({weights});
  const ViewSamples& sparse = upsample.choose({view, side, pass, simd}, stats);
  Radiance out;
  upsample.run({view, estimate(sparse), simd}, out, stats);
  if (statsOut) *statsOut = stats;
  return out;
}

/// Largest difference relative to the light, over all lanes.
float largestError(const ViewSamples& view, const Radiance& a, const Radiance& b) {
  float largest = 0;
  for (std::size_t t = 0; t < view.tiles.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (view.tiles[t].pixel[lane] == kNoPixel) continue;
      const vec3 x(a[t].r[lane], a[t].g[lane], a[t].b[lane]);
      const vec3 y(b[t].r[lane], b[t].g[lane], b[t].b[lane]);
      largest = std::max(largest, maxOf(abs(x - y)) / 2.0f);
    }
  return largest;
}

TEST(Upsample, KeepsTexturesAndGlossyReflectionsSharp) {
  // Every sample's albedo, roughness and reflectance are drawn at random, the light changes slowly: by 0.02
  // to 0.05 over the three cells' widths that a filter spans at most.
  for (const bool lambertian : {true, false}) {
    const ViewSamples view =
        makeView({.width = 200, .height = 120, .lambertian = lambertian, .bentNormals = false});
    const Radiance expected = estimate(view);
    for (const std::uint32_t side : {2u, 3u, 4u, 7u})
      EXPECT_LT(largestError(view, upsampled(view, side, UpsampleWeights::kDepth), expected), 0.06f)
          << side << (lambertian ? " lambertian" : " glossy");
  }
}

TEST(Upsample, GivesEveryPixelLightWhateverItsNeighboursAre) {
  // Shading normals that differ at random leave many pixels without a sample like them.
  const ViewSamples view = makeView({.width = 130, .height = 75, .secondaryTiles = 9});
  const Radiance expected = estimate(view);
  Stats stats;
  const Radiance light = upsampled(view, 4, UpsampleWeights::kDepth, bestSimdLevel(), 0, &stats);
  EXPECT_GT(stats.counter("upsample.pixelsOfTheirOwn"), 0.0);
  EXPECT_LT(largestError(view, light, expected), 0.08f);
}

TEST(Upsample, TakesMirrorsAndGlassAsTheyAre) {
  const ViewSamples view = makeView({.width = 64, .height = 48, .secondaryTiles = 9});
  const Radiance expected = estimate(view);
  const Radiance light = upsampled(view, 4, UpsampleWeights::kDepth);
  ASSERT_EQ(light.size(), expected.size());
  EXPECT_EQ(std::memcmp(&light[view.primaryTiles], &expected[view.primaryTiles], 9 * sizeof(RadianceTile)),
            0);
}

TEST(Upsample, TellsWhatTheEyeSeesDirectly) {
  const ViewSamples view = makeView({.width = 64, .height = 48, .secondaryTiles = 9});
  Upsample upsample({UpsampleWeights::kDepth});
  Stats stats;
  const ViewSamples& sparse = upsample.choose({view, 4}, stats);
  EXPECT_EQ(sparse.tiles.size() - sparse.directTiles, 9u);
  EXPECT_GT(sparse.directTiles, sparse.primaryTiles) << "pixels of their own are seen directly too";
}

TEST(Upsample, SimdLevelsGiveTheSameBytes) {
  const ViewSamples view = makeView({.width = 150, .height = 90, .secondaryTiles = 3});
  const Radiance expected = upsampled(view, 4, UpsampleWeights::kDepth, SimdLevel::kBaseline);
  for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (level > bestSimdLevel()) continue;
    const Radiance light = upsampled(view, 4, UpsampleWeights::kDepth, level);
    EXPECT_EQ(largestError(view, light, expected), 0.0f) << name(level);
  }
}

TEST(Upsample, TakesOtherPixelsInEveryPass) {
  const ViewSamples view = makeView({.width = 96, .height = 64, .lambertian = true, .bentNormals = false});
  const Radiance expected = estimate(view);
  const Radiance first = upsampled(view, 4, UpsampleWeights::kDepth);
  const Radiance second = upsampled(view, 4, UpsampleWeights::kDepth, bestSimdLevel(), 1);
  EXPECT_GT(largestError(view, first, second), 0.0f);
  EXPECT_LT(largestError(view, second, expected), 0.06f);
}

TEST(Upsample, SamplesOfOtherSurfacesCountForNothing) {
  const vec3 here(0.0f), up(0, 1, 0), across(1, 0, 0);
  const auto weight = [&](uint weights, vec3 position, vec3 normal) {
    return upsampleSurfaceWeight(weights, here, up, up, 1.0f, position, normal);
  };
  const vec3 beside(0.7f, 0.0f, 0.7f);
  EXPECT_FLOAT_EQ(weight(kUpsampleDepth, beside, up), 1.0f);
  EXPECT_EQ(weight(kUpsampleDepth, beside, across), 0.0f);
  EXPECT_EQ(weight(kUpsampleDepth, beside - up, up), 0.0f);
  EXPECT_EQ(weight(kUpsampleNormal, beside, across), 0.0f);
  EXPECT_FLOAT_EQ(weight(kUpsampleNormal, beside - up, up), 1.0f);
  EXPECT_FLOAT_EQ(weight(kUpsampleBilinear, beside, across), 1.0f);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/ray_order.h"

#include "math/rng.shared.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace isophote {
namespace {

TEST(RaySort, SortsStablyWhateverTheNumber) {
  RaySort sort;
  for (const std::uint32_t count : {0u, 1u, 2u, 1000u, 16'384u, 16'385u, 100'000u}) {
    for (const std::uint32_t bits : {1u, 9u, 12u, 13u, 24u, 32u}) {
      LargeVector<KeyedRay> rays(count);
      for (std::uint32_t i = 0; i < count; ++i) rays[i] = {hash3(uvec3(i, count, bits)).x >> (32 - bits), i};
      LargeVector<KeyedRay> expected = rays;
      std::ranges::stable_sort(expected, {}, &KeyedRay::key);
      sort.sort(rays, bits);
      ASSERT_EQ(rays.size(), count);
      for (std::uint32_t i = 0; i < count; ++i) {
        ASSERT_EQ(rays[i].key, expected[i].key);
        ASSERT_EQ(rays[i].index, expected[i].index) << count << " rays, " << bits << " bits";
      }
    }
  }
}

/// Every cell has a key of its own, and those of one place keep together whatever the direction.
TEST(RayKeys, PlaceFirstThenDirection) {
  const RayKeys keys({vec3(-1, 2, 3), vec3(3, 4, 11)});
  const vec3 size(4, 2, 8);
  constexpr int kCells = 1 << RayKeys::kCellBits, kSides = 1 << RayKeys::kDirectionBits;
  std::vector<std::uint32_t> seen;
  for (int i = 0; i < kCells * kCells * kCells; ++i) {
    const vec3 cell(i % kCells, i / kCells % kCells, i / kCells / kCells);
    const vec3 origin = vec3(-1, 2, 3) + (cell + 0.5f) * size / float(kCells);
    const std::uint32_t key = keys.key(origin, {1, 0, 0});
    seen.push_back(key >> (3 * RayKeys::kDirectionBits));
    ASSERT_EQ(keys.key(origin, {0, -0.6f, 0.8f}) >> (3 * RayKeys::kDirectionBits), seen.back());
    ASSERT_LT(key, 1u << RayKeys::kBits);
  }
  std::ranges::sort(seen);
  EXPECT_EQ(std::ranges::unique(seen).begin(), seen.end());
  std::vector<std::uint32_t> sides;
  for (int i = 0; i < kSides * kSides * kSides; ++i) {
    const vec3 side(i % kSides, i / kSides % kSides, i / kSides / kSides);
    sides.push_back(keys.key({0, 3, 5}, (side + 0.5f) * (2.0f / kSides) - 1.0f));
  }
  std::ranges::sort(sides);
  EXPECT_EQ(std::ranges::unique(sides).begin(), sides.end());
  EXPECT_EQ(sides.back() - sides.front() + 1, sides.size());
}

/// Rays may leave spheres of lights outside the bounds, and scenes may be flat.
TEST(RayKeys, StayInRangeOutsideTheBounds) {
  const RayKeys keys({vec3(0), vec3(1, 0, 1)});
  EXPECT_EQ(keys.key(vec3(-1e30f), vec3(-1, 0, 0)) >> (3 * RayKeys::kDirectionBits), 0u);
  EXPECT_LT(keys.key(vec3(1e30f), vec3(1, 1, 1)), 1u << RayKeys::kBits);
}

}  // namespace
}  // namespace isophote

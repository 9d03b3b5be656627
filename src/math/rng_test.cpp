// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/rng.shared.h"

#include "math/sobol.shared.h"
#include "support/statistics.h"

#include <set>

namespace isophote {
namespace {

constexpr std::uint32_t kNumbers = testSamples(400'000);

/// Counts over 32 x 32 cells of pairs (x(i), y(i)), which show both an uneven number and a bond between two.
template <class Pair>
testing::AssertionResult pairsAreIndependent(Pair&& pair, int tests) {
  constexpr int kSide = 32;
  std::vector<double> observed(kSide * kSide), expected(kSide * kSide, double(kNumbers) / (kSide * kSide));
  for (std::uint32_t i = 0; i < kNumbers; ++i) {
    const vec2 p = pair(i);
    if (!(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f))
      return testing::AssertionFailure() << "a number lies outside of [0, 1)";
    ++observed[std::size_t(int(p.x * kSide) * kSide + int(p.y * kSide))];
  }
  return countsMatch(observed, expected, tests);
}

TEST(Random, NumbersOfOneTripleAreIndependent) {
  const uint key = pathKey(1, 0, 0, 0);
  const auto triple = [&](uint i) { return random3(key, i, 0); };
  EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(triple(i).x, triple(i).y); }, 3));
  EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(triple(i).y, triple(i).z); }, 3));
  EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(triple(i).z, triple(i).x); }, 3));
}

TEST(Random, PathsBouncesAndDimensionsAreIndependent) {
  const auto at = [](uint path, uint bounce, uint dimension) {
    return random3(pathKey(7, 3, 1, path), bounce, dimension);
  };
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(at(i, 0, 0)[k], at(i + 1, 0, 0)[k]); }, 9));
    EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(at(i, 0, 0)[k], at(i, 1, 0)[k]); }, 9));
    EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(at(i, 2, 0)[k], at(i, 2, 1)[k]); }, 9));
  }
}

TEST(Random, SeedsPassesAndLightsAreIndependent) {
  const auto first = [](uint seed, uint pass, uint light, uint path) {
    return random3(pathKey(seed, pass, light, path), 0, 0).x;
  };
  EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(first(1, 0, 0, i), first(2, 0, 0, i)); }, 4));
  EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(first(1, 0, 0, i), first(1, 1, 0, i)); }, 4));
  EXPECT_TRUE(pairsAreIndependent([&](uint i) { return vec2(first(1, 0, 0, i), first(1, 0, 1, i)); }, 4));
  // Steps of a power of two are where weak hashes show.
  EXPECT_TRUE(
      pairsAreIndependent([&](uint i) { return vec2(first(1, 0, 0, i << 10), first(1, 0, 0, i)); }, 4));
}

/// Owen scrambling turns a seed's low bits into the highest of a point: they must be as good as the others.
TEST(Random, LowBitsOfTheHashAreIndependentToo) {
  const auto low = [](uvec3 v, int k) { return unitFloat(reverseBits(hash3(v)[k])); };
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(pairsAreIndependent(
          [&](uint i) { return vec2(low(uvec3(i, 0, 5), j), low(uvec3(i, 1, 5), k)); }, 18))
          << j << k;
      EXPECT_TRUE(pairsAreIndependent(
          [&](uint i) { return vec2(low(uvec3(i, 7, 2), j), low(uvec3(i, 7, 3), k)); }, 18))
          << j << k;
    }
}

/// Of n keys of 32 bits, n^2 / 2^33 pairs are equal by chance.
TEST(Random, KeysRarelyMeet) {
  std::set<uint> keys;
  constexpr uint kKeys = testSamples(200'000);
  for (uint i = 0; i < kKeys; ++i) keys.insert(pathKey(5, 1, 2, i));
  const double expected = double(kKeys) * double(kKeys) / 8589934592.0;
  EXPECT_LT(double(kKeys - keys.size()), expected + zScore(kFalseAlarm) * std::sqrt(expected) + 1.0);
}

TEST(Random, NumbersDependOnTheirKeysAlone) {
  EXPECT_EQ(random3(pathKey(1, 2, 3, 4), 5, 6), random3(pathKey(1, 2, 3, 4), 5, 6));
  EXPECT_EQ(unitFloat(0), 0.0f);
  EXPECT_LT(unitFloat(0xffffffffu), 1.0f);
  EXPECT_EQ(unitFloat(0x80000000u), 0.5f);
}

}  // namespace
}  // namespace isophote

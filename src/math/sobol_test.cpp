// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/sobol.shared.h"

#include "math/rng.shared.h"
#include "support/statistics.h"

#include <array>

namespace isophote {
namespace {

const uint kSeeds[] = {0u, 1u, 0x9e3779b9u, 0xdeadbeefu, 0xffffffffu};

/// Of the 2^k points each interval of length 2^-k holds one.
bool isStratified(uint k, uint first, auto&& bits) {
  std::vector<bool> taken(std::size_t(1) << k);
  for (uint i = 0; i < (1u << k); ++i) {
    const std::size_t interval = k == 0 ? 0 : bits(first + i) >> (32 - k);
    if (taken[interval]) return false;
    taken[interval] = true;
  }
  return true;
}

TEST(Sobol, EveryDimensionIsStratified) {
  for (uint d = 0; d < kSobolDimensions; ++d)
    for (uint k = 0; k <= 14; ++k)
      for (const uint block : {0u, 1u, 5u})
        EXPECT_TRUE(isStratified(k, block << k, [&](uint i) { return sobolBits(i, d); })) << d << ' ' << k;
}

TEST(Sobol, ScramblingKeepsTheStrata) {
  for (const uint seed : kSeeds)
    for (uint d = 0; d < kSobolDimensions; ++d)
      for (uint k = 1; k <= 12; ++k)
        EXPECT_TRUE(isStratified(k, 0, [&](uint i) { return owenScramble(sobolBits(i, d), seed + d); }))
            << d << ' ' << k << ' ' << seed;
}

/// A (0, 2)-sequence: of every 2^k points in order, each box of area 2^-k whose sides are powers of two holds
/// one.
TEST(Sobol, FirstTwoDimensionsFillEveryElementaryInterval) {
  for (const uint seed : kSeeds)
    for (const bool scrambled : {false, true})
      for (uint k = 0; k <= 10; ++k)
        for (uint wide = 0; wide <= k; ++wide)
          for (const uint block : {0u, 3u}) {
            std::vector<bool> taken(std::size_t(1) << k);
            for (uint i = 0; i < (1u << k); ++i) {
              std::array<uint, 2> bits{sobolBits((block << k) + i, 0), sobolBits((block << k) + i, 1)};
              if (scrambled) bits = {owenScramble(bits[0], seed), owenScramble(bits[1], ~seed)};
              const std::size_t column = std::uint64_t(bits[0]) >> (32 - wide);
              const std::size_t row = std::uint64_t(bits[1]) >> (32 - (k - wide));
              const std::size_t box = (column << (k - wide)) | row;
              ASSERT_FALSE(taken[box]) << "k " << k << " wide " << wide << " seed " << seed;
              taken[box] = true;
            }
          }
}

TEST(Sobol, PointsOfABlockDifferFromItsFirstByThoseOfTheSequence) {
  for (uint d = 0; d < kSobolDimensions; ++d)
    for (const uint base : {1024u, 7u * 1024u, 0xfffffc00u})
      for (uint j = 0; j < 1024; ++j)
        ASSERT_EQ(sobolBits(base + j, d), sobolBits(base, d) ^ sobolBits(j, d)) << d << ' ' << base;
}

TEST(Sobol, DimensionsDiffer) {
  for (uint d = 0; d < kSobolDimensions; ++d)
    for (uint e = 0; e < d; ++e) {
      uint different = 0;
      for (uint i = 0; i < 256; ++i) different += sobolBits(i, d) != sobolBits(i, e) ? 1u : 0u;
      EXPECT_GT(different, 128u) << d << ' ' << e;
    }
}

TEST(Sobol, BitsAreReversed) {
  EXPECT_EQ(reverseBits(1u), 0x80000000u);
  EXPECT_EQ(reverseBits(0x12345678u), 0x1e6a2c48u);
  EXPECT_EQ(reverseBits(reverseBits(0xcafebabeu)), 0xcafebabeu);
}

/// Over seeds, a scrambled point lies anywhere, in one dimension wherever it lies in another: else pictures
/// of few samples are biased.
TEST(Sobol, ScramblesAreUniformOverTheirSeeds) {
  const uint n = testSamples(300'000);
  for (const uint point : {0u, 3u, 100u})
    for (const uint dimension : {1u, 3u, 4u}) {
      const auto scrambled = [&](uint i, uint d) {
        const uint seed = hash3(uvec3(pathKey(1, 0, 0, i), d / 3u, 0x9e3779b9u))[int(d % 3u)];
        return std::size_t(owenScramble(sobolBits(point, d), seed) >> 27);
      };
      std::vector<double> observed(1024), expected(1024, double(n) / 1024);
      for (uint i = 0; i < n; ++i) ++observed[scrambled(i, 0) * 32 + scrambled(i, dimension)];
      EXPECT_TRUE(countsMatch(observed, expected, 9)) << point << ' ' << dimension;
    }
}

/// Why they are used: an integral of a smooth function errs far less than with independent numbers.
TEST(Sobol, IntegratesSmoothFunctionsWell) {
  double sum = 0;
  constexpr uint kPoints = 4096;
  for (uint i = 0; i < kPoints; ++i) {
    const float x = unitFloat(owenScramble(sobolBits(i, 0), 11u));
    const float y = unitFloat(owenScramble(sobolBits(i, 1), 12u));
    sum += double(x * x * y);
  }
  // Independent numbers would err by 3.7e-3.
  EXPECT_NEAR(sum / kPoints, 1.0 / 6, 1e-4);
}

}  // namespace
}  // namespace isophote

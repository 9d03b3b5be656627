// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/rng.shared.h"
#include "math/sampling.shared.h"
#include "math/sobol.shared.h"

#include <array>
#include <cstdint>
#include <vector>

namespace isophote {

/// Sobol dimensions of a path: what emission takes, then three for each of the first two scattering events.
inline constexpr std::uint32_t kMainDimension = 0;    ///< Two: direction; position where that alone varies.
inline constexpr std::uint32_t kOtherDimension = 2;   ///< Two: position on the light.
inline constexpr std::uint32_t kChoiceDimension = 4;  ///< Triangle of a mesh light, side of an environment.
inline constexpr std::uint32_t kSideDimension = 5;    ///< Side of a triangle that emits from both.
inline constexpr std::uint32_t kEventDimension = 6;   ///< Lobe and roulette, then two for the direction.
inline constexpr std::uint32_t kSobolEvents = 2;
static_assert(kEventDimension + 3 * kSobolEvents == kSobolDimensions);

/// Unscrambled Sobol bits of every digit of an index: those of the index are their XOR.
struct SobolTable {
  static constexpr std::uint32_t kDigitBits = 11;
  static constexpr std::uint32_t kDigit = (1u << kDigitBits) - 1;

  SobolTable();
  /// By dimension, place of the digit and digit.
  alignas(64) std::array<std::array<std::array<std::uint32_t, kDigit + 1>, 3>, kSobolDimensions> bits;
};

/// The random numbers of one pass, written for many paths at a time, of any lights.
struct PathRandom {
  const SobolTable* sobol;
  std::uint32_t seed = 0;
  std::uint32_t pass = 0;
  std::vector<std::uint32_t> scramble;  ///< By light, then dimension.

  explicit PathRandom(const SobolTable& table) : sobol(&table) {}
  void start(std::uint32_t newSeed, std::uint32_t newPass, std::size_t lights);
};

/// Numbers in [0, 1) of one Sobol dimension. (Processors gather by indices of type int.)
SHARED_FN void sobolBody(const PathRandom& random, std::uint32_t dimension,
                         const std::uint32_t* __restrict paths, const std::uint32_t* __restrict lights,
                         std::uint32_t count, float* __restrict out) {
  const auto& bits = random.sobol->bits[dimension];
  const std::uint32_t* __restrict low = bits[0].data();
  const std::uint32_t* __restrict middle = bits[1].data();
  const std::uint32_t* __restrict high = bits[2].data();
  const std::uint32_t* __restrict scramble = random.scramble.data() + dimension;
  constexpr std::uint32_t kShift = SobolTable::kDigitBits, kMask = SobolTable::kDigit;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t path = paths[i];
    const std::uint32_t point =
        low[int(path & kMask)] ^ middle[int(path >> kShift & kMask)] ^ high[int(path >> (2 * kShift))];
    out[i] = unitFloat(owenScramble(point, scramble[int(lights[i] * kSobolDimensions)]));
  }
}

/// The three numbers of a scattering event beyond those that the Sobol sequence serves.
SHARED_FN void hashedBody(const PathRandom& random, std::uint32_t event, const std::uint32_t* paths,
                          const std::uint32_t* lights, std::uint32_t count, float* first, float* second,
                          float* third) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 u = random3(pathKey(random.seed, random.pass, lights[i], paths[i]), event, 0u);
    first[i] = u.x;
    second[i] = u.y;
    third[i] = u.z;
  }
}

}  // namespace isophote

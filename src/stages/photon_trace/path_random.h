// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/rng.shared.h"
#include "math/sampling.shared.h"
#include "math/simd.h"
#include "math/sobol.shared.h"

#include <array>
#include <cstdint>
#include <memory>

namespace isophote {

/// Paths that are traced together: a block of this many consecutive indices of one light, aligned to it.
inline constexpr std::uint32_t kPathsPerBlock = 1024;

/// Sobol dimensions of a path: what emission takes, then three for each of the first two scattering events.
inline constexpr std::uint32_t kMainDimension = 0;    ///< Two: direction; position where that alone varies.
inline constexpr std::uint32_t kOtherDimension = 2;   ///< Two: position on the light.
inline constexpr std::uint32_t kChoiceDimension = 4;  ///< Triangle of a mesh light.
inline constexpr std::uint32_t kSideDimension = 5;    ///< Side of a triangle that emits from both.
inline constexpr std::uint32_t kEventDimension = 6;   ///< Lobe and roulette, then two for the direction.
inline constexpr std::uint32_t kSobolEvents = 2;
static_assert(kEventDimension + 3 * kSobolEvents == kSobolDimensions);

/// Unscrambled Sobol bits of the first block of indices; those of a later block differ by one XOR.
struct SobolTable {
  SobolTable();
  alignas(64) std::array<std::array<std::uint32_t, kPathsPerBlock>, kSobolDimensions> bits;
};

/// The random numbers of one block of paths, written for many paths at a time.
struct BlockRandom {
  const SobolTable* table;
  std::uint32_t base;  ///< Index of the block's first path.
  std::uint32_t seed;
  std::uint32_t pass;
  std::uint32_t light;
  std::array<std::uint32_t, kSobolDimensions> baseBits;
  std::array<std::uint32_t, kSobolDimensions> scramble;

  BlockRandom(const SobolTable& sobol, std::uint32_t seedIn, std::uint32_t passIn, std::uint32_t lightIn,
              std::uint32_t baseIn);
};

/// Numbers in [0, 1) of one Sobol dimension for the paths base + paths[0 .. count).
SHARED_FN void sobolBody(const BlockRandom& random, std::uint32_t dimension,
                         const std::uint32_t* __restrict paths, std::uint32_t count, float* __restrict out) {
  const std::uint32_t* __restrict bits = random.table->bits[dimension].data();
  const std::uint32_t base = random.baseBits[dimension];
  const std::uint32_t scramble = random.scramble[dimension];
  for (std::uint32_t i = 0; i < count; ++i)
    out[i] = unitFloat(owenScramble(bits[int(paths[i])] ^ base, scramble));
}

/// The three numbers of a scattering event beyond those that the Sobol sequence serves.
SHARED_FN void hashedBody(const BlockRandom& random, std::uint32_t event, const std::uint32_t* paths,
                          std::uint32_t count, float* first, float* second, float* third) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const uint key = pathKey(random.seed, random.pass, random.light, random.base + paths[i]);
    const vec3 u = random3(key, event, 0u);
    first[i] = u.x;
    second[i] = u.y;
    third[i] = u.z;
  }
}

}  // namespace isophote

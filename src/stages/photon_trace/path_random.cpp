// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/path_random.h"

namespace isophote {

SobolTable::SobolTable() {
  for (std::uint32_t d = 0; d < kSobolDimensions; ++d)
    for (std::uint32_t i = 0; i < kPathsPerBlock; ++i) bits[d][i] = sobolBits(i, d);
}

BlockRandom::BlockRandom(const SobolTable& sobol, std::uint32_t seedIn, std::uint32_t passIn,
                         std::uint32_t lightIn, std::uint32_t baseIn)
    : table(&sobol), base(baseIn), seed(seedIn), pass(passIn), light(lightIn) {
  const uvec3 key = hash3(uvec3(seed, pass, light));
  for (std::uint32_t d = 0; d < kSobolDimensions; ++d) {
    baseBits[d] = sobolBits(base, d);
    scramble[d] = hash3(uvec3(key.x, key.y, key.z + d)).x;
  }
}

}  // namespace isophote

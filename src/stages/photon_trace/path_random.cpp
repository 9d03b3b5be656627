// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/path_random.h"

namespace isophote {

SobolTable::SobolTable() {
  for (std::uint32_t d = 0; d < kSobolDimensions; ++d) {
    for (std::uint32_t place = 0; place < 3; ++place) {
      auto& ofDigit = bits[d][place];
      ofDigit[0] = 0;
      for (std::uint32_t i = 1; i <= kDigit; ++i) {
        const std::uint32_t lowest = i & -i;
        ofDigit[i] = ofDigit[i - lowest] ^ sobolBits(lowest << (place * kDigitBits), d);
      }
    }
  }
}

void PathRandom::start(std::uint32_t newSeed, std::uint32_t newPass, std::size_t lights) {
  seed = newSeed;
  pass = newPass;
  scramble.resize(lights * kSobolDimensions);
  for (std::uint32_t light = 0; light < lights; ++light) {
    const uvec3 key = hash3(uvec3(seed, pass, light));
    for (std::uint32_t d = 0; d < kSobolDimensions; ++d)
      scramble[light * kSobolDimensions + d] = hash3(uvec3(key.x, key.y, key.z + d)).x;
  }
}

}  // namespace isophote

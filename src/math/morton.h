// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <cstdint>

namespace isophote {

/// Puts a 0 between any two bits of a number below 2^16.
SHARED_FN std::uint32_t spreadByOne(std::uint32_t v) {
  v = (v | (v << 8)) & 0x00ff00ffu;
  v = (v | (v << 4)) & 0x0f0f0f0fu;
  v = (v | (v << 2)) & 0x33333333u;
  return (v | (v << 1)) & 0x55555555u;
}

/// Puts two 0s between any two bits of a number below 2^10.
SHARED_FN std::uint32_t spreadByTwo(std::uint32_t v) {
  v = (v | (v << 16)) & 0x030000ffu;
  v = (v | (v << 8)) & 0x0300f00fu;
  v = (v | (v << 4)) & 0x030c30c3u;
  return (v | (v << 2)) & 0x09249249u;
}

/// Place along a Morton curve of a cell whose coordinates are those of `v`, cut off and held within `bits`
/// bits, at most 10.
SHARED_FN std::uint32_t mortonCode(vec3 v, std::uint32_t bits) {
  const float last = float((1u << bits) - 1);
  const auto at = [last](float x) __attribute__((always_inline)) {
    return spreadByTwo(std::uint32_t(int(min(max(x, 0.0f), last))));
  };
  return at(v.x) | at(v.y) << 1 | at(v.z) << 2;
}

}  // namespace isophote

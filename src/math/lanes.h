// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace isophote {

/// One number of each of kCount things side by side, for loops that ISOPHOTE_SIMD compiles.
template <class T, std::uint32_t kCount>
struct alignas(64) Lanes {
  T values[kCount]{};
  SHARED_FN T& operator[](std::uint32_t i) { return values[i]; }
  SHARED_FN const T& operator[](std::uint32_t i) const { return values[i]; }
};

/// Likewise a vector of each.
template <std::uint32_t kCount>
struct Vec3Lanes {
  Lanes<float, kCount> x, y, z;
  SHARED_FN vec3 operator[](std::uint32_t i) const { return vec3(x[i], y[i], z[i]); }
  SHARED_FN void set(std::uint32_t i, vec3 v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

namespace detail {

inline constexpr auto kBits = [] {
  std::array<std::uint32_t, 32> bits{};
  for (std::uint32_t i = 0; i < 32; ++i) bits[i] = 1u << i;
  return bits;
}();

}  // namespace detail

/// Bit i is set where holds(i), for i from 0 to 63: 32 lanes are gathered at a time, without shifting by the
/// lane, because processors have no shift of bytes.
template <class Holds>
SHARED_FN std::uint64_t bitsWhere(Holds&& holds) {
  std::uint64_t all = 0;
  for (int half = 0; half < 64; half += 32) {
    std::uint32_t bits = 0;
    for (int i = 0; i < 32; ++i) bits |= holds(half + i) ? detail::kBits[std::size_t(i)] : 0u;
    all |= std::uint64_t(bits) << half;
  }
  return all;
}

}  // namespace isophote

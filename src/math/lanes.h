// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

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

}  // namespace isophote

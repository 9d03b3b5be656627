// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The order in which rays are traced: neighbours start near each other in similar directions, so that what
// they read of the scene is still in the caches, and Embree follows sixteen at once.
#pragma once

#include "base/keyed_sort.h"
#include "math/bounds.h"
#include "math/morton.h"

#include <cstdint>

namespace isophote {

/// A ray to be traced: the key that it is sorted by, and where its path is found.
using KeyedRay = KeyedIndex;
using RaySort = KeyedSort;

/// Keys of rays that leave surfaces: the cell of the scene's bounds in which the ray starts, along a Morton
/// curve, then the cell of directions.
struct RayKeys {
  static constexpr std::uint32_t kCellBits = 5;       ///< Of each coordinate of the origin.
  static constexpr std::uint32_t kDirectionBits = 3;  ///< Of each component of the direction.
  static constexpr std::uint32_t kBits = 3 * (kCellBits + kDirectionBits);

  vec3 lower;
  vec3 cellsPerMetre;

  explicit RayKeys(const Bounds& bounds)
      : lower(bounds.lower), cellsPerMetre(float(1u << kCellBits) / max(bounds.size(), vec3(1e-30f))) {}

  SHARED_FN std::uint32_t key(vec3 origin, vec3 direction) const {
    const vec3 cell = (origin - lower) * cellsPerMetre;
    const vec3 side = (direction + 1.0f) * float(1u << (kDirectionBits - 1));
    return mortonCode(cell, kCellBits) << (3 * kDirectionBits) | mortonCode(side, kDirectionBits);
  }
};

}  // namespace isophote

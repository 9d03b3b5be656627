// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The order in which rays are traced: neighbours start near each other in similar directions, so that what
// they read of the scene is still in the caches, and Embree follows sixteen at once.
#pragma once

#include "base/large_pages.h"
#include "math/bounds.h"
#include "math/shared.h"

#include <cstdint>
#include <vector>

namespace isophote {

/// A ray to be traced: the key that it is sorted by, and where its path is found.
struct KeyedRay {
  std::uint32_t key;
  std::uint32_t index;
};

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
    return interleave(cell, kCellBits) << (3 * kDirectionBits) | interleave(side, kDirectionBits);
  }

 private:
  static SHARED_FN std::uint32_t interleave(vec3 v, std::uint32_t bits) {
    const float last = float((1u << bits) - 1);
    const auto at = [last](float x) __attribute__((always_inline)) {
      return spreadByTwo(std::uint32_t(int(min(max(x, 0.0f), last))));
    };
    return at(v.x) | at(v.y) << 1 | at(v.z) << 2;
  }
};

/// Sorts by key, stably, on all threads; keeps its memory for the next time.
class RaySort {
 public:
  /// All keys are below 2^keyBits.
  void sort(LargeVector<KeyedRay>& rays, std::uint32_t keyBits);

 private:
  void pass(std::uint32_t shift, std::uint32_t digitBits, const LargeVector<KeyedRay>& from,
            LargeVector<KeyedRay>& to);

  LargeVector<KeyedRay> other_;
  std::vector<std::uint32_t> places_;  ///< By chunk of the rays, then digit.
};

}  // namespace isophote

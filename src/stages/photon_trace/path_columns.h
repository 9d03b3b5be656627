// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"
#include "stages/photon_trace/path_random.h"

#include <cstdint>

namespace isophote {

/// One number of each path of a block.
template <class T>
struct alignas(64) Column {
  T values[kPathsPerBlock]{};
  SHARED_FN T& operator[](std::uint32_t i) { return values[i]; }
  SHARED_FN const T& operator[](std::uint32_t i) const { return values[i]; }
};

struct VectorColumn {
  Column<float> x, y, z;
  SHARED_FN vec3 operator[](std::uint32_t i) const { return vec3(x[i], y[i], z[i]); }
  SHARED_FN void set(std::uint32_t i, vec3 v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// Paths on their way, side by side, so that loops over many read them at full width.
struct PathColumns {
  Column<std::uint32_t> path;  ///< Index within the block.
  VectorColumn origin;         ///< Of the ray.
  VectorColumn direction;
  VectorColumn power;     ///< Carried along it [W].
  Column<float> density;  ///< Photon::pathDensity.
};

}  // namespace isophote

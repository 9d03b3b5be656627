// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/lanes.h"
#include "stages/photon_trace/path_state.h"

namespace isophote {

/// Rays that one thread traces and shades before it takes the next: what it knows of them fits its caches.
inline constexpr std::uint32_t kRaysPerPiece = 1024;

/// One number of each path of a piece.
template <class T>
using Column = Lanes<T, kRaysPerPiece>;
using VectorColumn = Vec3Lanes<kRaysPerPiece>;

/// Members of PathState side by side, so that loops over many paths read them at full width.
struct PathColumns {
  Column<std::uint32_t> path, light;
  VectorColumn origin, direction, power;
  Column<float> density;
  Column<std::uint32_t> medium;

  void set(std::uint32_t i, const PathState& s) {
    path[i] = s.path;
    light[i] = s.light;
    origin.set(i, s.origin);
    direction.set(i, s.direction);
    power.set(i, s.power);
    density[i] = s.density;
    medium[i] = s.medium;
  }
};

}  // namespace isophote

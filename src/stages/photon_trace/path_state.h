// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <cstdint>

namespace isophote {

/// A photon path between two hits.
struct PathState {
  vec3 origin;        ///< Of the ray to the next hit, off the surface that it leaves.
  float density = 1;  ///< Photon::pathDensity.
  vec3 direction;     ///< Unit.
  std::uint32_t path =
      0;       ///< Index among the paths of its light: with `light`, the key of its random numbers.
  vec3 power;  ///< Carried along the ray, divided by the number of paths of the light [W].
  std::uint32_t light = 0;  ///< Index into Scene::lights.
  /// Index of the instance whose inside the ray goes through, plus 1; 0 for none. For scenes that absorb.
  std::uint32_t medium = 0;
};
static_assert(sizeof(PathState) == 52);

}  // namespace isophote

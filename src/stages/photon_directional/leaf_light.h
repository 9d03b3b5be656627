// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_directional/octants.shared.h"

#include <cstdint>

namespace isophote::photon_directional {

/// The light that arrived at a leaf, by octant.
struct LeafLight {
  float r[kOctants], g[kOctants], b[kOctants];  ///< Flux over area [W/m^2].
  /// 1 / mean of octantIrradiance over the normals of the leaf's samples (of both signs where it transmits);
  /// 0 where none sees the octant. Unused with the published weights.
  float inverseSeen[kOctants];
  vec3 sum() const;
};

/// Adds the sums of octantIrradiance over the geometric normals of lanes whose bits are set.
using SeeFn = void (*)(const ViewTile& tile, std::uint64_t lanes, float* seen);
SeeFn seeFor(SimdLevel level);

/// What octants are and what they count.
struct OctantRule {
  bool published = false;
  vec3 right, up, back;    ///< Axes of the published octants, those of the view.
  vec3 middles[kOctants];  ///< Of the published octants.

  uint octant(vec3 d) const {
    return published ? octantOf(vec3(dot(d, right), dot(d, up), dot(d, back))) : octantOf(d);
  }
};

/// Overwrites `reflectance` with the reflectance over pi of a tile's lanes towards the eye.
using ReflectFn = void (*)(const ViewTile& tile, RadianceTile& reflectance);
ReflectFn reflectFor(SimdLevel level);

/// Some lanes of a tile that belong to one leaf.
struct LeafLanes {
  std::uint64_t lanes;  ///< A bit each.
  bool flat;            ///< Their shading normals are the geometric ones.
  bool narrow;          ///< All geometric normals of the leaf are `axis`.
  vec3 axis;
};

/// Sets the irradiance of the lanes, and multiplies their reflectance by what shading normals change.
using ShadeFn = void (*)(const ViewTile& tile, const LeafLanes& leaf, const LeafLight& light,
                         const OctantRule& rule, RadianceTile& irradiance, RadianceTile& reflectance);
ShadeFn shadeFor(const OctantRule& rule, SimdLevel level);

/// Sets the irradiance of lanes that all feel the same light.
void shadeAlike(std::uint64_t lanes, vec3 light, RadianceTile& irradiance);

/// Likewise of a leaf that light goes through: irradiance of both sides, and the reflectance says how much of
/// it comes to the eye. Sets the reflectance.
void shadeTransmitting(const ViewTile& tile, std::uint64_t lanes, const LeafLight& light,
                       const OctantRule& rule, RadianceTile& irradiance, RadianceTile& reflectance);

}  // namespace isophote::photon_directional

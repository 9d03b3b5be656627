// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/photon_estimate/photon_loops.h"
#include "stages/photon_trace/photon_map.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote::photon_estimate {

/// Photons to hand to one call: their spheres stay in the first-level cache for all groups of a tile.
inline constexpr std::uint32_t kSpheresPerCall = 256;

/// Which of the loops, one each so that they stay short.
struct SphereLoopKind {
  bool lambertian = false;  ///< ViewTile::lambertian: sums irradiance.
  bool transmits = false;   ///< ViewTile::transmits.
  bool flat = false;        ///< isFlat().
};

/// A loop over spheres[list[0]] to spheres[list[count - 1]], in that order, against the first `lanes` view
/// samples of a tile, a multiple of kGroupLanes. Adds to `sums` and `counts`. The same bytes at every
/// SimdLevel.
using SphereLoop = void (*)(const ViewTile& tile, const PhotonSphere* spheres, const std::uint32_t* list,
                            std::uint32_t count, int lanes, RadianceTile& sums, PairCounts& counts);

/// `enclosed`: every sample that has a surface is known to lie within every sphere, and is not tested again;
/// lanes without one need a geometric normal of 0.
SphereLoop sphereLoopFor(SphereLoopKind kind, bool enclosed, SimdLevel level);

/// Runs a loop over a whole list.
void runSphereLoop(SphereLoop loop, const ViewTile& tile, const PhotonSphere* spheres,
                   std::span<const std::uint32_t> list, int lanes, RadianceTile& sums, PairCounts& counts);

/// Whether the shading normals of all lanes that have a surface are the geometric ones but for rounding.
bool isFlat(const ViewTile& tile);
/// The same, told by their largest squared distance.
inline bool isFlat(float normalsApart2) {
  constexpr float kSame = 1e-10f;  // An angle of 1e-5: what interpolation of equal normals rounds by.
  return normalsApart2 <= kSame;
}

/// One sphere a photon, in the same order; reuses memory. Throws Error(kBadUsage) that names `setting` where
/// the radius is not a positive number.
void makeSpheres(std::span<const Photon> photons, float radius, std::string_view setting,
                 std::vector<PhotonSphere>& spheres);

}  // namespace isophote::photon_estimate

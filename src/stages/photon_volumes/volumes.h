// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_estimate/tile_blocks.h"
#include "stages/photon_volumes/photon_volumes.h"

#include <vector>

namespace isophote::photon_volumes {

/// One volume a photon, in the map's order; reuses memory. `radius` as in PhotonVolumes::In.
/// Throws Error(kBadUsage) where the radius is not a positive number.
void makeVolumes(const PhotonMap& map, float radius, const PhotonVolumesSettings& settings,
                 std::vector<PhotonVolume>& volumes);

/// Whether a photon's ellipsoid may reach into bounds: never missed where a point of them has
/// ellipsoidDistance2 < 1.
photon_estimate::TouchFn<PhotonVolume> touchFor(SimdLevel level);

}  // namespace isophote::photon_volumes

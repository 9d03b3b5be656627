// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_estimate/block_estimate.h"
#include "stages/photon_quads/photon_quads.h"

#include <vector>

namespace isophote::photon_quads {

/// One quad a photon, in the map's order; reuses memory. Those that turn their back to every sample are
/// culled: they touch no bounds. Returns how many. Throws Error(kBadUsage) where the radius is not a positive
/// number.
std::size_t makeQuads(const PhotonQuads::In& in, const PhotonQuadsSettings& settings,
                      std::vector<PhotonQuad>& quads);

/// Whether a photon may be felt in bounds, in its quad or in its corners' ellipsoid.
photon_estimate::TouchFn<PhotonQuad> touchFor(bool corners, SimdLevel level);

using LoopFor = photon_estimate::TileLoop<PhotonQuad> (*)(const ViewTile& tile, SimdLevel level);
/// Chooses a tile's loop, for quads alone or with volumes in corners.
LoopFor loopsFor(bool corners);

}  // namespace isophote::photon_quads

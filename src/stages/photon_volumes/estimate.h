// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "physics/photon.shared.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_estimate/photon_loops.h"

#include <cstdint>

namespace isophote::photon_volumes {

using photon_estimate::lambertianRadiance;
using photon_estimate::PairCounts;

/// Photons to hand to one call: their volumes stay in the first-level cache for all groups of a tile.
inline constexpr std::uint32_t kPhotonsPerCall = 256;

/// A loop over volumes[list[0]] to volumes[list[count - 1]], in that order, against a tile's view samples.
/// Adds to `sums`, and to `counts`. Every lane does the same operations
/// in the same order at every SimdLevel (no contraction, no reassociation), so that the bytes do not depend
/// on it.
using EstimateFn = void (*)(const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
                            std::uint32_t count, uint kernel, RadianceTile& sums, PairCounts& counts);

/// The loop for a kind of tile: `lambertian` ones (ViewTile::lambertian) sum irradiance [W/m^2], which
/// lambertianRadiance turns into radiance at the end; the other evaluates the full BSDF at every pair.
EstimateFn estimateFor(bool lambertian, SimdLevel level);
/// The loop for that tile: one of these, or where light goes through (ViewTile::transmits) one of its own, so
/// that they stay as short as they are.
EstimateFn estimateFor(const ViewTile& tile, SimdLevel level);

}  // namespace isophote::photon_volumes

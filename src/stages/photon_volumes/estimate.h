// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "physics/photon.shared.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_estimate/block_estimate.h"

namespace isophote::photon_volumes {

using photon_estimate::kPhotonsPerCall;
using photon_estimate::PairCounts;
using EstimateFn = photon_estimate::TileLoop<PhotonVolume>;

/// The loop for a kind of tile: `lambertian` ones (ViewTile::lambertian) sum irradiance [W/m^2], which
/// lambertianRadiance turns into radiance at the end; the other evaluates the full BSDF at every pair.
EstimateFn estimateFor(bool lambertian, SimdLevel level);
/// The loop for that tile: one of these, or where light goes through (ViewTile::transmits) one of its own, so
/// that they stay as short as they are.
EstimateFn estimateFor(const ViewTile& tile, SimdLevel level);

}  // namespace isophote::photon_volumes

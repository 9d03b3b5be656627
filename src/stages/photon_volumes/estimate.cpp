// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/estimate.h"

namespace isophote::photon_volumes {
namespace {

using photon_estimate::WithinEllipsoid;

ISOPHOTE_SIMD(estimateLambertian, photon_estimate::estimateLambertianBody<WithinEllipsoid>,
              (const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
               std::uint32_t count, uint kernel, RadianceTile& sums, PairCounts& counts),
              (tile, volumes, list, count, kernel, kTileLanes, sums, counts))

ISOPHOTE_SIMD(estimateGlossy, photon_estimate::estimateGlossyBody<WithinEllipsoid>,
              (const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
               std::uint32_t count, uint kernel, RadianceTile& sums, PairCounts& counts),
              (tile, volumes, list, count, kernel, kTileLanes, sums, counts))

void estimateTransmitting(const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
                          std::uint32_t count, uint kernel, RadianceTile& sums, PairCounts& counts) {
  photon_estimate::estimateTransmittingBody<WithinEllipsoid>(tile, volumes, list, count, kernel, kTileLanes,
                                                             sums, counts);
}

}  // namespace

EstimateFn estimateFor(const ViewTile& tile, SimdLevel level) {
  return tile.transmits != 0 ? estimateTransmitting : estimateFor(tile.lambertian != 0, level);
}

EstimateFn estimateFor(bool lambertian, SimdLevel level) {
  return lambertian ? estimateLambertianFor(level) : estimateGlossyFor(level);
}

}  // namespace isophote::photon_volumes

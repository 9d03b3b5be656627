// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/estimate.h"

#include "stages/photon_volumes/estimate_body.h"

namespace isophote::photon_volumes {
namespace {

ISOPHOTE_SIMD(estimateLambertian, estimateLambertianBody,
              (const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
               std::uint32_t count, uint kernel, RadianceTile& sums, std::uint64_t& contributing),
              (tile, volumes, list, count, kernel, sums, contributing))

ISOPHOTE_SIMD(estimateGlossy, estimateGlossyBody,
              (const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
               std::uint32_t count, uint kernel, RadianceTile& sums, std::uint64_t& contributing),
              (tile, volumes, list, count, kernel, sums, contributing))

void estimateTransmitting(const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
                          std::uint32_t count, uint kernel, RadianceTile& sums, std::uint64_t& contributing) {
  estimateTransmittingBody(tile, volumes, list, count, kernel, sums, contributing);
}

}  // namespace

EstimateFn estimateFor(const ViewTile& tile, SimdLevel level) {
  return tile.transmits != 0 ? estimateTransmitting : estimateFor(tile.lambertian != 0, level);
}

EstimateFn estimateFor(bool lambertian, SimdLevel level) {
  return lambertian ? estimateLambertianFor(level) : estimateGlossyFor(level);
}

void lambertianRadiance(const ViewTile& tile, RadianceTile& sums) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    sums.r[lane] *= tile.diffuseR[lane] * kInvPi;
    sums.g[lane] *= tile.diffuseG[lane] * kInvPi;
    sums.b[lane] *= tile.diffuseB[lane] * kInvPi;
  }
}

}  // namespace isophote::photon_volumes

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_quads/quads.h"

namespace isophote::photon_quads {
namespace {

using photon_estimate::PairCounts;

struct WithinQuad {
  using Photon = PhotonQuad;
  static constexpr bool kCountsFelt = false;
  static SHARED_FN float felt(const PhotonQuad& p, uint falloff, const ViewTile& tile, int lane) {
    return quadFelt(p, falloff, positionOf(tile, lane), woOf(tile, lane), ngOf(tile, lane));
  }
};

struct WithinQuadOrCorner : WithinQuad {
  static SHARED_FN float felt(const PhotonQuad& p, uint falloff, const ViewTile& tile, int lane) {
    return quadFeltWithCorners(p, falloff, positionOf(tile, lane), woOf(tile, lane), ngOf(tile, lane));
  }
};

/// On tiles through which light goes, samples that transmit feel quads from both sides.
template <class Opaque>
struct WithinSeenThrough : Opaque {
  static SHARED_FN float felt(const PhotonQuad& p, uint falloff, const ViewTile& tile, int lane) {
    if (refractsRoughly(laneOf(tile, lane).bsdf) < 0.5f) return Opaque::felt(p, falloff, tile, lane);
    return quadFeltBothSides(p, falloff, positionOf(tile, lane), woOf(tile, lane), ngOf(tile, lane));
  }
};

#define ISOPHOTE_QUAD_LOOP(name, body)                                                       \
  ISOPHOTE_SIMD(name, body,                                                                  \
                (const ViewTile& tile, const PhotonQuad* quads, const std::uint32_t* list,   \
                 std::uint32_t count, uint falloff, RadianceTile& sums, PairCounts& counts), \
                (tile, quads, list, count, falloff, kTileLanes, sums, counts))

ISOPHOTE_QUAD_LOOP(lambertian, photon_estimate::estimateLambertianBody<WithinQuad>)
ISOPHOTE_QUAD_LOOP(glossy, photon_estimate::estimateGlossyBody<WithinQuad>)
ISOPHOTE_QUAD_LOOP(lambertianCorners, photon_estimate::estimateLambertianBody<WithinQuadOrCorner>)
ISOPHOTE_QUAD_LOOP(glossyCorners, photon_estimate::estimateGlossyBody<WithinQuadOrCorner>)

#undef ISOPHOTE_QUAD_LOOP

template <class Opaque>
void transmitting(const ViewTile& tile, const PhotonQuad* quads, const std::uint32_t* list,
                  std::uint32_t count, uint falloff, RadianceTile& sums, PairCounts& counts) {
  photon_estimate::estimateTransmittingBody<WithinSeenThrough<Opaque>>(tile, quads, list, count, falloff,
                                                                       kTileLanes, sums, counts);
}

photon_estimate::TileLoop<PhotonQuad> loopOfQuads(const ViewTile& tile, SimdLevel level) {
  if (tile.transmits != 0) return transmitting<WithinQuad>;
  return tile.lambertian != 0 ? lambertianFor(level) : glossyFor(level);
}

photon_estimate::TileLoop<PhotonQuad> loopWithCorners(const ViewTile& tile, SimdLevel level) {
  if (tile.transmits != 0) return transmitting<WithinQuadOrCorner>;
  return tile.lambertian != 0 ? lambertianCornersFor(level) : glossyCornersFor(level);
}

}  // namespace

LoopFor loopsFor(bool corners) { return corners ? loopWithCorners : loopOfQuads; }

}  // namespace isophote::photon_quads

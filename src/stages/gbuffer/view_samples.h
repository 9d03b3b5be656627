// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/large_pages.h"
#include "image/image.h"
#include "physics/bsdf.shared.h"
#include "physics/camera.shared.h"
#include "stages/gbuffer/view_tile.shared.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace isophote {

/// One lane, gathered. Only the non-delta lobes of `bsdf` are kept.
struct ViewSample {
  vec3 position;
  vec3 ng;
  vec3 ns;
  vec3 wo;
  Bsdf bsdf;
  vec3 throughput;
  std::uint32_t pixel;
  float entering = 1.0f;  ///< Surface::entering; matters to surfaces that transmit.
};

/// Whether a BSDF reflects diffusely and in no other way that a view sample keeps.
SHARED_FN bool isLambertian(const Bsdf& b) {
  const bool reflects = b.alpha > 0.0f && b.f90 > 0.0f;
  return !reflects && !(b.coupling90 > 0.0f) && refractsRoughly(b) < 0.5f;
}

/// Makes all lanes empty.
void clearTile(ViewTile& tile);
/// Fills an empty lane and updates what the tile says of its lanes together.
void setLane(ViewTile& tile, int lane, const ViewSample& sample);
/// Puts the arrays of the glossy reflection to use: lanes so far have none.
void startGlossy(ViewTile& tile);
/// Puts the arrays of what goes through to use, and those of the glossy reflection: lanes so far transmit
/// nothing.
void startTransmission(ViewTile& tile);
/// Puts the throughput to use: lanes so far have 1.
void startThroughput(ViewTile& tile);
ViewSample laneOf(const ViewTile& tile, int lane);

/// Asks for memory that is read or written soon.
SHARED_FN void want(const void* from, std::size_t bytes) {
  const char* const first = static_cast<const char*>(from);
  for (std::size_t byte = 0; byte < bytes; byte += 64) __builtin_prefetch(first + byte, 0, 2);
}
/// Asks for the arrays of a tile that every stage uses, while the one before it is worked on: processors
/// foresee reads of one array after the other, not of sixteen side by side.
SHARED_FN void wantTile(const ViewTile& t) {
  want(&t, offsetof(ViewTile, f0R));
  want(&t.bounds, 1);
}
/// Likewise positions and normals alone.
SHARED_FN void wantPlaces(const ViewTile& t) {
  want(&t, offsetof(ViewTile, woX));
  want(&t.bounds, 1);
}
/// Likewise of one lane.
SHARED_FN void wantLane(const ViewTile& t, int lane) {
  const char* const from = reinterpret_cast<const char*>(&t) + std::size_t(lane) * sizeof(float);
  for (std::size_t byte = 0; byte < offsetof(ViewTile, f0R); byte += kTileLanes * sizeof(float))
    __builtin_prefetch(from + byte, 0, 3);
}

SHARED_FN vec3 positionOf(const ViewTile& t, int lane) {
  return vec3(t.positionX[lane], t.positionY[lane], t.positionZ[lane]);
}
SHARED_FN vec3 ngOf(const ViewTile& t, int lane) { return vec3(t.ngX[lane], t.ngY[lane], t.ngZ[lane]); }
SHARED_FN vec3 nsOf(const ViewTile& t, int lane) { return vec3(t.nsX[lane], t.nsY[lane], t.nsZ[lane]); }
SHARED_FN vec3 woOf(const ViewTile& t, int lane) { return vec3(t.woX[lane], t.woY[lane], t.woZ[lane]); }
SHARED_FN vec3 diffuseOf(const ViewTile& t, int lane) {
  return vec3(t.diffuseR[lane], t.diffuseG[lane], t.diffuseB[lane]);
}
/// What a lane of a tile that is not `lambertian` reflects. Tells nothing of what goes through.
SHARED_FN Bsdf reflectionOf(const ViewTile& t, int lane) {
  Bsdf b{};
  b.diffuse = diffuseOf(t, lane);
  b.f0 = vec3(t.f0R[lane], t.f0G[lane], t.f0B[lane]);
  b.f90 = t.f90[lane];
  b.alpha = t.alpha[lane];
  b.coupling0 = t.coupling0[lane];
  b.coupling90 = t.coupling90[lane];
  return b;
}

inline vec3 throughputOf(const ViewTile& tile, int lane) {
  if (tile.unitThroughput != 0) return vec3(1.0f);
  return vec3(tile.throughputR[lane], tile.throughputG[lane], tile.throughputB[lane]);
}

/// What the eye sees: the first non-specular surface of every eye path. One primary sample a pixel; mirrors
/// and glass add samples with their throughput.
struct ViewSamples {
  int width = 0;
  int height = 0;
  int tilesX = 0;  ///< Primary tiles in a row: ceil(width / kTileSide).
  int tilesY = 0;
  CameraRays camera;
  /// First tilesX * tilesY primary tiles in rows, lane = 8 * (y % 8) + x % 8: surfaces seen directly. Then
  /// the surfaces seen in mirrors and through glass, in an order that keeps neighbours in space together.
  LargeVector<ViewTile> tiles;
  std::size_t primaryTiles = 0;
  /// The first so many tiles hold nothing but what the eye sees by no mirror or glass; primaryTiles at least.
  std::size_t directTiles = 0;
  /// Radiance that reaches the eye straight from emitters (also by mirrors and through glass): valid in
  /// primary tiles where `emits` is 1, 0 in the others.
  Image emitted;
  std::vector<std::uint8_t> emits;
  // Empty unless asked for:
  Image albedo;  ///< Of the surface seen directly.
  Image normal;  ///< Shading normal of it, world space.
  Image depth;   ///< Distance from the eye in x [m]; 0 where there is no surface.
};

/// One tile for each of ViewSamples::tiles.
using Radiance = LargeVector<RadianceTile>;

}  // namespace isophote

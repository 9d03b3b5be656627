// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"
#include "math/bounds.h"
#include "physics/bsdf.shared.h"
#include "physics/camera.shared.h"

#include <cstdint>
#include <vector>

namespace isophote {

inline constexpr int kTileSide = 8;                       ///< Pixels.
inline constexpr int kTileLanes = kTileSide * kTileSide;  ///< View samples a tile.
inline constexpr std::uint32_t kNoPixel = 0xffffffffu;
inline constexpr float kFarAway = 1e18f;  ///< Position of lanes without a surface, in every coordinate [m].

/// 64 surface points that the eye sees, one array a component so that loops over lanes vectorise.
/// Lanes without a surface have pixel = kNoPixel, position kFarAway (no photon reaches it) and black
/// reflectances.
struct alignas(64) ViewTile {
  float positionX[kTileLanes], positionY[kTileLanes], positionZ[kTileLanes];  ///< World space [m].
  float ngX[kTileLanes], ngY[kTileLanes], ngZ[kTileLanes];  ///< Geometric normal, unit, on the eye's side.
  float nsX[kTileLanes], nsY[kTileLanes], nsZ[kTileLanes];  ///< Shading normal, unit.
  float woX[kTileLanes], woY[kTileLanes],
      woZ[kTileLanes];  ///< Unit, towards the eye (along the last path segment).
  float diffuseR[kTileLanes], diffuseG[kTileLanes], diffuseB[kTileLanes];  ///< Bsdf::diffuse
  float f0R[kTileLanes], f0G[kTileLanes], f0B[kTileLanes];
  float f90[kTileLanes];
  float alpha[kTileLanes];
  float coupling0[kTileLanes], coupling90[kTileLanes];
  float throughputR[kTileLanes], throughputG[kTileLanes],
      throughputB[kTileLanes];      ///< Of the eye path before.
  std::uint32_t pixel[kTileLanes];  ///< y * width + x
  Bounds bounds;                    ///< Of the positions of its lanes that have a surface.
  std::uint32_t count;              ///< Lanes that have a surface.
  std::uint32_t lambertian;  ///< 1: no lane reflects anything but diffusely (alpha, f0, f90 and couplings do
                             ///< not matter).
};

/// One lane, gathered. Only the non-delta lobes of `bsdf` are kept.
struct ViewSample {
  vec3 position;
  vec3 ng;
  vec3 ns;
  vec3 wo;
  Bsdf bsdf;
  vec3 throughput;
  std::uint32_t pixel;
};

/// Makes all lanes empty.
void clearTile(ViewTile& tile);
/// Fills an empty lane and updates what the tile says of its lanes together.
void setLane(ViewTile& tile, int lane, const ViewSample& sample);
ViewSample laneOf(const ViewTile& tile, int lane);

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
  std::vector<ViewTile> tiles;
  std::size_t primaryTiles = 0;
  Image
      emitted;  ///< Radiance that reaches the eye straight from emitters (also by mirrors and through glass).
  Image albedo;  ///< Of the surface seen directly.
  Image normal;  ///< Shading normal of it, world space.
  Image depth;   ///< Distance from the eye in x [m]; 0 where there is no surface.
};

/// Radiance towards the eye at each lane of each ViewTile, eye-path throughput not multiplied in [W/(m^2
/// sr)].
struct alignas(64) RadianceTile {
  float r[kTileLanes] = {}, g[kTileLanes] = {}, b[kTileLanes] = {};
};

using Radiance = std::vector<RadianceTile>;

}  // namespace isophote

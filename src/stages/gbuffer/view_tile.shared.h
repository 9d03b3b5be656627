// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// View samples and the light at them, as both engines keep them: tiles of 64, one array a component.
#ifndef ISOPHOTE_STAGES_GBUFFER_VIEW_TILE_SHARED_H
#define ISOPHOTE_STAGES_GBUFFER_VIEW_TILE_SHARED_H

#include "math/shared.h"

#ifdef __cplusplus
#include "math/bounds.h"
#define ISOPHOTE_TILE alignas(64)
#else
// C++'s has defaults and member functions, which GLSL has not; the test of ViewTile's offsets holds them
// together.
struct Bounds {
  vec3 lower;
  vec3 upper;
};
#define ISOPHOTE_TILE
#endif

SHARED_BEGIN

SHARED_CONST int kTileSide = 8;                       ///< Pixels.
SHARED_CONST int kTileLanes = kTileSide * kTileSide;  ///< View samples a tile.
SHARED_CONST uint kNoPixel = 0xffffffffu;
SHARED_CONST float kFarAway = 1e18f;  ///< Position of lanes without a surface, in every coordinate [m].

SHARED_CONST uint kSideOutside = 1u;  ///< The eye sees it from outside.
SHARED_CONST uint kSideThin = 2u;     ///< It is a pane (kMaterialThinWalled).

/// 64 surface points that the eye sees, one array a component so that loops over lanes vectorise.
/// Lanes without a surface have pixel = kNoPixel, position kFarAway (no photon reaches it) and a black
/// diffuse reflectance; their other numbers are any finite ones. Arrays that a tile has no use for are
/// neither written nor read, which saves 40 % of the memory that a frame moves: those of the glossy
/// reflection where `lambertian` is 1, the throughput where `unitThroughput` is, those of what goes through
/// where `transmits` is 0.
struct ISOPHOTE_TILE ViewTile {
  float positionX[kTileLanes], positionY[kTileLanes], positionZ[kTileLanes];  ///< World space [m].
  float ngX[kTileLanes], ngY[kTileLanes], ngZ[kTileLanes];  ///< Geometric normal, unit, on the eye's side.
  float nsX[kTileLanes], nsY[kTileLanes], nsZ[kTileLanes];  ///< Shading normal, unit.
  /// Unit, towards the eye (along the last path segment).
  float woX[kTileLanes], woY[kTileLanes], woZ[kTileLanes];
  float diffuseR[kTileLanes], diffuseG[kTileLanes], diffuseB[kTileLanes];  ///< Bsdf::diffuse
  uint pixel[kTileLanes];                                                  ///< y * width + x
  /// Only where not `lambertian`.
  float f0R[kTileLanes], f0G[kTileLanes], f0B[kTileLanes];
  float f90[kTileLanes];
  float alpha[kTileLanes];
  float coupling0[kTileLanes], coupling90[kTileLanes];
  /// Of the eye path before; only where not `unitThroughput`.
  float throughputR[kTileLanes], throughputG[kTileLanes], throughputB[kTileLanes];
  /// Bsdf::transmission, through and ior; only where `transmits`.
  float transmissionR[kTileLanes], transmissionG[kTileLanes], transmissionB[kTileLanes];
  float through[kTileLanes];
  float ior[kTileLanes];
  uint sides[kTileLanes];  ///< kSide... bits; only where `transmits`.
  Bounds bounds;           ///< Of the positions of its lanes that have a surface.
  uint count;              ///< Lanes that have a surface.
  uint lambertian;         ///< 1: no lane reflects anything but diffusely.
  uint unitThroughput;     ///< 1: every lane's eye path carries its light whole, as primary rays do.
  uint transmits;          ///< 1: any lane refracts by rough facets, so that light from behind it counts.
  uint reserved[6];        ///< To the end of C++'s aligned struct.
};

/// Radiance towards the eye at each lane of a ViewTile, eye-path throughput not multiplied in [W/(m^2 sr)].
struct ISOPHOTE_TILE RadianceTile {
  float r[kTileLanes], g[kTileLanes], b[kTileLanes];
};

SHARED_END

#undef ISOPHOTE_TILE

#endif

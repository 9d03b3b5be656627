// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// From triangles of a scene to triangles of a view, sorted into tiles of pixels.
//
// A vertex is projected to (x, y, w): homogeneous coordinates of its place in the picture, in pixels and so
// that the rays go through whole numbers. Pixel (i, j) is on the inner side of the edge from a to b where the
// determinant of a, b and (i, j, 1) has the sign of the triangle's own determinant (Olano and Greer 1997,
// "Triangle scan conversion using 2D homogeneous coordinates"), whether or not the vertices are in front of
// the eye. That determinant is linear in (i, j): an edge function a i + b j + c.
//
// Edge functions are scaled so that their rounding error is below 1. A pixel is inside where all three are
// above 1 and outside where one is below -1; what lies between is rare and decided exactly (raster_exact.h).
#pragma once

#include "trace/raster.h"

namespace isophote::raster {

inline constexpr int kTileWidth = 64, kTileHeight = 32;
/// Triangles within a box of that many pixels are set up once, larger ones anew in each tile.
inline constexpr int kSmallSide = 16;

/// From world space to the pixels of a view.
struct Projector {
  vec3 eye;
  vec3 toX, toY, toZ;
  float offsetX, offsetY;
  float orthographic;  ///< 1 or 0.
  float nearest;
  int width, height;
  float edgeOfKeys;  ///< A key must be below.
};

Projector projectorOf(const RasterView& view);

struct RasterVertex {
  float x, y, w;
  float z;  ///< Depth; = w for a pinhole.
};

/// Of a point in the world. By coordinates, as loops over lanes want it.
SHARED_FN RasterVertex project(const Projector& p, float x, float y, float z) {
  const float dx = x - p.eye.x, dy = y - p.eye.y, dz = z - p.eye.z;
  const float depth = dx * p.toZ.x + dy * p.toZ.y + dz * p.toZ.z;
  // 1 and 0 for parallel rays, 0 and 1 for a pinhole: exact.
  const float w = p.orthographic + (1.0f - p.orthographic) * depth;
  return {dx * p.toX.x + dy * p.toX.y + dz * p.toX.z + p.offsetX * w,
          dx * p.toY.x + dy * p.toY.y + dz * p.toY.z + p.offsetY * w, w, depth};
}

inline constexpr std::uint32_t kMaskedTriangle = 1;    ///< Its material has an alpha mask.
inline constexpr std::uint32_t kNegativeTriangle = 2;  ///< Its determinant is negative.

/// Edge functions and key relative to some pixel. Keys order by depth, the greatest in front: 1 / depth for a
/// pinhole, - depth for parallel rays; both are linear in the pixel.
struct LocalTriangle {
  float a[3], b[3], c[3];
  float keyA, keyB, keyC;
  float keyMin, keyMax;  ///< Of the vertices.
  std::uint32_t id;
  std::uint32_t flags;
};

/// A triangle that lies within kSmallSide pixels of (x0, y0), to which it is relative.
struct SmallTriangle : LocalTriangle {
  std::uint16_t x0, y0, x1, y1;
};

/// The same in doubles; relative to (x0, y0) as well, which may be far away.
struct LargeTriangle {
  double a[3], b[3], c[3];
  double keyA, keyB, keyC;
  float keyMin, keyMax;
  std::uint32_t id;
  std::uint32_t flags;
  std::uint16_t x0, y0, x1, y1;
};

inline constexpr std::uint32_t kLargeEntry = 0x80000000u;
inline constexpr std::uint32_t kMaskedEntry = 0x40000000u;
inline constexpr std::uint32_t kEntryIndex = 0x3fffffffu;

/// The triangles of some blocks, sorted by tile. Entries are indices into `small`, or, with kLargeEntry, into
/// `large`, and kMaskedEntry where the triangle has an alpha mask; those of tile i lie from tileBegins[i] to
/// tileBegins[i + 1].
struct Chunk {
  struct Placed {
    std::uint32_t tile;
    std::uint32_t entry;
  };
  std::vector<SmallTriangle> small;
  std::vector<LargeTriangle> large;
  std::vector<Placed> placed;
  std::vector<std::uint32_t> entries;
  std::vector<std::uint32_t> tileBegins;
};

/// A block as one instance places it.
struct BlockUse {
  std::uint32_t block;
  std::uint32_t instance;
};

/// Memory of findVisible().
struct VisibleBlocks {
  std::vector<BlockUse> found;
  std::vector<std::uint16_t> bucket;
  std::vector<BlockUse> sorted;  ///< The result: roughly from the front to the back.
};

/// The blocks that may be in view.
void findVisible(const RasterScene& scene, const Projector& projector, SimdLevel level,
                 VisibleBlocks& blocks);

/// Sets up the triangles of some blocks.
void setUp(const RasterScene& scene, const Projector& projector, std::span<const BlockUse> blocks,
           SimdLevel level, Chunk& chunk);

}  // namespace isophote::raster

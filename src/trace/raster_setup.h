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
  float orthographic;
  float nearest;
  int width, height;
  float edgeOfKeys;  ///< A key must be below.
};

Projector projectorOf(const RasterView& view);

struct RasterVertex {
  float x, y, w;
  float z;  ///< Depth; = w for a pinhole.
};

SHARED_FN RasterVertex project(const Projector& p, vec3 world) {
  const vec3 d = world - p.eye;
  const float z = d.x * p.toZ.x + d.y * p.toZ.y + d.z * p.toZ.z;
  const float w = p.orthographic > 0.5f ? 1.0f : z;
  return {d.x * p.toX.x + d.y * p.toX.y + d.z * p.toX.z + p.offsetX * w,
          d.x * p.toY.x + d.y * p.toY.y + d.z * p.toY.z + p.offsetY * w, w, z};
}

inline constexpr std::uint32_t kMaskedTriangle = 1;    ///< Its material has an alpha mask.
inline constexpr std::uint32_t kNegativeTriangle = 2;  ///< Its determinant is negative.

/// Edge functions and key relative to pixel (x0, y0), within kSmallSide pixels of which it lies. Keys order
/// by depth, the greatest in front: 1 / depth for a pinhole, - depth for parallel rays; both are linear in
/// the pixel.
struct SmallTriangle {
  float a[3], b[3], c[3];
  float keyA, keyB, keyC;
  float keyMin, keyMax;  ///< Of the vertices.
  std::uint16_t x0, y0, x1, y1;
  std::uint32_t id;
  std::uint32_t flags;
};

/// The same in doubles; relative to (x0, y0) as well, which may be far away.
struct LargeTriangle {
  double a[3], b[3], c[3];
  double keyA, keyB, keyC;
  float keyMin, keyMax;
  std::uint16_t x0, y0, x1, y1;
  std::uint32_t id;
  std::uint32_t flags;
};

inline constexpr std::uint32_t kLargeEntry = 0x80000000u;

/// The triangles of some blocks, sorted by tile. Entries are indices into `small`, or, with kLargeEntry, into
/// `large`; those of tile i lie from tileBegins[i] to tileBegins[i + 1].
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

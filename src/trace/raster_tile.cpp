// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/raster_tile.h"

#include "trace/alpha_mask.h"
#include "trace/raster_exact.h"
#include "trace/raster_hit.h"

#include <limits>

namespace isophote::raster {

namespace {

constexpr int kLanes = int(kRasterLanes);
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Rows are longer than the tile, so that 16 lanes may begin at any of its pixels.
constexpr int kStride = kTileWidth + kLanes;
/// Pixels of a cell, the unit that hidden triangles are rejected by: there are as many cells as lanes.
constexpr int kCellWidth = 16, kCellHeight = 8;
constexpr int kCellsX = kTileWidth / kCellWidth;
static_assert(kCellsX * (kTileHeight / kCellHeight) == kLanes);
/// After so many small triangles the cells that they went to are looked through again.
constexpr int kSmallBetweenRefreshes = 16;

/// What is seen so far.
struct alignas(64) TilePixels {
  float key[kTileHeight * kStride];
  std::uint32_t id[kTileHeight * kStride];
  float farthest[kLanes];  ///< A lower bound of the keys of each cell.
  std::uint32_t stale;     ///< Cells, as bits, of which `farthest` may be raised.
  int x0, y0, width, height;
};

/// A triangle relative to one pixel of the tile.
struct Local {
  float a[3], b[3], c[3];
  float keyA, keyB, keyC, keyMin, keyMax;
  std::uint32_t id;
  std::uint32_t flags;
};

SHARED_FN float keyAt(const Local& t, float dx, float rowKey) {
  const float key = t.keyA * dx + rowKey;
  const float raised = key > t.keyMin ? key : t.keyMin;
  return raised < t.keyMax ? raised : t.keyMax;
}

template <bool kIds>
SHARED_FN bool wins(float key, std::uint32_t id, float keyThere, std::uint32_t idThere) {
  return kIds ? (key > keyThere) | ((key == keyThere) & (id < idThere)) : key > keyThere;
}

/// Whether the masked triangle is there at a pixel's ray.
bool maskIsThere(const TileTask& task, std::uint32_t id, int x, int y) {
  const std::uint32_t instance = task.scene.instanceOf(id);
  const std::uint32_t index = id - task.scene.instances()[instance].firstTriangle;
  const TraceScene& trace = task.scene.trace();
  const ShadedTriangle triangle = worldTriangle(trace.instance(instance), index);
  const PlaneHit hit = planeHit(triangle.position, rasterRay(task.view, x, y));
  const Scene& scene = trace.scene();
  return texelIsThere(scene, scene.meshes[scene.instances[instance].mesh], index, hit.u, hit.v);
}

void verticesOf(const TileTask& task, std::uint32_t id, RasterVertex* vertices) {
  const std::uint32_t instance = task.scene.instanceOf(id);
  const std::uint32_t index = id - task.scene.instances()[instance].firstTriangle;
  const ShadedTriangle triangle = worldTriangle(task.scene.trace().instance(instance), index);
  for (int k = 0; k < 3; ++k) vertices[k] = project(task.projector, triangle.position[k]);
}

/// Draws a triangle into columns x to x + columns - 1 of some rows of the tile, each pixel decided exactly.
/// (dx, dy): of pixel (x, y) from the one that `t` is relative to. Drawing twice changes nothing.
template <bool kIds>
void drawExactly(const TileTask& task, const Local& t, int x, int y, int columns, int rows, float dx,
                 float dy, TilePixels& pixels) {
  RasterVertex vertices[3];
  verticesOf(task, t.id, vertices);
  const bool negative = (t.flags & kNegativeTriangle) != 0;
  for (int row = y; row < std::min(y + rows, pixels.height); ++row) {
    const float rowKey = t.keyB * (dy + float(row - y)) + t.keyC;
    for (int column = x; column < std::min(x + columns, pixels.width); ++column) {
      const float key = keyAt(t, dx + float(column - x), rowKey);
      const int at = row * kStride + column;
      if (!(key < task.projector.edgeOfKeys) || !wins<kIds>(key, t.id, pixels.key[at], pixels.id[at]))
        continue;
      const int pictureX = pixels.x0 + column, pictureY = pixels.y0 + row;
      if (!covers(vertices, negative, pictureX, pictureY)) continue;
      if ((t.flags & kMaskedTriangle) && !maskIsThere(task, t.id, pictureX, pictureY)) continue;
      pixels.key[at] = key;
      if (kIds) pixels.id[at] = t.id;
    }
  }
}

/// Where the masked triangle is, of 16 pixels that it covers in front of what is there.
template <bool kIds>
void drawMasked(const TileTask& task, const Local& t, const int* seen, const float* keys, int x, int y,
                TilePixels& pixels) {
  for (int i = 0; i < kLanes; ++i) {
    if (!seen[i] || x + i >= pixels.width) continue;
    if (!maskIsThere(task, t.id, pixels.x0 + x + i, pixels.y0 + y)) continue;
    pixels.key[y * kStride + x + i] = keys[i];
    if (kIds) pixels.id[y * kStride + x + i] = t.id;
  }
}

/// Draws 16 columns of some rows. Returns whether rounding leaves any pixel undecided (not drawn then).
/// kEdges: false where the triangle is known to cover all of them.
template <bool kIds, bool kEdges>
SHARED_FN bool drawColumns(const TileTask& task, const Local& t, int x, int y, int rows, float dx, float dy,
                           TilePixels& pixels) {
  float offset[kLanes];
  int undecided[kLanes];
  const float limit = task.projector.edgeOfKeys;
  for (int i = 0; i < kLanes; ++i) {
    offset[i] = dx + float(i);
    undecided[i] = 0;
  }
  for (int row = 0; row < rows; ++row) {
    const float down = dy + float(row);
    const float row0 = t.b[0] * down + t.c[0], row1 = t.b[1] * down + t.c[1], row2 = t.b[2] * down + t.c[2];
    const float rowKey = t.keyB * down + t.keyC;
    float* __restrict key = pixels.key + (y + row) * kStride + x;
    std::uint32_t* __restrict id = pixels.id + (y + row) * kStride + x;
    if (t.flags & kMaskedTriangle) {
      int seen[kLanes];
      float keys[kLanes];
      for (int i = 0; i < kLanes; ++i) {
        const float e0 = t.a[0] * offset[i] + row0, e1 = t.a[1] * offset[i] + row1;
        const float e2 = t.a[2] * offset[i] + row2;
        const float e01 = e0 < e1 ? e0 : e1, e = kEdges ? (e01 < e2 ? e01 : e2) : 2.0f;
        keys[i] = keyAt(t, offset[i], rowKey);
        undecided[i] |= (e >= -1.0f) & (e <= 1.0f) ? 1 : 0;
        seen[i] = (e > 1.0f) & (keys[i] < limit) & wins<kIds>(keys[i], t.id, key[i], id[i]) ? 1 : 0;
      }
      drawMasked<kIds>(task, t, seen, keys, x, y + row, pixels);
      continue;
    }
    for (int i = 0; i < kLanes; ++i) {
      const float e0 = t.a[0] * offset[i] + row0, e1 = t.a[1] * offset[i] + row1;
      const float e2 = t.a[2] * offset[i] + row2;
      const float e01 = e0 < e1 ? e0 : e1, e = kEdges ? (e01 < e2 ? e01 : e2) : 2.0f;
      const float here = keyAt(t, offset[i], rowKey);
      undecided[i] |= (e >= -1.0f) & (e <= 1.0f) ? 1 : 0;
      const bool seen = (e > 1.0f) & (here < limit) & wins<kIds>(here, t.id, key[i], id[i]);
      key[i] = seen ? here : key[i];
      if (kIds) id[i] = seen ? t.id : id[i];
    }
  }
  int any = 0;
  for (int i = 0; i < kLanes; ++i) any |= undecided[i];
  return any != 0;
}

SHARED_FN void refresh(TilePixels& pixels, int cell) {
  const float* keys = pixels.key + (cell / kCellsX) * kCellHeight * kStride + (cell % kCellsX) * kCellWidth;
  float least[kLanes];
  for (int i = 0; i < kLanes; ++i) least[i] = keys[i];
  for (int row = 1; row < kCellHeight; ++row)
    for (int i = 0; i < kLanes; ++i) {
      const float key = keys[row * kStride + i];
      least[i] = key < least[i] ? key : least[i];
    }
  for (int half = kLanes / 2; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) least[i] = least[i + half] < least[i] ? least[i + half] : least[i];
  pixels.farthest[cell] = least[0];
}

template <bool kIds>
SHARED_FN void drawSmall(const TileTask& task, const SmallTriangle& s, TilePixels& pixels) {
  const int left = std::max(int(s.x0) - pixels.x0, 0), top = std::max(int(s.y0) - pixels.y0, 0);
  const int right = std::min(int(s.x1) - pixels.x0, kTileWidth - 1);
  const int bottom = std::min(int(s.y1) - pixels.y0, kTileHeight - 1);
  bool hidden = true;
  std::uint32_t cells = 0;
  for (int row = top / kCellHeight; row <= bottom / kCellHeight; ++row)
    for (int column = left / kCellWidth; column <= right / kCellWidth; ++column) {
      const int cell = row * kCellsX + column;
      hidden = hidden && s.keyMax < pixels.farthest[cell];
      cells |= 1u << cell;
    }
  if (hidden) return;
  pixels.stale |= cells;
  Local t;
  for (int k = 0; k < 3; ++k) {
    t.a[k] = s.a[k];
    t.b[k] = s.b[k];
    t.c[k] = s.c[k];
  }
  t.keyA = s.keyA;
  t.keyB = s.keyB;
  t.keyC = s.keyC;
  t.keyMin = s.keyMin;
  t.keyMax = s.keyMax;
  t.id = s.id;
  t.flags = s.flags;
  const float dx = float(pixels.x0 + left - int(s.x0)), dy = float(pixels.y0 + top - int(s.y0));
  const int rows = bottom - top + 1;
  if (drawColumns<kIds, true>(task, t, left, top, rows, dx, dy, pixels))
    drawExactly<kIds>(task, t, left, top, right - left + 1, rows, dx, dy, pixels);
}

enum CellFate : int { kMissed, kCrossed, kCovered };

SHARED_FN Local localOf(const LargeTriangle& l, int x, int y) {
  const double dx = double(x - int(l.x0)), dy = double(y - int(l.y0));
  Local t;
  for (int k = 0; k < 3; ++k) {
    t.a[k] = float(l.a[k]);
    t.b[k] = float(l.b[k]);
    t.c[k] = float(l.c[k] + l.a[k] * dx + l.b[k] * dy);
  }
  t.keyA = float(l.keyA);
  t.keyB = float(l.keyB);
  t.keyC = float(l.keyC + l.keyA * dx + l.keyB * dy);
  t.keyMin = l.keyMin;
  t.keyMax = l.keyMax;
  t.id = l.id;
  t.flags = l.flags;
  return t;
}

/// What becomes of each cell of the tile.
SHARED_FN void cellFates(const Local& t, const TilePixels& pixels, int* fate) {
  constexpr float kX = kCellWidth - 1, kY = kCellHeight - 1;
  float least[kLanes], greatest[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    least[i] = kInfinity;
    greatest[i] = kInfinity;
  }
  for (int k = 0; k < 3; ++k) {
    const float a = t.a[k], b = t.b[k], c = t.c[k];
    const float up = (a > 0.0f ? a * kX : 0.0f) + (b > 0.0f ? b * kY : 0.0f);
    const float down = (a < 0.0f ? a * kX : 0.0f) + (b < 0.0f ? b * kY : 0.0f);
    for (int i = 0; i < kLanes; ++i) {
      const float x = float(i % kCellsX * kCellWidth), y = float(i / kCellsX * kCellHeight);
      const float e = a * x + b * y + c;
      least[i] = e + down < least[i] ? e + down : least[i];
      greatest[i] = e + up < greatest[i] ? e + up : greatest[i];
    }
  }
  const float up = (t.keyA > 0.0f ? t.keyA * kX : 0.0f) + (t.keyB > 0.0f ? t.keyB * kY : 0.0f) +
                   0x1p-20f * (abs(t.keyA) * kTileWidth + abs(t.keyB) * kTileHeight + abs(t.keyC));
  for (int i = 0; i < kLanes; ++i) {
    const float x = float(i % kCellsX * kCellWidth), y = float(i / kCellsX * kCellHeight);
    const float key = t.keyA * x + t.keyB * y + t.keyC + up;
    const float raised = key > t.keyMin ? key : t.keyMin;
    const float nearest = raised < t.keyMax ? raised : t.keyMax;
    const bool missed = (greatest[i] < -1.0f) | (nearest < pixels.farthest[i]);
    fate[i] = missed ? kMissed : least[i] > 1.0f ? kCovered : kCrossed;
  }
}

template <bool kIds>
SHARED_FN void drawLarge(const TileTask& task, const LargeTriangle& l, TilePixels& pixels) {
  const Local t = localOf(l, pixels.x0, pixels.y0);
  int fate[kLanes];
  cellFates(t, pixels, fate);
  for (int cell = 0; cell < kLanes; ++cell) {
    if (fate[cell] == kMissed) continue;
    const int x = cell % kCellsX * kCellWidth, y = cell / kCellsX * kCellHeight;
    if (fate[cell] == kCovered)
      drawColumns<kIds, false>(task, t, x, y, kCellHeight, float(x), float(y), pixels);
    else if (drawColumns<kIds, true>(task, t, x, y, kCellHeight, float(x), float(y), pixels))
      drawExactly<kIds>(task, t, x, y, kCellWidth, kCellHeight, float(x), float(y), pixels);
    refresh(pixels, cell);
  }
}

SHARED_FN void clear(const TileTask& task, TilePixels& pixels) {
  const int tilesX = (task.view.width + kTileWidth - 1) / kTileWidth;
  pixels.x0 = int(task.tile) % tilesX * kTileWidth;
  pixels.y0 = int(task.tile) / tilesX * kTileHeight;
  pixels.width = std::min(kTileWidth, task.view.width - pixels.x0);
  pixels.height = std::min(kTileHeight, task.view.height - pixels.y0);
  pixels.stale = 0;
  // Nothing is in front of pixels outside the picture, so that they hide cells as those in it do.
  for (int row = 0; row < kTileHeight; ++row)
    for (int i = 0; i < kStride; ++i) {
      pixels.key[row * kStride + i] = (row < pixels.height) & (i < pixels.width) ? -kInfinity : kInfinity;
      pixels.id[row * kStride + i] = kNoTriangle;
    }
  for (int cell = 0; cell < kLanes; ++cell) refresh(pixels, cell);
}

template <bool kIds>
SHARED_FN void store(const TileTask& task, const TilePixels& pixels) {
  const bool parallel = task.projector.orthographic > 0.5f;
  for (int row = 0; row < pixels.height; ++row) {
    const std::size_t to =
        std::size_t(pixels.y0 + row) * std::size_t(task.view.width) + std::size_t(pixels.x0);
    const float* keys = pixels.key + row * kStride;
    if (kIds) std::copy_n(pixels.id + row * kStride, pixels.width, task.triangles + to);
    if (!task.depths) continue;
    float* depths = task.depths + to;
    for (int i = 0; i < pixels.width; ++i) {
      const float depth = parallel ? -keys[i] : 1.0f / keys[i];
      depths[i] = keys[i] > -kInfinity ? depth : kNoDepth;
    }
  }
}

template <bool kIds>
SHARED_FN void rasteriseTile(const TileTask& task) {
  TilePixels pixels;
  clear(task, pixels);
  int drawn = 0;
  for (const Chunk& chunk : task.chunks) {
    const std::uint32_t end = chunk.tileBegins[task.tile + 1];
    for (std::uint32_t e = chunk.tileBegins[task.tile]; e < end; ++e) {
      const std::uint32_t entry = chunk.entries[e];
      if (entry & kLargeEntry) {
        drawLarge<kIds>(task, chunk.large[entry & ~kLargeEntry], pixels);
        continue;
      }
      drawSmall<kIds>(task, chunk.small[entry], pixels);
      if (++drawn % kSmallBetweenRefreshes != 0) continue;
      for (int cell = 0; cell < kLanes; ++cell)
        if (pixels.stale & (1u << cell)) refresh(pixels, cell);
      pixels.stale = 0;
    }
  }
  store<kIds>(task, pixels);
}

SHARED_FN void withIdsBody(const TileTask& task) { rasteriseTile<true>(task); }
SHARED_FN void depthsOnlyBody(const TileTask& task) { rasteriseTile<false>(task); }
ISOPHOTE_SIMD(withIds, withIdsBody, (const TileTask& task), (task))
ISOPHOTE_SIMD(depthsOnly, depthsOnlyBody, (const TileTask& task), (task))

}  // namespace

RasteriseTileFn rasteriseTileFor(bool withIds, SimdLevel level) {
  return withIds ? withIdsFor(level) : depthsOnlyFor(level);
}

}  // namespace isophote::raster

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/raster_tile.h"

#include "trace/raster_exact.h"
#include "trace/raster_mask.h"

#include <algorithm>
#include <limits>
#include <optional>

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
constexpr float kCellLeft[kLanes] = {0, 16, 32, 48, 0, 16, 32, 48, 0, 16, 32, 48, 0, 16, 32, 48};
constexpr float kCellTop[kLanes] = {0, 0, 0, 0, 8, 8, 8, 8, 16, 16, 16, 16, 24, 24, 24, 24};
/// Rows are drawn in groups, the last of which may go beyond the triangle and the tile.
constexpr int kGroup = 4;
constexpr int kRows = kTileHeight + kGroup - 1;
/// After so many small triangles the cells that they went to are looked through again.
constexpr int kSmallBetweenRefreshes = 16;

/// What is seen so far.
struct alignas(64) TilePixels {
  float key[kRows * kStride];
  std::uint32_t id[kRows * kStride];
  float farthest[kLanes];  ///< A lower bound of the keys of each cell.
  std::uint32_t stale;     ///< Cells, as bits, of which `farthest` may be raised.
  int x0, y0, width, height;
};

SHARED_FN float keyAt(const LocalTriangle& t, float dx, float rowKey) {
  const float key = t.keyA * dx + rowKey;
  const float raised = key > t.keyMin ? key : t.keyMin;
  return raised < t.keyMax ? raised : t.keyMax;
}

template <bool kIds>
SHARED_FN bool wins(float key, std::uint32_t id, float keyThere, std::uint32_t idThere) {
  return kIds ? (key > keyThere) | ((key == keyThere) & (id < idThere)) : key > keyThere;
}

/// Draws a triangle into columns x to x + columns - 1 of some rows of the tile, each pixel decided exactly.
/// (dx, dy): of pixel (x, y) from the one that `t` is relative to. Drawing twice changes nothing.
template <bool kIds>
void drawExactly(const TileTask& task, const LocalTriangle& t, int x, int y, int columns, int rows, float dx,
                 float dy, TilePixels& pixels) {
  const SceneTriangle triangle(task.scene, t.id);
  RasterVertex vertices[3];
  triangle.project(task.projector, vertices);
  std::optional<MaskedTriangle> masked;
  if (t.flags & kMaskedTriangle) masked.emplace(task.scene, task.projector, t, pixels.x0, pixels.y0);
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
      if (masked && !masked->isThere(column, row)) continue;
      pixels.key[at] = key;
      if (kIds) pixels.id[at] = t.id;
    }
  }
}

/// Draws a triangle with an alpha mask where drawColumns() draws others. Returns the same.
template <bool kIds>
SHARED_FN bool drawMaskedColumns(const TileTask& task, const LocalTriangle& t, int x, int y, int rows,
                                 float dx, float dy, TilePixels& pixels) {
  const float limit = task.projector.edgeOfKeys;
  int undecided = 0;
  std::optional<MaskedTriangle> triangle;
  for (int row = 0; row < rows; ++row) {
    const float down = dy + float(row);
    const float row0 = t.b[0] * down + t.c[0], row1 = t.b[1] * down + t.c[1], row2 = t.b[2] * down + t.c[2];
    const float rowKey = t.keyB * down + t.keyC;
    const int first = (y + row) * kStride + x;
    int seen[kLanes];
    float keys[kLanes];
    int any = 0;
    for (int i = 0; i < kLanes; ++i) {
      const float right = dx + float(i);
      const float e0 = t.a[0] * right + row0, e1 = t.a[1] * right + row1, e2 = t.a[2] * right + row2;
      const float e01 = e0 < e1 ? e0 : e1, e = e01 < e2 ? e01 : e2;
      keys[i] = keyAt(t, right, rowKey);
      undecided |= ((e >= -1.0f) & (e <= 1.0f)) ? 1 : 0;
      seen[i] = ((e > 1.0f) & (keys[i] < limit) &
                 wins<kIds>(keys[i], t.id, pixels.key[first + i], pixels.id[first + i]))
                    ? 1
                    : 0;
      any |= seen[i];
    }
    if (!any) continue;
    if (!triangle) triangle.emplace(task.scene, task.projector, t, pixels.x0, pixels.y0);
    for (int i = 0; i < kLanes; ++i) {
      if (!seen[i] || !triangle->isThere(x + i, y + row)) continue;
      pixels.key[first + i] = keys[i];
      if (kIds) pixels.id[first + i] = t.id;
    }
  }
  return undecided != 0;
}

/// By halves, as the compiler's own sum over lanes takes them out one by one.
SHARED_FN bool anyOf(const int* lanes) {
  int eight[8], four[4];
  for (int i = 0; i < 8; ++i) eight[i] = lanes[i] | lanes[i + 8];
  for (int i = 0; i < 4; ++i) four[i] = eight[i] | eight[i + 4];
  return (four[0] | four[1] | four[2] | four[3]) != 0;
}

/// Draws 16 columns of some rows. Returns whether rounding leaves any pixel undecided (not drawn then).
/// kEdges: false where the triangle is known to cover all of them.
template <bool kIds, bool kEdges>
SHARED_FN bool drawColumns(const TileTask& task, const LocalTriangle& t, int x, int y, int rows, float dx,
                           float dy, TilePixels& pixels) {
  const float limit = task.projector.edgeOfKeys;
  // Copies, which what is drawn cannot change.
  const LocalTriangle own = t;
  int undecided[kLanes] = {};
  for (int group = 0; group < rows; group += kGroup) {
    float row0[kGroup], row1[kGroup], row2[kGroup], rowKey[kGroup];
    for (int r = 0; r < kGroup; ++r) {
      const float down = dy + float(group + r);
      row0[r] = own.b[0] * down + own.c[0];
      row1[r] = own.b[1] * down + own.c[1];
      row2[r] = own.b[2] * down + own.c[2];
      rowKey[r] = own.keyB * down + own.keyC;
    }
    float* __restrict key = pixels.key + (y + group) * kStride + x;
    std::uint32_t* __restrict id = pixels.id + (y + group) * kStride + x;
    for (int i = 0; i < kLanes; ++i) {
      const float right = dx + float(i);
      const float e0 = own.a[0] * right, e1 = own.a[1] * right, e2 = own.a[2] * right;
      // Whether row r of the group leaves the pixel undecided. Rows that do not wait for one another.
      const auto drawRow = [&](int r) __attribute__((always_inline)) {
        const float f0 = e0 + row0[r], f1 = e1 + row1[r], f2 = e2 + row2[r];
        const float f01 = f0 < f1 ? f0 : f1, f = kEdges ? (f01 < f2 ? f01 : f2) : 2.0f;
        const float here = keyAt(own, right, rowKey[r]);
        const int at = r * kStride + i;
        const bool seen = (f > 1.0f) & (here < limit) & wins<kIds>(here, own.id, key[at], id[at]);
        key[at] = seen ? here : key[at];
        if (kIds) id[at] = seen ? own.id : id[at];
        return ((f >= -1.0f) & (f <= 1.0f)) ? 1 : 0;
      };
      undecided[i] |= drawRow(0) | drawRow(1) | drawRow(2) | drawRow(3);
    }
  }
  return anyOf(undecided);
}

SHARED_FN float lesser(float a, float b) { return a < b ? a : b; }

SHARED_FN void refresh(TilePixels& pixels, int cell) {
  const float* keys = pixels.key + (cell / kCellsX) * kCellHeight * kStride + (cell % kCellsX) * kCellWidth;
  static_assert(kCellHeight == 8);
  float least[kLanes], least8[8], least4[4];
  for (int i = 0; i < kLanes; ++i) {
    const auto row = [&](int r) __attribute__((always_inline)) { return keys[r * kStride + i]; };
    least[i] = lesser(lesser(lesser(row(0), row(1)), lesser(row(2), row(3))),
                      lesser(lesser(row(4), row(5)), lesser(row(6), row(7))));
  }
  for (int i = 0; i < 8; ++i) least8[i] = lesser(least[i], least[i + 8]);
  for (int i = 0; i < 4; ++i) least4[i] = lesser(least8[i], least8[i + 4]);
  pixels.farthest[cell] = lesser(lesser(least4[0], least4[1]), lesser(least4[2], least4[3]));
}

/// The part of a triangle's box that lies in the tile, in the tile's pixels.
struct Box {
  int left, top, right, bottom;
};
template <class Triangle>
SHARED_FN Box boxInTile(const Triangle& t, const TilePixels& pixels) {
  return {std::max(int(t.x0) - pixels.x0, 0), std::max(int(t.y0) - pixels.y0, 0),
          std::min(int(t.x1) - pixels.x0, kTileWidth - 1), std::min(int(t.y1) - pixels.y0, kTileHeight - 1)};
}

template <bool kIds>
SHARED_FN void drawSmall(const TileTask& task, const SmallTriangle& t, TilePixels& pixels) {
  const Box box = boxInTile(t, pixels);
  bool hidden = true;
  std::uint32_t cells = 0;
  for (int row = box.top / kCellHeight; row <= box.bottom / kCellHeight; ++row)
    for (int column = box.left / kCellWidth; column <= box.right / kCellWidth; ++column) {
      const int cell = row * kCellsX + column;
      hidden = hidden && t.keyMax < pixels.farthest[cell];
      cells |= 1u << cell;
    }
  if (hidden) return;
  pixels.stale |= cells;
  const float dx = float(pixels.x0 + box.left - int(t.x0)), dy = float(pixels.y0 + box.top - int(t.y0));
  const int rows = box.bottom - box.top + 1;
  const bool undecided = t.flags & kMaskedTriangle
                             ? drawMaskedColumns<kIds>(task, t, box.left, box.top, rows, dx, dy, pixels)
                             : drawColumns<kIds, true>(task, t, box.left, box.top, rows, dx, dy, pixels);
  if (undecided)
    drawExactly<kIds>(task, t, box.left, box.top, box.right - box.left + 1, rows, dx, dy, pixels);
}

SHARED_FN LocalTriangle localOf(const LargeTriangle& l, int x, int y) {
  const double dx = double(x - int(l.x0)), dy = double(y - int(l.y0));
  LocalTriangle t;
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

enum CellFate : int { kMissed, kCrossed, kCovered };

/// A linear function of the pixel, at its greatest and least in a cell relative to the cell's first pixel.
struct Spread {
  float up, down;
};
SHARED_FN Spread spreadOf(float a, float b) {
  const float x = a * float(kCellWidth - 1), y = b * float(kCellHeight - 1);
  return {(x > 0.0f ? x : 0.0f) + (y > 0.0f ? y : 0.0f), (x < 0.0f ? x : 0.0f) + (y < 0.0f ? y : 0.0f)};
}

/// What becomes of each cell of the tile.
SHARED_FN void cellFates(const LocalTriangle& t, const TilePixels& pixels, int* __restrict fate) {
  const Spread s0 = spreadOf(t.a[0], t.b[0]), s1 = spreadOf(t.a[1], t.b[1]), s2 = spreadOf(t.a[2], t.b[2]);
  const float keyUp = spreadOf(t.keyA, t.keyB).up +
                      0x1p-20f * (abs(t.keyA) * kTileWidth + abs(t.keyB) * kTileHeight + abs(t.keyC));
  const float* farthest = pixels.farthest;
  for (int i = 0; i < kLanes; ++i) {
    const float x = kCellLeft[i], y = kCellTop[i];
    const float e0 = t.a[0] * x + t.b[0] * y + t.c[0];
    const float e1 = t.a[1] * x + t.b[1] * y + t.c[1];
    const float e2 = t.a[2] * x + t.b[2] * y + t.c[2];
    const float greatest = lesser(lesser(e0 + s0.up, e1 + s1.up), e2 + s2.up);
    const float least = lesser(lesser(e0 + s0.down, e1 + s1.down), e2 + s2.down);
    const float key = t.keyA * x + t.keyB * y + t.keyC + keyUp;
    const float raised = key > t.keyMin ? key : t.keyMin;
    const float nearest = raised < t.keyMax ? raised : t.keyMax;
    const int met = ((greatest >= -1.0f) & (nearest >= farthest[i])) ? 1 : 0;
    const int covered = least > 1.0f ? 1 : 0;
    fate[i] = met * (kCrossed + covered * (kCovered - kCrossed));
  }
}

template <bool kIds>
SHARED_FN void drawLarge(const TileTask& task, const LargeTriangle& l, TilePixels& pixels) {
  const LocalTriangle t = localOf(l, pixels.x0, pixels.y0);
  const Box box = boxInTile(l, pixels);
  int fate[kLanes];
  cellFates(t, pixels, fate);
  for (int cellY = box.top / kCellHeight; cellY <= box.bottom / kCellHeight; ++cellY)
    for (int cellX = box.left / kCellWidth; cellX <= box.right / kCellWidth; ++cellX) {
      const int cell = cellY * kCellsX + cellX;
      if (fate[cell] == kMissed) continue;
      const int x = cellX * kCellWidth;
      const int y = std::max(cellY * kCellHeight, box.top / kGroup * kGroup);
      const int rows = std::min(cellY * kCellHeight + kCellHeight, box.bottom + 1) - y;
      bool undecided = false;
      if (t.flags & kMaskedTriangle)
        undecided = drawMaskedColumns<kIds>(task, t, x, y, rows, float(x), float(y), pixels);
      else if (fate[cell] == kCovered)
        drawColumns<kIds, false>(task, t, x, y, rows, float(x), float(y), pixels);
      else
        undecided = drawColumns<kIds, true>(task, t, x, y, rows, float(x), float(y), pixels);
      if (undecided) drawExactly<kIds>(task, t, x, y, kCellWidth, rows, float(x), float(y), pixels);
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
  std::fill_n(pixels.key, kRows * kStride, kInfinity);
  std::fill_n(pixels.id, kRows * kStride, kNoTriangle);
  for (int row = 0; row < pixels.height; ++row)
    std::fill_n(pixels.key + row * kStride, pixels.width, -kInfinity);
  for (int cell = 0; cell < kLanes; ++cell) refresh(pixels, cell);
}

template <bool kIds>
SHARED_FN void store(const TileTask& task, const TilePixels& pixels) {
  const bool parallel = task.projector.orthographic > 0.5f;
  for (int row = 0; row < pixels.height; ++row) {
    const std::size_t to =
        std::size_t(pixels.y0 + row) * std::size_t(task.view.width) + std::size_t(pixels.x0);
    const float* __restrict keys = pixels.key + row * kStride;
    if (kIds) std::copy_n(pixels.id + row * kStride, pixels.width, task.triangles + to);
    if (!task.depths) continue;
    float* __restrict depths = task.depths + to;
    for (int i = 0; i < pixels.width; ++i) {
      const float inverse = 1.0f / keys[i];
      const float depth = parallel ? -keys[i] : inverse;
      depths[i] = keys[i] > -kInfinity ? depth : kNoDepth;
    }
  }
}

/// Triangles are fetched that many ahead of their turn.
constexpr std::uint32_t kAhead = 4;

SHARED_FN void wantEntry(const Chunk& chunk, std::uint32_t entry) {
  const std::uint32_t index = entry & kEntryIndex;
  const char* first = entry & kLargeEntry ? reinterpret_cast<const char*>(chunk.large.data() + index)
                                          : reinterpret_cast<const char*>(chunk.small.data() + index);
  __builtin_prefetch(first);
  __builtin_prefetch(first + 64);
}

/// Draws what is in the tile: triangles with an alpha mask or, masked = 0, without. Returns whether there are
/// others.
template <bool kIds>
SHARED_FN bool drawEntries(const TileTask& task, std::uint32_t masked, TilePixels& pixels) {
  int drawn = 0;
  bool others = false;
  for (const Chunk& chunk : task.chunks) {
    const std::uint32_t begin = chunk.tileBegins[task.tile], end = chunk.tileBegins[task.tile + 1];
    for (std::uint32_t e = begin; e < end; ++e) {
      const std::uint32_t entry = chunk.entries[e];
      if (e + kAhead < end) wantEntry(chunk, chunk.entries[e + kAhead]);
      if ((entry & kMaskedEntry) != masked) {
        others = true;
        continue;
      }
      if (entry & kLargeEntry) {
        drawLarge<kIds>(task, chunk.large[entry & kEntryIndex], pixels);
        continue;
      }
      drawSmall<kIds>(task, chunk.small[entry & kEntryIndex], pixels);
      if (++drawn % kSmallBetweenRefreshes != 0) continue;
      for (int cell = 0; cell < kLanes; ++cell)
        if (pixels.stale & (1u << cell)) refresh(pixels, cell);
      pixels.stale = 0;
    }
  }
  return others;
}

template <bool kIds>
SHARED_FN void rasteriseTile(const TileTask& task) {
  TilePixels pixels;
  clear(task, pixels);
  // Masks cost by far the most and are not looked at where something else hides them.
  if (drawEntries<kIds>(task, 0, pixels)) drawEntries<kIds>(task, kMaskedEntry, pixels);
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

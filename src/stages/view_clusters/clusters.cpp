// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/view_clusters/clusters.h"

#include "math/lanes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace isophote::view_clusters {
namespace {

constexpr std::uint32_t kTilesPerChunk = 256;
constexpr int kCellBits = 16;  ///< Of each coordinate in a key.
constexpr std::uint64_t kSecondaryKey = std::uint64_t(1) << (3 * kCellBits);  ///< Secondary tiles follow.
constexpr int kFaceShift = 3 * kCellBits + 1;  ///< Each face of a cube has a tree of its own.
constexpr std::int32_t kNoCell = -1;
constexpr int kGroup = photon_estimate::kGroupLanes;

/// How depth becomes the third coordinate of a cell.
struct DepthCells {
  vec3 eye, forward;
  float nearest = 1;  ///< Depth of the first cell's front [m].
  float scale = 1;
  bool parallel = false;
};

/// The bits of a float, read as a number, grow with its logarithm in straight pieces, one an octave: cells of
/// about the same shape at every depth without computing a logarithm.
SHARED_FN std::int32_t depthCell(const DepthCells& cells, vec3 position) {
  constexpr float kPerOctave = 1.0f / 8388608.0f;
  const float depth = dot(position - cells.eye, cells.forward);
  const float ratio = max(depth / cells.nearest, 1.0f);
  const float octaves = float(std::bit_cast<std::int32_t>(ratio) - 0x3f800000) * kPerOctave;
  const float at = cells.parallel ? depth - cells.nearest : octaves;
  return std::int32_t(clamp(at * cells.scale, 0.0f, 4095.0f));
}

/// How pixels become the first two coordinates of a cell.
struct Cell {
  int width, height;  ///< Pixels.
  int blockWidth() const { return std::min(width, kTileSide); }
  int blockHeight() const { return std::min(height, kTileSide); }
};

Cell cellOf(ClusterSize size) {
  switch (size) {
    case ClusterSize::k4x4:
      return {4, 4};
    case ClusterSize::k8x4:
      return {8, 4};
    case ClusterSize::k8x8:
      return {8, 8};
    case ClusterSize::k16x8:
      return {16, 8};
    case ClusterSize::k16x16:
      return {16, 16};
    case ClusterSize::k32x16:
      return {32, 16};
    case ClusterSize::k32x32:
      break;
  }
  return {32, 32};
}

constexpr std::int32_t kMostBlocks = 4;  ///< Cells side by side in a tile.
constexpr std::int32_t kMostFaces = 8;
constexpr std::int32_t kMostParts = kMostBlocks * kMostFaces;  ///< Of cells of one depth in a tile.

/// Through which of the faces of a cube around it a normal points.
SHARED_FN std::int32_t faceOf(vec3 n) {
  const vec3 a = abs(n);
  const float side = a.x >= a.y ? n.x : n.y;
  const std::int32_t axis = a.x >= a.y ? 0 : 2;
  const bool isZ = a.z > max(a.x, a.y);
  return (isZ ? 4 : axis) + ((isZ ? n.z : side) < 0.0f ? 1 : 0);
}

/// Which of a tile's blocks, each of one cell, a lane is in.
using BlockOfLane = std::array<std::int32_t, kTileLanes>;

BlockOfLane blocksOfPrimary(Cell cell) {
  BlockOfLane block;
  for (int lane = 0; lane < kTileLanes; ++lane)
    block[std::size_t(lane)] = lane / kTileSide / cell.blockHeight() * (kTileSide / cell.blockWidth()) +
                               lane % kTileSide / cell.blockWidth();
  return block;
}
/// Secondary samples lie in an order that keeps neighbours together.
BlockOfLane blocksOfSecondary(Cell cell) {
  BlockOfLane block;
  for (int lane = 0; lane < kTileLanes; ++lane)
    block[std::size_t(lane)] = lane / (cell.blockWidth() * cell.blockHeight());
  return block;
}

/// kMostParts times the depth of the cell of each lane, and kMostFaces times the block, and the face; kNoCell
/// where it has no surface.
SHARED_FN void cellsBody(const ViewTile& tile, const DepthCells& cells, const std::int32_t* block,
                         std::int32_t byFace, std::int32_t* cell) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const std::int32_t at = depthCell(cells, positionOf(tile, lane)) * kMostParts + block[lane] * kMostFaces +
                            (faceOf(ngOf(tile, lane)) & byFace);
    cell[lane] = tile.pixel[lane] != kNoPixel ? at : kNoCell;
  }
}

/// What is known of the lanes whose cell is `wanted`.
struct Measured {
  std::uint64_t lanes;
  Bounds bounds;
  vec3 axis;
  float leastCosine;
  float normalsApart2;  ///< Largest squared distance of shading and geometric normal.
};

SHARED_FN void measureBody(const ViewTile& tile, const std::int32_t* cell, std::int32_t wanted,
                           Measured& out) {
  out.lanes = bitsWhere([&](int lane) __attribute__((always_inline)) { return cell[lane] == wanted; });
  constexpr float kNone = 1e30f;
  vec3 lower[kGroup], upper[kGroup], sum[kGroup];
  float apart[kGroup], least[kGroup];
  for (int i = 0; i < kGroup; ++i) {
    lower[i] = vec3(kNone);
    upper[i] = vec3(-kNone);
    sum[i] = vec3(0.0f);
    apart[i] = 0.0f;
    least[i] = 1.0f;
  }
  const auto has = [&](int first) { return (out.lanes >> first & ((1u << kGroup) - 1u)) != 0; };
  for (int first = 0; first < kTileLanes; first += kGroup) {
    if (!has(first)) continue;
    for (int i = 0; i < kGroup; ++i) {
      const int lane = first + i;
      const bool in = cell[lane] == wanted;
      const vec3 p = positionOf(tile, lane), n = ngOf(tile, lane), d = nsOf(tile, lane) - n;
      lower[i] = min(lower[i], in ? p : vec3(kNone));
      upper[i] = max(upper[i], in ? p : vec3(-kNone));
      sum[i] += in ? n : vec3(0.0f);
      apart[i] = max(apart[i], in ? dot(d, d) : 0.0f);
    }
  }
  out.bounds = {lower[0], upper[0]};
  out.axis = sum[0];
  for (int i = 1; i < kGroup; ++i) {
    out.bounds.lower = min(out.bounds.lower, lower[i]);
    out.bounds.upper = max(out.bounds.upper, upper[i]);
    out.axis += sum[i];
    apart[0] = max(apart[0], apart[i]);
  }
  out.normalsApart2 = apart[0];
  out.axis = out.axis * inversesqrt(max(dot(out.axis, out.axis), 1e-20f));
  for (int first = 0; first < kTileLanes; first += kGroup) {
    if (!has(first)) continue;
    for (int i = 0; i < kGroup; ++i)
      least[i] = min(least[i], cell[first + i] == wanted ? dot(out.axis, ngOf(tile, first + i)) : 1.0f);
  }
  out.leastCosine = *std::min_element(least, least + kGroup);
}

ISOPHOTE_SIMD(cells, cellsBody,
              (const ViewTile& tile, const DepthCells& cells, const std::int32_t* block, std::int32_t byFace,
               std::int32_t* cell),
              (tile, cells, block, byFace, cell))
ISOPHOTE_SIMD(measure, measureBody,
              (const ViewTile& tile, const std::int32_t* cell, std::int32_t wanted, Measured& out),
              (tile, cell, wanted, out))

/// Bit i of v becomes bit 3 i.
std::uint64_t spreadBits(std::uint64_t v) {
  v = (v | v << 16) & 0x0000ff0000ffull;
  v = (v | v << 8) & 0x00f00f00f00full;
  v = (v | v << 4) & 0x0c30c30c30c3ull;
  return (v | v << 2) & 0x249249249249ull;
}

struct Depths {
  float nearest = 1e30f, farthest = 1e-6f;
};

/// Bounds of the primary samples' depths.
Depths depthsOf(const ViewSamples& view) {
  const vec3 along = view.camera.forward, absolute = abs(along);
  const auto include = [&](const tbb::blocked_range<std::size_t>& range, Depths all) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (view.tiles[i].count == 0) continue;
      // The corners of the tiles' bounds enclose the depths of their samples.
      const Bounds& bounds = view.tiles[i].bounds;
      const float depth = dot(bounds.centre() - view.camera.eye, along);
      const float half = 0.5f * dot(bounds.size(), absolute);
      all.nearest = std::min(all.nearest, depth - half);
      all.farthest = std::max(all.farthest, depth + half);
    }
    return all;
  };
  const auto join = [](Depths a, Depths b) {
    return Depths{std::min(a.nearest, b.nearest), std::max(a.farthest, b.farthest)};
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, view.primaryTiles), Depths{}, include, join);
}

DepthCells depthCells(const ViewSamples& view, Cell cell, float cellDepth) {
  DepthCells cells;
  cells.eye = view.camera.eye;
  cells.forward = view.camera.forward;
  cells.parallel = view.camera.orthographic > 0.5f;
  const auto [nearest, farthest] = depthsOf(view);
  cells.nearest = cells.parallel ? nearest : std::clamp(nearest, 1e-3f * farthest, farthest);
  // The width of a cell, at distance 1 where rays diverge.
  const float width = 2.0f * length(view.camera.up) * float(cell.width) / float(std::max(view.height, 1));
  const float depth = std::max(width * cellDepth, 1e-9f);
  const float range = cells.parallel ? farthest - cells.nearest : std::log2(farthest / cells.nearest) + 1.0f;
  constexpr float kMostCells = 4000;
  cells.scale = std::min(cells.parallel ? 1.0f / depth : 1.0f / std::log2(1.0f + depth),
                         kMostCells / std::max(range, 1e-6f));
  return cells;
}

std::uint64_t primaryKey(const ViewSamples& view, std::size_t tile, Cell cell, int block, int depth) {
  const int across = kTileSide / cell.blockWidth();
  const int x = int(tile % std::size_t(view.tilesX)) * kTileSide + block % across * cell.blockWidth();
  const int y = int(tile / std::size_t(view.tilesX)) * kTileSide + block / across * cell.blockHeight();
  return spreadBits(std::uint64_t(x / cell.width)) | spreadBits(std::uint64_t(y / cell.height)) << 1 |
         spreadBits(std::uint64_t(depth)) << 2;
}

std::uint64_t secondaryKey(std::size_t tile, Cell cell, int block) {
  const std::size_t samples = std::size_t(cell.width * cell.height);
  const std::size_t inBlock = std::size_t(cell.blockWidth() * cell.blockHeight());
  return kSecondaryKey + (tile * kTileLanes + std::size_t(block) * inBlock) / samples;
}

/// Adds the patches of one tile.
void findPatches(const ViewSamples& view, std::size_t index, Cell size, const DepthCells& depths,
                 const BlockOfLane& blocks, bool byFace, SimdLevel simd, std::vector<Patch>& found) {
  const ViewTile& tile = view.tiles[index];
  const bool primary = index < view.primaryTiles;
  std::array<std::int32_t, kTileLanes> cell;
  cellsFor(simd)(tile, depths, blocks.data(), byFace ? -1 : 0, cell.data());
  if (!primary)
    for (std::int32_t& c : cell) c = c == kNoCell ? kNoCell : c % kMostParts;
  std::uint64_t left = bitsWhere([&](int lane) { return cell[std::size_t(lane)] != kNoCell; });
  while (left != 0) {
    const std::int32_t wanted = cell[std::size_t(std::countr_zero(left))];
    Measured m;
    measureFor(simd)(tile, cell.data(), wanted, m);
    left &= ~m.lanes;
    const int block = wanted / kMostFaces % kMostBlocks;
    Patch& patch = found.emplace_back();
    patch.key = primary ? primaryKey(view, index, size, block, wanted / kMostParts)
                        : secondaryKey(index - view.primaryTiles, size, block);
    patch.key |= std::uint64_t(wanted % kMostFaces) << kFaceShift;
    patch.lanes = m.lanes;
    patch.tile = std::uint32_t(index);
    patch.kind = {tile.lambertian != 0, tile.transmits != 0, photon_estimate::isFlat(m.normalsApart2)};
    patch.bounds = m.bounds;
    patch.cone = {m.axis, std::acos(clamp(m.leastCosine, -1.0f, 1.0f))};
  }
}

}  // namespace

void Clusters::build(const ViewSamples& view, ClusterSize size, float cellDepth, SimdLevel simd,
                     bool byFace) {
  const Cell cell = cellOf(size);
  const DepthCells depths = depthCells(view, cell, cellDepth);
  const BlockOfLane primary = blocksOfPrimary(cell), secondary = blocksOfSecondary(cell);
  const std::size_t chunks = (view.tiles.size() + kTilesPerChunk - 1) / kTilesPerChunk;
  chunks_.resize(chunks);
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    chunks_[chunk].clear();
    const std::size_t end = std::min(view.tiles.size(), (chunk + 1) * kTilesPerChunk);
    for (std::size_t t = chunk * kTilesPerChunk; t < end; ++t)
      if (view.tiles[t].count > 0)
        findPatches(view, t, cell, depths, t < view.primaryTiles ? primary : secondary, byFace, simd,
                    chunks_[chunk]);
  });
  sortPatches();
  clusters_.clear();
  for (std::uint32_t i = 0; i < patches_.size(); ++i) {
    if (clusters_.empty() || clusters_.back().key != patches_[i].key)
      clusters_.push_back({patches_[i].key, i, 0});
    ++clusters_.back().patches;
  }
}

void Clusters::sortPatches() {
  chunkBegin_.assign(1, 0);
  for (const std::vector<Patch>& chunk : chunks_) chunkBegin_.push_back(chunkBegin_.back() + chunk.size());
  order_.resize(chunkBegin_.back());
  tbb::parallel_for(std::size_t(0), chunks_.size(), [&](std::size_t chunk) {
    for (std::size_t i = 0; i < chunks_[chunk].size(); ++i)
      order_[chunkBegin_[chunk] + i] = {chunks_[chunk][i].key, std::uint32_t(chunk), std::uint32_t(i)};
  });
  tbb::parallel_sort(order_.begin(), order_.end());
  patches_.resize(order_.size());
  tbb::parallel_for(std::size_t(0), order_.size(),
                    [&](std::size_t i) { patches_[i] = chunks_[order_[i].chunk][order_[i].place]; });
}

}  // namespace isophote::view_clusters

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/clusters.h"

#include "math/lanes.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace isophote::photon_clusters {
namespace {

constexpr std::uint32_t kTilesPerChunk = 256;
constexpr int kCellBits = 12;  ///< Of each coordinate in a key.
constexpr std::uint64_t kSecondaryKey = std::uint64_t(1) << (3 * kCellBits);  ///< Secondary tiles follow.
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

/// The cell of each lane, kNoCell where it has no surface.
SHARED_FN void cellsBody(const ViewTile& tile, const DepthCells& cells, std::int32_t* cell) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const std::int32_t at = depthCell(cells, positionOf(tile, lane));
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
  for (int first = 0; first < kTileLanes; first += kGroup)
    for (int i = 0; i < kGroup; ++i) {
      const int lane = first + i;
      const bool in = cell[lane] == wanted;
      const vec3 p = positionOf(tile, lane), n = ngOf(tile, lane), d = nsOf(tile, lane) - n;
      lower[i] = min(lower[i], in ? p : vec3(kNone));
      upper[i] = max(upper[i], in ? p : vec3(-kNone));
      sum[i] += in ? n : vec3(0.0f);
      apart[i] = max(apart[i], in ? dot(d, d) : 0.0f);
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
  for (int first = 0; first < kTileLanes; first += kGroup)
    for (int i = 0; i < kGroup; ++i)
      least[i] = min(least[i], cell[first + i] == wanted ? dot(out.axis, ngOf(tile, first + i)) : 1.0f);
  out.leastCosine = *std::min_element(least, least + kGroup);
}

ISOPHOTE_SIMD(cells, cellsBody, (const ViewTile& tile, const DepthCells& cells, std::int32_t* cell),
              (tile, cells, cell))
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

DepthCells depthCells(const ViewSamples& view, float cellDepth) {
  DepthCells cells;
  cells.eye = view.camera.eye;
  cells.forward = view.camera.forward;
  cells.parallel = view.camera.orthographic > 0.5f;
  // The corners of the tiles' bounds enclose the depths of their samples.
  const vec3 along = view.camera.forward, absolute = abs(along);
  float nearest = 1e30f, farthest = 1e-6f;
  for (std::size_t i = 0; i < view.primaryTiles; ++i) {
    const Bounds& bounds = view.tiles[i].bounds;
    if (view.tiles[i].count == 0) continue;
    const float depth = dot(bounds.centre() - cells.eye, along);
    const float half = 0.5f * dot(bounds.size(), absolute);
    nearest = std::min(nearest, depth - half);
    farthest = std::max(farthest, depth + half);
  }
  cells.nearest = cells.parallel ? nearest : std::clamp(nearest, 1e-3f * farthest, farthest);
  // The width of a cell, at distance 1 where rays diverge.
  const float width = 2.0f * length(view.camera.up) * float(kTileSide) / float(std::max(view.height, 1));
  const float depth = std::max(width * cellDepth, 1e-9f);
  const float range = cells.parallel ? farthest - cells.nearest : std::log2(farthest / cells.nearest) + 1.0f;
  constexpr float kMostCells = 4000;
  cells.scale = std::min(cells.parallel ? 1.0f / depth : 1.0f / std::log2(1.0f + depth),
                         kMostCells / std::max(range, 1e-6f));
  return cells;
}

}  // namespace

void Clusters::build(const ViewSamples& view, float cellDepth, SimdLevel simd) {
  const DepthCells depths = depthCells(view, cellDepth);
  const std::size_t chunks = (view.tiles.size() + kTilesPerChunk - 1) / kTilesPerChunk;
  chunks_.resize(chunks);
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    std::vector<Cluster>& found = chunks_[chunk];
    found.clear();
    const std::size_t end = std::min(view.tiles.size(), (chunk + 1) * kTilesPerChunk);
    for (std::size_t t = chunk * kTilesPerChunk; t < end; ++t) {
      const ViewTile& tile = view.tiles[t];
      if (tile.count == 0) continue;
      const bool primary = t < view.primaryTiles;
      std::array<std::int32_t, kTileLanes> cell;
      cellsFor(simd)(tile, depths, cell.data());
      if (!primary)
        for (std::int32_t& c : cell) c = c == kNoCell ? kNoCell : 0;
      const std::uint64_t x = primary ? t % std::size_t(view.tilesX) : 0;
      const std::uint64_t y = primary ? t / std::size_t(view.tilesX) : 0;
      std::uint64_t left = bitsWhere([&](int lane) { return cell[std::size_t(lane)] != kNoCell; });
      while (left != 0) {
        const std::int32_t wanted = cell[std::size_t(std::countr_zero(left))];
        Measured m;
        measureFor(simd)(tile, cell.data(), wanted, m);
        left &= ~m.lanes;
        Cluster& c = found.emplace_back();
        c.key = primary ? spreadBits(x) | spreadBits(y) << 1 | spreadBits(std::uint64_t(wanted)) << 2
                        : kSecondaryKey + (t - view.primaryTiles);
        c.lanes = m.lanes;
        c.tile = std::uint32_t(t);
        c.kind = {tile.lambertian != 0, tile.transmits != 0, photon_estimate::isFlat(m.normalsApart2)};
        c.bounds = m.bounds;
        c.cone = {m.axis, std::acos(clamp(m.leastCosine, -1.0f, 1.0f))};
      }
    }
  });
  unsorted_.clear();
  for (const std::vector<Cluster>& chunk : chunks_)
    unsorted_.insert(unsorted_.end(), chunk.begin(), chunk.end());
  order_.resize(unsorted_.size());
  for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = {unsorted_[i].key, i};
  tbb::parallel_sort(order_.begin(), order_.end());
  clusters_.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) clusters_[i] = unsorted_[order_[i].second];
}

}  // namespace isophote::photon_clusters

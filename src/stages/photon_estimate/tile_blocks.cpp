// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_estimate/tile_blocks.h"

#include "math/morton.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace isophote::photon_estimate {
namespace {

constexpr float kNowhere = 1e18f;
constexpr int kBlockSide = 8;  ///< Tiles.
static_assert(kBlockSide * kBlockSide == kNodeWidth);

}  // namespace

BoundsNode::BoundsNode() {
  for (int i = 0; i < kNodeWidth; ++i) set(i, {}, true);
}

void BoundsNode::set(int slot, const Bounds& bounds, bool direct) {
  const bool empty = bounds.empty();
  const std::uint64_t bit = std::uint64_t(1) << slot;
  seenDirectly = empty || direct ? seenDirectly | bit : seenDirectly & ~bit;
  lower.set(slot, empty ? vec3(kNowhere) : bounds.lower);
  upper.set(slot, empty ? vec3(kNowhere) : bounds.upper);
}

Bounds BoundsNode::all() const {
  Bounds all;
  for (int i = 0; i < kNodeWidth; ++i)
    if (lower.x[i] != kNowhere) all.extend(Bounds{lower[i], upper[i]});
  return all;
}

void TileBlocks::build(const ViewSamples& view) {
  const std::uint32_t blocksX = (std::uint32_t(view.tilesX) + kBlockSide - 1) / kBlockSide;
  const std::uint32_t blocksY = (std::uint32_t(view.tilesY) + kBlockSide - 1) / kBlockSide;
  const std::size_t primaryBlocks = view.primaryTiles > 0 ? std::size_t(blocksX) * blocksY : 0;
  const std::size_t secondaryTiles = view.tiles.size() - view.primaryTiles;
  order_.resize(primaryBlocks);
  for (std::uint32_t i = 0; i < order_.size(); ++i)
    order_[i] = {spreadByOne(i % blocksX) | spreadByOne(i / blocksX) << 1, i};
  std::sort(order_.begin(), order_.end());

  tiles_.resize(primaryBlocks + (secondaryTiles + kNodeWidth - 1) / kNodeWidth);
  for (std::size_t block = 0; block < primaryBlocks; ++block) {
    const int x0 = int(order_[block].second % blocksX) * kBlockSide;
    const int y0 = int(order_[block].second / blocksX) * kBlockSide;
    for (int slot = 0; slot < kNodeWidth; ++slot) {
      const int x = x0 + slot % kBlockSide;
      const int y = y0 + slot / kBlockSide;
      const bool inside = x < view.tilesX && y < view.tilesY;
      tiles_[block][std::size_t(slot)] = inside ? std::uint32_t(y * view.tilesX + x) : kNoTile;
    }
  }
  for (std::size_t i = 0; i < (tiles_.size() - primaryBlocks) * kNodeWidth; ++i) {
    const std::size_t tile = view.primaryTiles + i;
    tiles_[primaryBlocks + i / kNodeWidth][i % kNodeWidth] =
        tile < view.tiles.size() ? std::uint32_t(tile) : kNoTile;
  }
  buildLevels(view);
}

void TileBlocks::buildLevels(const ViewSamples& view) {
  std::size_t levels = 0;
  for (std::size_t count = tiles_.size(); count > 0;
       count = count > 1 ? (count + kNodeWidth - 1) / kNodeWidth : 0)
    ++levels;
  levels_.resize(levels);
  if (levels == 0) return;
  levels_[0].resize(tiles_.size());
  tbb::parallel_for(std::size_t(0), tiles_.size(), [&](std::size_t block) {
    for (int slot = 0; slot < kNodeWidth; ++slot) {
      const std::uint32_t tile = tiles_[block][std::size_t(slot)];
      levels_[0][block].set(slot, tile == kNoTile ? Bounds{} : view.tiles[tile].bounds,
                            tile < view.directTiles);
    }
  });
  for (std::size_t level = 1; level < levels; ++level) {
    const std::vector<BoundsNode>& below = levels_[level - 1];
    std::vector<BoundsNode>& nodes = levels_[level];
    nodes.resize((below.size() + kNodeWidth - 1) / kNodeWidth);
    for (std::size_t i = 0; i < nodes.size() * kNodeWidth; ++i) {
      const bool some = i < below.size();
      nodes[i / kNodeWidth].set(int(i % kNodeWidth), some ? below[i].all() : Bounds{},
                                some && below[i].allSeenDirectly());
    }
  }
}

std::uint64_t TileBlocks::bytes() const {
  std::uint64_t bytes = tiles_.size() * sizeof(tiles_[0]);
  for (const std::vector<BoundsNode>& level : levels_) bytes += level.size() * sizeof(BoundsNode);
  return bytes;
}

}  // namespace isophote::photon_estimate

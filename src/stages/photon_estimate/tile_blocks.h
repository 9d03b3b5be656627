// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/lanes.h"
#include "stages/gbuffer/view_samples.h"

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace isophote::photon_estimate {

inline constexpr int kNodeWidth = 64;
inline constexpr std::uint32_t kNoTile = 0xffffffffu;

/// The world bounds of 64 things, laid out for one vector loop. Empty ones lie where no photon reaches.
struct BoundsNode {
  Vec3Lanes<kNodeWidth> lower, upper;
  std::uint64_t seenDirectly =
      0;  ///< Bit i: the eye sees all view samples in bounds i, by no mirror or glass.

  BoundsNode();
  void set(int slot, const Bounds& bounds, bool direct);  ///< `bounds` may be empty.
  Bounds all() const;
  bool allSeenDirectly() const { return ~seenDirectly == 0; }
};

/// Sets bit i of `mask` when the photon may be felt in bounds i. Conservative: never 0 where it is felt at a
/// point of the bounds as floats compute it.
template <class Photon>
using TouchFn = void (*)(const BoundsNode& node, const Photon& photon, std::uint64_t& mask);

/// Where the view samples are: blocks of 64 tiles under an implicit tree of world bounds, 64 children a node.
/// Primary tiles form blocks of 8 x 8 neighbours on the screen, blocks follow a Morton curve, so that nodes
/// are compact on the screen and mostly in space; secondary tiles, sorted in space already, follow in their
/// order. Because every test is in world space, photons around the eye and behind it need no special care.
class TileBlocks {
 public:
  /// Reuses memory.
  void build(const ViewSamples& view);

  std::size_t size() const { return tiles_.size(); }
  /// Indices into ViewSamples::tiles, kNoTile where a slot is empty.
  const std::array<std::uint32_t, kNodeWidth>& tiles(std::size_t block) const { return tiles_[block]; }
  /// Bounds of the tiles of a block.
  const BoundsNode& bounds(std::size_t block) const { return levels_[0][block]; }
  std::uint64_t bytes() const;

  /// Calls visit(block) for every block that the photon may reach, in ascending order.
  template <class Photon, class Visit>
  void forEachTouched(const Photon& photon, TouchFn<Photon> touch, Visit&& visit) const {
    if (!levels_.empty()) descend(levels_.size() - 1, 0, photon, touch, visit);
  }

 private:
  void buildLevels(const ViewSamples& view);

  template <class Photon, class Visit>
  void descend(std::size_t level, std::size_t node, const Photon& photon, TouchFn<Photon> touch,
               Visit&& visit) const {
    std::uint64_t mask = 0;
    touch(levels_[level][node], photon, mask);
    if (level == 0) {
      if (mask != 0) visit(node);
      return;
    }
    for (; mask != 0; mask &= mask - 1)
      descend(level - 1, node * kNodeWidth + std::size_t(std::countr_zero(mask)), photon, touch, visit);
  }

  std::vector<std::array<std::uint32_t, kNodeWidth>> tiles_;
  /// levels_[0][i] holds the tiles of block i, levels_[n + 1][i] the nodes 64 i to 64 i + 63 of level n; the
  /// last has one node.
  std::vector<std::vector<BoundsNode>> levels_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order_;  ///< Morton code and row-major block index.
};

}  // namespace isophote::photon_estimate

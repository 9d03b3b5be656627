// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_clusters/cluster_tree.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote::photon_clusters {

/// Levels of the tree below the nodes where the shallow pass leaves photons.
inline constexpr std::size_t kDeepLevels = 2;

/// The deep pass: photons that may reach one subtree, on lists of its nodes. The lists of one subtree are
/// worked off while they are still in the cache, so that they never meet the memory.
class SubtreeLists {
 public:
  /// Reuses memory. Accepted power is added to the nodes of `tree` below the root.
  void start(ClusterTree& tree, std::size_t level, std::uint32_t root);

  /// Takes photons until there are `maxEntries` entries or none is left; returns how many.
  std::size_t take(HitFn hit, std::span<const PhotonSphere> all, std::span<const std::uint32_t> photons,
                   std::size_t maxEntries);

  /// Copies of what was taken, in this order.
  const std::vector<PhotonSphere>& spheres() const { return spheres_; }
  /// Into spheres(), ascending: photons whose sphere holds the node as a whole.
  std::span<const std::uint32_t> enclosing(std::size_t level, std::uint32_t node) const {
    return list(local(level, node));
  }
  /// Those that may reach into the cluster.
  std::span<const std::uint32_t> touching(std::uint32_t cluster) const {
    return list(nodes_ + cluster - begin_[0]);
  }
  std::uint32_t firstCluster() const { return begin_[0]; }
  std::uint32_t endCluster() const { return begin_[0] + lists_ - nodes_; }
  std::size_t entries() const { return list_.size(); }

 private:
  static constexpr int kPhotonBits = 13;
  static constexpr std::uint32_t kMostPhotons = 1u << kPhotonBits;
  static_assert(2 * 1024 + 32 + 1 < 1u << (32 - kPhotonBits), "lists of a subtree");

  std::uint32_t local(std::size_t level, std::uint32_t node) const {
    return offset_[level] + node - begin_[level];
  }
  std::span<const std::uint32_t> list(std::uint32_t i) const {
    return {list_.data() + place_[i], list_.data() + place_[i + 1]};
  }

  ClusterTree* tree_ = nullptr;
  std::size_t level_ = 0;
  std::uint32_t root_ = 0;
  /// Of each level of the subtree: its first node, and the number of the list of that one.
  std::array<std::uint32_t, kDeepLevels + 1> begin_{}, offset_{};
  std::uint32_t nodes_ = 0;  ///< Of the subtree; then come the lists of touched clusters.
  std::uint32_t lists_ = 0;
  std::vector<PhotonSphere> spheres_;
  std::vector<std::uint32_t> entries_;  ///< List, then photon in the lowest kPhotonBits.
  std::vector<std::uint32_t> place_;    ///< Of each list in list_, and the end.
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> list_;
};

}  // namespace isophote::photon_clusters

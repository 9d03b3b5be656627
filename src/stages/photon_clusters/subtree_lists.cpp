// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/subtree_lists.h"

#include <algorithm>

namespace isophote::photon_clusters {

void SubtreeLists::start(ClusterTree& tree, std::size_t level, std::uint32_t root) {
  tree_ = &tree;
  level_ = level;
  root_ = root;
  nodes_ = 0;
  std::uint32_t first = root, last = root;
  for (std::size_t l = level;; --l) {
    begin_[l] = first;
    offset_[l] = nodes_;
    nodes_ += last - first + 1;
    if (l == 0) break;
    const Level& nodes = tree.levels()[l];
    first = nodes.firstChild[first];
    last = nodes.firstChild[last] + nodes.childCount(last) - 1;
  }
  lists_ = nodes_ + last - first + 1;
  spheres_.clear();
  list_.clear();
  place_.assign(lists_ + 1, 0);
}

std::size_t SubtreeLists::take(HitFn hit, std::span<const PhotonSphere> all,
                               std::span<const std::uint32_t> photons, std::size_t maxEntries) {
  spheres_.clear();
  entries_.clear();
  place_.assign(lists_ + 1, 0);
  const Level& roots = tree_->levels()[level_];
  const std::size_t most = std::min(photons.size(), kMostPhotons);
  while (spheres_.size() < most && (spheres_.empty() || entries_.size() < maxEntries)) {
    const std::uint32_t photon = std::uint32_t(spheres_.size());
    const PhotonSphere& sphere = spheres_.emplace_back(all[photons[photon]]);
    const auto add = [&](std::uint32_t list) {
      entries_.push_back(std::uint64_t(list) << 32 | photon);
      ++place_[list + 1];
    };
    if (level_ == 0) {
      add(nodes_);
      continue;
    }
    tree_->descend(
        hit, sphere, level_ - 1, roots.firstChild[root_], roots.childCount(root_), 0,
        [&](std::size_t level, std::uint32_t node, bool accepted) {
          if (!accepted) return add(local(level, node));
          Level& nodes = tree_->levels()[level];
          nodes.power[node] += sphere.weightedPower;
          ++nodes.accepted[node];
        },
        [&](std::size_t, std::uint32_t node) { add(nodes_ + node - begin_[0]); });
  }
  for (std::uint32_t i = 0; i < lists_; ++i) place_[i + 1] += place_[i];
  next_.assign(place_.begin(), place_.end() - 1);
  list_.resize(entries_.size());
  for (const std::uint64_t entry : entries_) list_[next_[entry >> 32]++] = std::uint32_t(entry);
  return spheres_.size();
}

}  // namespace isophote::photon_clusters

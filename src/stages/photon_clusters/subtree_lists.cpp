// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/subtree_lists.h"

#include <algorithm>

namespace isophote::photon_clusters {
namespace {

constexpr std::uint32_t kAhead = 12;  ///< Photons asked for before they are needed: they lie apart.

}  // namespace

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
  const std::size_t most = std::min<std::size_t>(photons.size(), kMostPhotons);
  while (spheres_.size() < most && (spheres_.empty() || entries_.size() < maxEntries)) {
    const std::uint32_t photon = std::uint32_t(spheres_.size());
    if (photon + kAhead < most) __builtin_prefetch(&all[photons[photon + kAhead]]);
    const PhotonSphere& sphere = spheres_.emplace_back(all[photons[photon]]);
    const auto add = [&](std::uint32_t list) {
      entries_.push_back(list << kPhotonBits | photon);
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
  for (const std::uint32_t entry : entries_)
    list_[next_[entry >> kPhotonBits]++] = entry & (kMostPhotons - 1);
  return spheres_.size();
}

}  // namespace isophote::photon_clusters

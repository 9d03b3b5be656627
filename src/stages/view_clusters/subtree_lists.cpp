// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/view_clusters/subtree_lists.h"

namespace isophote::view_clusters {
namespace {

constexpr std::size_t kFewestSubtrees = 128;  ///< Where there are as many nodes: to share between threads.

}  // namespace

void SubtreeLists::prepare(const ClusterTree& tree, std::size_t lowest) {
  tree_ = &tree;
  const std::span<const Level> levels = tree.levels();
  rootLevel_ = levels.empty() ? 0 : levels.size() - 1;
  while (rootLevel_ > lowest && levels[rootLevel_].size() < kFewestSubtrees) --rootLevel_;
  base_.assign(levels.size(), 0);
  nodes_ = 0;
  for (std::size_t l = rootLevel_; l < levels.size(); ++l) {
    base_[l] = nodes_;
    nodes_ += std::uint32_t(levels[l].size());
  }
}

std::uint32_t SubtreeLists::build(std::span<const PhotonSphere> spheres, float radius2, std::uint32_t first,
                                  std::uint64_t maxBytes, SimdLevel simd, const Job& job) {
  const std::size_t top = topLevel();
  const std::uint32_t width = std::uint32_t(tree_->levels()[top].size());
  const auto walkChunk = [&](std::uint32_t begin, std::uint32_t end, ChunkLists::Chunk& lists) {
    job.throwIfStopped();
    Workspace& work = workspaces_.local();
    work.walk.prepare(*tree_, end - begin, radius2, simd);
    work.photons.reserve(end - begin);
    work.photons.count = 0;
    for (std::uint32_t i = begin; i < end; ++i) work.photons.push(spheres[i], i - begin);
    work.walk.descend(top, 0, width, work.photons,
                      [&](std::size_t level, std::uint32_t node, const Sifted& sifted) {
                        lists.put(listOf(level, node, kEnclosing), sifted.enclosingList());
                        lists.put(listOf(level, node, kAccepted), sifted.acceptedList());
                        if (level > rootLevel_) return sifted.touching.count > 0;
                        lists.put(listOf(level, node, kTouching), sifted.touching.list());
                        return false;
                      });
  };
  return lists_.build(first, std::uint32_t(spheres.size()), std::size_t(nodes_) * kCount, maxBytes,
                      walkChunk);
}

}  // namespace isophote::view_clusters

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "stages/view_clusters/chunk_lists.h"
#include "stages/view_clusters/photon_sift.h"

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>
#include <vector>

namespace isophote::view_clusters {

/// Cuts a tree of clusters into subtrees, to be shared between threads, and leaves photons on lists at what
/// lies above and at their roots: the shallow pass.
class SubtreeLists {
 public:
  /// What a node's photons are to its samples, as photon_sift says; those that only may reach some are left
  /// at the roots of subtrees alone.
  enum Which : std::uint32_t { kEnclosing, kAccepted, kTouching, kCount };

  /// Chooses the subtrees, whose roots lie no lower than `lowest`. `tree` must outlive the use.
  void prepare(const ClusterTree& tree, std::size_t lowest = 0);
  std::size_t rootLevel() const { return rootLevel_; }
  std::size_t topLevel() const { return tree_->levels().size() - 1; }
  std::uint32_t subtrees() const {
    return tree_->levels().empty() ? 0 : std::uint32_t(tree_->levels()[rootLevel_].size());
  }

  /// Fills the lists with photons from `first` on, as ChunkLists::build; returns how many it took.
  std::uint32_t build(std::span<const PhotonSphere> spheres, float radius2, std::uint32_t first,
                      std::uint64_t maxBytes, SimdLevel simd, const Job& job);

  /// Photons of a node at rootLevel() or above, as ChunkLists::forEachPart.
  template <class Part>
  void forEachPart(std::size_t level, std::uint32_t node, Which which, std::size_t most,
                   std::vector<std::uint32_t>& memory, Part&& part) const {
    lists_.forEachPart(listOf(level, node, which), most, memory, part);
  }
  std::size_t entries() const { return lists_.entries(); }
  std::uint64_t bytes() const { return lists_.bytes(); }

 private:
  struct Workspace {
    PhotonWalk walk;
    PhotonColumns photons;
  };
  std::size_t listOf(std::size_t level, std::uint32_t node, Which which) const {
    return std::size_t(base_[level] + node) * kCount + which;
  }

  const ClusterTree* tree_ = nullptr;
  std::size_t rootLevel_ = 0;
  std::uint32_t nodes_ = 0;          ///< That have lists.
  std::vector<std::uint32_t> base_;  ///< Of each level: number of its first node among them.
  ChunkLists lists_;
  tbb::enumerable_thread_specific<Workspace> workspaces_;
};

}  // namespace isophote::view_clusters

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/photon_estimate/photon_sphere.shared.h"
#include "stages/view_clusters/cluster_tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote::view_clusters {

/// What nodes ask of photons, one array a component so that a node meets 16 of them at once.
struct PhotonColumns {
  static constexpr std::uint32_t kLanes = 16;
  static constexpr std::size_t kComponents = 9;  ///< Position, direction, weighted power.
  static constexpr std::size_t kWithoutPower = 6;

  std::vector<float> components[kComponents];
  std::vector<std::uint32_t> ids;
  std::uint32_t count = 0;
  bool hasPower = false;

  std::size_t used() const { return hasPower ? kComponents : kWithoutPower; }
  /// Makes room for as many photons, and for the rest of the 16 that end with the last one.
  void reserve(std::size_t photons, bool withPower = false);
  void push(const PhotonSphere& photon, std::uint32_t id) {
    for (int c = 0; c < 3; ++c) {
      components[c][count] = photon.position[c];
      components[3 + c][count] = photon.direction[c];
      if (hasPower) components[6 + c][count] = photon.weightedPower[c];
    }
    ids[count++] = id;
  }
  std::span<const std::uint32_t> list() const { return {ids.data(), count}; }
};

/// The photons of a list that one node meets, in its order.
struct Sifted {
  PhotonColumns touching;  ///< May reach some of its samples: for its children to tell.
  std::vector<std::uint32_t> enclosing;
  std::uint32_t enclosingCount = 0;  ///< All its samples lie within their spheres.
  std::vector<std::uint32_t> accepted;
  std::uint32_t acceptedCount = 0;  ///< All its samples feel them alike.

  void reserve(std::size_t photons, bool withPower);
  std::span<const std::uint32_t> enclosingList() const { return {enclosing.data(), enclosingCount}; }
  std::span<const std::uint32_t> acceptedList() const { return {accepted.data(), acceptedCount}; }
};

/// Sorts photons of one radius by what they do to a node. Conservative: `touching` whenever a point of the
/// bounds is within the radius as WithinSphere computes it, `enclosing` and `accepted` only where all are.
/// Without `columns` only the ids of touching photons are filled in. The same at every SimdLevel.
using SiftFn = void (*)(const Node& node, float radius2, const PhotonColumns& from, bool columns, Sifted& to);
SiftFn siftFor(SimdLevel level);

/// Follows lists of photons down the tree, one node after the other, so that no list is needed longer than
/// its node's children are visited.
class PhotonWalk {
 public:
  /// Makes room for lists of so many photons on all levels; reuses memory. Photons bring their power along
  /// only where they are asked to.
  void prepare(const ClusterTree& tree, std::size_t photons, float radius2, SimdLevel simd,
               bool withPower = false) {
    tree_ = &tree;
    radius2_ = radius2;
    sift_ = siftFor(simd);
    if (steps_.size() < tree.levels().size()) steps_.resize(tree.levels().size());
    for (Sifted& step : steps_) step.reserve(photons, withPower);
  }

  /// Of the node visited last on that level.
  Sifted& step(std::size_t level) { return steps_[level]; }

  /// Visits `count` nodes of `level` from `first` on, and those below them while visit(level, node, sifted)
  /// returns true, with the photons of `from` that each meets. Columns are filled in above level 0.
  template <class Visit>
  void descend(std::size_t level, std::uint32_t first, std::uint32_t count, const PhotonColumns& from,
               Visit&& visit) {
    const std::vector<Node>& nodes = tree_->levels()[level].nodes;
    Sifted& sifted = steps_[level];
    for (std::uint32_t node = first; node < first + count; ++node) {
      sift_(nodes[node], radius2_, from, level > 0, sifted);
      if (visit(level, node, sifted) && level > 0)
        descend(level - 1, nodes[node].firstChild, nodes[node].childCount(), sifted.touching, visit);
    }
  }

 private:
  const ClusterTree* tree_ = nullptr;
  float radius2_ = 0;
  SiftFn sift_ = nullptr;
  std::vector<Sifted> steps_;  ///< By level.
};

}  // namespace isophote::view_clusters

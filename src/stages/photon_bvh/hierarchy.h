// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_bvh/ellipsoids.h"

#include <cstdint>
#include <vector>

namespace isophote::photon_bvh {

/// A node, or where `count` is positive a leaf: photons first to first + count - 1.
struct Child {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// With the boxes of its children. 64 bytes.
struct Node {
  Bounds bounds[2];
  Child child[2];
};
static_assert(sizeof(Node) == 64);

/// Code of each photon's place: 10 bits a coordinate of the box around all, along a Morton curve. Sorted,
/// with the photons' indices.
void sortByMorton(const PhotonMap& map, KeyedSort& sort, LargeVector<KeyedIndex>& order, const Job& job = {});

/// A binary hierarchy of boxes over ellipsoids that lie in its order. Keeps its memory.
class Hierarchy {
 public:
  /// Splits between photons whose codes differ, by the highest bit in which they do, down to leaves of
  /// leafPhotons at most; those of one code stay together. `codes` are sorted, one a photon.
  ///
  /// Works the other way round (IGPM 6.2): boxes around the photons of each code, then the splits from the
  /// lowest bit up, each of which joins two neighbours to a node, or to a leaf where their photons are few
  /// enough. The splits of one bit do not touch each other.
  void buildByMorton(const LargeVector<KeyedIndex>& codes, const Ellipsoids& ellipsoids,
                     std::uint32_t leafPhotons, const Job& job = {});

  /// Splits where volume times photons of the two halves is least, of all places along the three axes (the
  /// voxel volume heuristic). Writes the order that the photons of `ellipsoids` are to be put in: index i is
  /// that of the photon that comes i-th.
  void buildByVolume(const Ellipsoids& ellipsoids, std::uint32_t leafPhotons, LargeVector<KeyedIndex>& order,
                     const Job& job = {});

  const Child& root() const { return root_; }
  const Bounds& bounds() const { return bounds_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  std::uint64_t bytes() const { return (nodes_.capacity() + sparse_.capacity()) * sizeof(Node); }

  /// Calls leaf(first, count) for every leaf whose box meets `box`, in the photons' order.
  template <class Leaf>
  void forEachLeaf(const Bounds& box, Leaf&& leaf) const {
    constexpr int kDepth = 96;  // More than a code has bits, and than splits by volume go deep.
    Child stack[kDepth];
    int depth = 0;
    Child at = root_;
    if (!meets(bounds_, box)) return;
    for (;;) {
      if (at.count > 0) {
        leaf(at.first, at.count);
      } else {
        const Node& node = nodes_[at.first];
        const bool left = meets(node.bounds[0], box), right = meets(node.bounds[1], box);
        if (left && right) stack[depth++] = node.child[1];
        if (left || right) {
          at = node.child[left ? 0 : 1];
          continue;
        }
      }
      if (depth == 0) return;
      at = stack[--depth];
    }
  }

 private:
  /// A part of the hierarchy while it grows: neighbouring photons.
  struct Part {
    Bounds bounds;
    Child child;
    std::uint32_t photons = 0;
  };
  struct VolumeBuild;

  static bool meets(const Bounds& a, const Bounds& b) {
    return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
           b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
  }
  /// Joins two neighbours; a node that it takes gets place `slot` in sparse_.
  Part join(const Part& left, const Part& right, std::uint32_t slot, std::uint32_t leafPhotons);
  /// Moves the nodes together; `root` is the whole.
  void finish(const Part& root, std::size_t slots);

  Child root_;
  Bounds bounds_;
  std::vector<Node> nodes_;
  std::vector<Node> sparse_;                 ///< Nodes in the place of their split.
  std::vector<std::uint32_t> taken_;         ///< Of each place: 1 where there is a node, then its number.
  std::vector<Part> parts_;                  ///< By the first of their runs of one code.
  std::vector<std::uint32_t> runs_;          ///< First photon of each code, and the end.
  std::vector<std::uint32_t> first_, last_;  ///< Of the part that ends, begins with that run.
  LargeVector<KeyedIndex> splits_;           ///< By bit; between run `index` and the next.
  KeyedSort sort_;
};

}  // namespace isophote::photon_bvh

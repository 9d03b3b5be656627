// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "math/shared.h"
#include "math/simd.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote {

/// A point found: its squared distance in the upper bits and its place in the tree's order in the lower ones,
/// so that keys sort by distance and equal distances by place.
using NeighbourKey = std::uint64_t;

inline float distance2Of(NeighbourKey key) { return std::bit_cast<float>(std::uint32_t(key >> 32)); }
inline std::uint32_t placeOf(NeighbourKey key) { return std::uint32_t(key); }

/// A balanced kd-tree over points. Inner nodes form a complete binary tree in heap order, each splitting its
/// range of points in the middle, so that a node's children and range follow from its index; leaves hold at
/// most kLeafPoints, 16 of which meet a query at once. The same points give the same tree with any number of
/// threads.
class Kdtree {
 public:
  static constexpr std::uint32_t kLeafPoints = 32;

  /// Points at successive places of the tree's order.
  struct Range {
    std::uint32_t begin, end;
  };

  /// Reuses its memory. Throws Error(kStopped).
  void build(std::span<const vec3> points, const Job& job = {});

  std::size_t size() const { return order_.size(); }
  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(std::uint32_t) +
           (x_.capacity() + y_.capacity() + z_.capacity()) * sizeof(float);
  }
  /// Index in build()'s points of the point at place `at` of the tree's order.
  std::uint32_t pointAt(std::uint32_t at) const { return order_[at]; }

  /// The leaves that a sphere touches, in ascending order, joined where they follow each other; replaces
  /// `ranges`.
  void rangesWithin(vec3 centre, float distance2, std::vector<Range>& ranges) const;
  /// Visits the leaves within a distance that may shrink, near ones first: visit(range) returns the squared
  /// distance that still matters from then on.
  template <class Visit>
  void visitNearest(vec3 centre, float distance2, Visit&& visit) const;

  /// Appends the points of a range that are closer than sqrt(distance2), in ascending order of their places.
  /// `found` grows to the end of what it holds. The same at every SimdLevel.
  void appendWithin(Range range, vec3 centre, float distance2, SimdLevel simd,
                    std::vector<NeighbourKey>& found) const;

 private:
  struct Node {
    float split = 0;
    std::uint32_t axis = 0;
  };
  /// A node that is still to be visited.
  struct Pending {
    std::uint32_t node;
    Range range;
    vec3 offset;  ///< From the query to the node's region.
    float distance2;
  };
  static constexpr std::size_t kMostPending = 32;  ///< No path to a leaf is longer.

  /// Goes down to the half of a node that the query is in, and returns the other one.
  Pending descend(Pending& at, vec3 centre) const {
    const Node& node = nodes_[at.node];
    const std::uint32_t middle = at.range.begin + (at.range.end - at.range.begin) / 2;
    const float side = centre[int(node.axis)] - node.split;
    const bool left = side < 0.0f;
    Pending far = at;
    far.offset[int(node.axis)] = side;
    far.distance2 = dot(far.offset, far.offset);
    far.node = 2 * at.node + (left ? 1 : 0);
    (left ? far.range.begin : far.range.end) = middle;
    at.node = 2 * at.node + (left ? 0 : 1);
    (left ? at.range.end : at.range.begin) = middle;
    return far;
  }
  void buildNode(std::span<const vec3> points, std::uint32_t node, std::uint32_t begin, std::uint32_t end,
                 const Job& job);

  std::vector<Node> nodes_;  ///< Heap order, root at 1.
  std::vector<std::uint32_t> order_;
  std::vector<float> x_, y_, z_;  ///< Points in the tree's order; loops of 16 may begin at the last one.
};

template <class Visit>
void Kdtree::visitNearest(vec3 centre, float distance2, Visit&& visit) const {
  std::array<Pending, kMostPending> stack;
  std::size_t depth = 0;
  stack[depth++] = {1, {0, std::uint32_t(order_.size())}, vec3(0.0f), 0.0f};
  while (depth > 0) {
    Pending at = stack[--depth];
    if (at.distance2 >= distance2) continue;
    while (at.range.end - at.range.begin > kLeafPoints) {
      const Pending far = descend(at, centre);
      if (far.distance2 < distance2) stack[depth++] = far;
    }
    distance2 = visit(at.range);
  }
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote {

/// A balanced kd-tree over points. Inner nodes form a complete binary tree in heap order, each splitting its
/// range of points in the middle, so that a node's children and range follow from its index; leaves hold at
/// most kLeafPoints. The same points give the same tree with any number of threads.
class Kdtree {
 public:
  static constexpr std::uint32_t kLeafPoints = 12;

  /// Reuses its memory.
  void build(std::span<const vec3> points);

  std::size_t size() const { return order_.size(); }
  /// Index in build()'s points of the point at place `at` of the tree's order.
  std::uint32_t pointAt(std::uint32_t at) const { return order_[at]; }

  /// Visits the points within a distance that may shrink: visit(at, distance2) returns the squared distance
  /// that still matters from then on. Near leaves come first.
  template <class Visit>
  void visitWithin(vec3 centre, float distance2, Visit&& visit) const;

 private:
  struct Node {
    float split = 0;
    std::uint32_t axis = 0;
  };
  void buildNode(std::span<const vec3> points, std::uint32_t node, std::uint32_t begin, std::uint32_t end);

  std::vector<Node> nodes_;  ///< Heap order, root at 1.
  std::vector<std::uint32_t> order_;
  std::vector<float> x_, y_, z_;  ///< Points in the tree's order.
};

template <class Visit>
void Kdtree::visitWithin(vec3 centre, float distance2, Visit&& visit) const {
  struct Pending {
    std::uint32_t node, begin, end;
    vec3 offset;  ///< From the centre to the node's region.
    float distance2;
  };
  std::array<Pending, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {1, 0, std::uint32_t(order_.size()), vec3(0.0f), 0.0f};
  while (depth > 0) {
    Pending at = stack[--depth];
    if (at.distance2 >= distance2) continue;
    while (at.end - at.begin > kLeafPoints) {
      const Node& node = nodes_[at.node];
      const int axis = int(node.axis);
      const std::uint32_t middle = at.begin + (at.end - at.begin) / 2;
      const float side = centre[axis] - node.split;
      Pending far = at;
      far.offset[axis] = side;
      far.distance2 = dot(far.offset, far.offset);
      const bool left = side < 0.0f;
      far.node = 2 * at.node + (left ? 1 : 0);
      (left ? far.begin : far.end) = middle;
      if (far.distance2 < distance2) stack[depth++] = far;
      at.node = 2 * at.node + (left ? 0 : 1);
      (left ? at.end : at.begin) = middle;
    }
    for (std::uint32_t i = at.begin; i < at.end; ++i) {
      const vec3 d(x_[i] - centre.x, y_[i] - centre.y, z_[i] - centre.z);
      const float d2 = dot(d, d);
      if (d2 < distance2) distance2 = visit(i, d2);
    }
  }
}

}  // namespace isophote

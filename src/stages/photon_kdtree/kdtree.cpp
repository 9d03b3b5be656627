// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_kdtree/kdtree.h"

#include "math/bounds.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace isophote {

void Kdtree::build(std::span<const vec3> points) {
  order_.resize(points.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::size_t leaves = 1;
  while (leaves * kLeafPoints < points.size()) leaves *= 2;
  nodes_.assign(2 * leaves, {});
  buildNode(points, 1, 0, std::uint32_t(points.size()));
  x_.resize(points.size());
  y_.resize(points.size());
  z_.resize(points.size());
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
    const vec3 p = points[order_[i]];
    x_[i] = p.x;
    y_[i] = p.y;
    z_[i] = p.z;
  });
}

void Kdtree::buildNode(std::span<const vec3> points, std::uint32_t node, std::uint32_t begin,
                       std::uint32_t end) {
  if (end - begin <= kLeafPoints) return;
  Bounds bounds;
  for (std::uint32_t i = begin; i < end; ++i) bounds.extend(points[order_[i]]);
  const vec3 size = bounds.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  // Equal coordinates are told apart by index, so that the halves do not depend on the sort's whims.
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float pa = points[a][axis];
                     const float pb = points[b][axis];
                     return pa != pb ? pa < pb : a < b;
                   });
  nodes_[node] = {points[order_[middle]][axis], std::uint32_t(axis)};
  const auto left = [&] { buildNode(points, 2 * node, begin, middle); };
  const auto right = [&] { buildNode(points, 2 * node + 1, middle, end); };
  if (end - begin > 4096) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_kdtree/kdtree.h"

#include <algorithm>
#include <cmath>

namespace isophote {

/// Searches for points near one query after the other. Queries are cheapest when each is near the one before:
/// the sphere that held its answer, moved and widened by the way between them, holds the next one. Points are
/// only collected as long as they are few, and the nearest of them selected from time to time: no heap.
class NearestSearch {
 public:
  /// `tree` must outlive the search.
  explicit NearestSearch(const Kdtree& tree, SimdLevel simd = bestSimdLevel()) : tree_(tree), simd_(simd) {}

  /// Forgets the query before: the next one's answer comes in an order that depends on it alone.
  void restart() { lastDistance2_ = kEverywhere; }

  /// All points closer than sqrt(distance2) in ascending order of their places. Valid until the next query.
  std::span<const NeighbourKey> within(vec3 centre, float distance2) {
    found_.clear();
    tree_.rangesWithin(centre, distance2, ranges_);
    for (const Kdtree::Range range : ranges_) tree_.appendWithin(range, centre, distance2, simd_, found_);
    return found_;
  }

  /// The `wanted` nearest of the points that keep(place) and are closer than sqrt(largest2), or all where
  /// there are fewer; if there are as many, the farthest one comes last. Valid until the next query.
  template <class Keep>
  std::span<const NeighbourKey> nearest(vec3 centre, std::size_t wanted, float largest2, Keep&& keep) {
    const float reach = std::sqrt(lastDistance2_) + length(centre - lastCentre_);
    constexpr float kRounding = 1.0001f;
    const float reach2 = std::min(reach * reach * kRounding, largest2);
    gather(centre, wanted, reach2, keep);
    // Where other points are kept than the last time, there may be fewer.
    if (found_.size() < wanted && reach2 < largest2) gather(centre, wanted, largest2, keep);
    lastCentre_ = centre;
    lastDistance2_ = found_.size() == wanted ? distance2Of(found_.back()) : kEverywhere;
    return found_;
  }

 private:
  template <class Keep>
  void gather(vec3 centre, std::size_t wanted, float distance2, Keep&& keep) {
    const std::size_t most = wanted + std::max<std::size_t>(wanted / 2, 16);
    found_.clear();
    tree_.visitNearest(centre, distance2, [&](Kdtree::Range range) {
      const std::size_t before = found_.size();
      tree_.appendWithin(range, centre, distance2, simd_, found_);
      const auto added = found_.begin() + std::ptrdiff_t(before);
      found_.erase(std::remove_if(added, found_.end(), [&](NeighbourKey key) { return !keep(placeOf(key)); }),
                   found_.end());
      if (found_.size() >= most) distance2 = select(wanted);
      return distance2;
    });
    if (found_.size() >= wanted) select(wanted);
  }

  /// Leaves the nearest, the farthest of them last, and returns its squared distance.
  float select(std::size_t wanted) {
    std::nth_element(found_.begin(), found_.begin() + std::ptrdiff_t(wanted - 1), found_.end());
    found_.resize(wanted);
    return distance2Of(found_.back());
  }

  static constexpr float kEverywhere = 1e37f;

  const Kdtree& tree_;
  SimdLevel simd_;
  vec3 lastCentre_{0.0f};
  float lastDistance2_ = kEverywhere;
  std::vector<Kdtree::Range> ranges_;
  std::vector<NeighbourKey> found_;
};

}  // namespace isophote

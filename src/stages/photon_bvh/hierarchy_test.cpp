// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_bvh/hierarchy.h"

#include "base/error.h"
#include "math/morton.h"
#include "math/rng.shared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>
#include <stop_token>

namespace isophote::photon_bvh {
namespace {

PhotonMap clustered(std::uint32_t count) {
  PhotonMap map;
  for (std::uint32_t i = 0; i < count; ++i) {
    Photon p{};
    p.position = random3(1, i, 0) * random3(1, i % 7, 1) * vec3(5, 3, 1);
    if (i % 9 == 0) p.position = vec3(1, 1, 0.5f);  // Of one code.
    p.normal = packDirection(vec3(0, 0, 1));
    map.photons.push_back(p);
    PhotonFootprint f{};
    const float size = 0.01f + 0.1f * random3(1, i, 2).x;
    f.axisX = vec3(size, 0, 0);
    f.axisY = vec3(0, size, 0);
    f.spacing = 0.01f;
    map.footprints.push_back(f);
  }
  return map;
}

constexpr FootprintShape kShape{{1, 1, 0, 1}, 1e-3f, 1e3f, 1.0f, kKernelConstant};

LargeVector<KeyedIndex> mortonOrder(const PhotonMap& map) {
  KeyedSort sort;
  LargeVector<KeyedIndex> order;
  sortByMorton(map, sort, order);
  return order;
}

struct Leaves {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;
};

/// Walks the hierarchy, checking that boxes hold what lies below them.
void collect(const Hierarchy& h, const Ellipsoids& e, Child at, const Bounds& box, Leaves& leaves) {
  if (at.count > 0) {
    leaves.ranges.emplace_back(at.first, at.count);
    for (std::uint32_t i = at.first; i < at.first + at.count; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(e.lower[axis][i], box.lower[axis]);
        EXPECT_LE(e.upper[axis][i], box.upper[axis]);
      }
    return;
  }
  ASSERT_LT(at.first, h.nodes().size());
  const Node& node = h.nodes()[at.first];
  for (int side = 0; side < 2; ++side) {
    Bounds both = box;
    both.extend(node.bounds[side]);
    EXPECT_EQ(both.lower, box.lower);
    EXPECT_EQ(both.upper, box.upper);
    collect(h, e, node.child[side], node.bounds[side], leaves);
  }
}

Leaves leavesOf(const Hierarchy& h, const Ellipsoids& e) {
  Leaves leaves;
  collect(h, e, h.root(), h.bounds(), leaves);
  std::uint32_t next = 0;
  for (const auto& [first, count] : leaves.ranges) {
    EXPECT_EQ(first, next);
    next += count;
  }
  EXPECT_EQ(next, e.size());
  EXPECT_EQ(h.nodes().size() + 1, leaves.ranges.size());
  return leaves;
}

/// The definition, from the top down.
void splitDown(const LargeVector<KeyedIndex>& codes, std::uint32_t begin, std::uint32_t end,
               std::uint32_t leaf, Leaves& leaves) {
  const std::uint32_t differing = codes[begin].key ^ codes[end - 1].key;
  if (end - begin <= leaf || differing == 0) {
    leaves.ranges.emplace_back(begin, end - begin);
    return;
  }
  const std::uint32_t bit = std::bit_floor(differing);
  std::uint32_t middle = begin;
  while ((codes[middle].key & bit) == 0) ++middle;
  splitDown(codes, begin, middle, leaf, leaves);
  splitDown(codes, middle, end, leaf, leaves);
}

TEST(PhotonHierarchy, JoinedFromBelowIsSplitFromAbove) {
  for (const std::uint32_t count : {1u, 2u, 50u, 3000u, 20'000u})
    for (const std::uint32_t leaf : {1u, 8u, 100'000u}) {
      const PhotonMap map = clustered(count);
      const LargeVector<KeyedIndex> order = mortonOrder(map);
      Ellipsoids ellipsoids;
      makeEllipsoids(map, kShape, order, ellipsoids);
      Hierarchy hierarchy;
      hierarchy.buildByMorton(order, ellipsoids, leaf);
      Leaves expected;
      splitDown(order, 0, count, leaf, expected);
      EXPECT_EQ(leavesOf(hierarchy, ellipsoids).ranges, expected.ranges)
          << count << " photons, leaves of " << leaf;
    }
}

TEST(PhotonHierarchy, MortonCodesHaveTenBitsACoordinate) {
  const PhotonMap map = clustered(5000);
  const LargeVector<KeyedIndex> order = mortonOrder(map);
  Bounds box;
  for (const Photon& p : map.photons) box.extend(p.position);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0) {
      EXPECT_LE(order[i - 1].key, order[i].key);
    }
    const vec3 at = (map.photons[order[i].index].position - box.lower) / box.size() * 1024.0f;
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t bit = 0; bit < 10; ++bit)
        code |= (std::uint32_t(std::min(at[axis], 1023.0f)) >> bit & 1u) << (3 * bit + std::uint32_t(axis));
    // Cells begin where rounding says.
    if (code != order[i].key) {
      EXPECT_LT(std::abs(at.x - std::round(at.x)) * std::abs(at.y - std::round(at.y)) *
                    std::abs(at.z - std::round(at.z)),
                1e-2f);
    }
  }
}

TEST(PhotonHierarchy, ByVolumeHoldsEveryPhotonOnceInSmallLeaves) {
  for (const std::uint32_t count : {1u, 2u, 50u, 3000u, 12'000u})
    for (const std::uint32_t leaf : {1u, 8u, 100'000u}) {
      const PhotonMap map = clustered(count);
      LargeVector<KeyedIndex> order = mortonOrder(map), places;
      Ellipsoids ellipsoids;
      makeEllipsoids(map, kShape, order, ellipsoids);
      Hierarchy hierarchy;
      hierarchy.buildByVolume(ellipsoids, leaf, places);
      std::set<std::uint32_t> all;
      for (KeyedIndex& place : places) {
        all.insert(place.index);
        place = order[place.index];
      }
      EXPECT_EQ(all.size(), count);
      makeEllipsoids(map, kShape, places, ellipsoids);
      for (const auto& [first, photons] : leavesOf(hierarchy, ellipsoids).ranges)
        EXPECT_LE(photons, std::max(leaf, 1u));
    }
}

/// IGPM eq. 14: of all splits along the three axes the first is the cheapest.
TEST(PhotonHierarchy, TheFirstSplitHasTheLeastVolumeTimesPhotons) {
  const PhotonMap map = clustered(300);
  LargeVector<KeyedIndex> order = mortonOrder(map), places;
  Ellipsoids e;
  makeEllipsoids(map, kShape, order, e);
  const auto costOf = [&](const std::vector<std::uint32_t>& left, const std::vector<std::uint32_t>& right) {
    double cost = 0;
    for (const std::vector<std::uint32_t>* half : {&left, &right}) {
      Bounds b;
      for (const std::uint32_t i : *half) b.extend(e.bounds(i));
      cost += double(b.size().x) * double(b.size().y) * double(b.size().z) * double(half->size());
    }
    return cost;
  };
  double least = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::uint32_t> sorted(300);
    for (std::uint32_t i = 0; i < 300; ++i) sorted[i] = i;
    std::ranges::sort(sorted, {},
                      [&](std::uint32_t i) { return std::pair(e.lower[axis][i] + e.upper[axis][i], i); });
    for (std::ptrdiff_t at = 1; at < 300; ++at)
      least =
          std::min(least, costOf({sorted.begin(), sorted.begin() + at}, {sorted.begin() + at, sorted.end()}));
  }
  Hierarchy hierarchy;
  hierarchy.buildByVolume(e, 299, places);
  ASSERT_EQ(hierarchy.nodes().size(), 1u);
  std::vector<std::uint32_t> halves[2];
  for (int side = 0; side < 2; ++side) {
    const Child child = hierarchy.nodes()[0].child[side];
    for (std::uint32_t i = child.first; i < child.first + child.count; ++i)
      halves[side].push_back(places[i].index);
  }
  EXPECT_NEAR(costOf(halves[0], halves[1]), least, 1e-4 * least);
}

TEST(PhotonHierarchy, BuildsStopWhenAskedTo) {
  const PhotonMap map = clustered(40'000);
  const LargeVector<KeyedIndex> order = mortonOrder(map);
  Ellipsoids e;
  makeEllipsoids(map, kShape, order, e);
  std::stop_source stop;
  Job job;
  job.stop = stop.get_token();
  stop.request_stop();
  const auto isStopped = [](const auto& work) {
    try {
      work();
    } catch (const Error& error) {
      return error.kind() == ErrorKind::kStopped;
    }
    return false;
  };
  Hierarchy hierarchy, other;
  LargeVector<KeyedIndex> places;
  Ellipsoids spare;
  EXPECT_TRUE(isStopped([&] { makeEllipsoids(map, kShape, order, spare, job); }));
  EXPECT_TRUE(isStopped([&] { hierarchy.buildByMorton(order, e, 8, job); }));
  EXPECT_TRUE(isStopped([&] { hierarchy.buildByVolume(e, 8, places, job); }));
  hierarchy.buildByMorton(order, e, 8);
  other.buildByMorton(order, e, 8);
  EXPECT_EQ(leavesOf(hierarchy, e).ranges, leavesOf(other, e).ranges);
}

/// All leaves whose boxes meet a box are found, and no others.
TEST(PhotonHierarchy, FindsTheLeavesThatMeetABox) {
  const PhotonMap map = clustered(5000);
  const LargeVector<KeyedIndex> order = mortonOrder(map);
  Ellipsoids e;
  makeEllipsoids(map, kShape, order, e);
  Hierarchy hierarchy;
  hierarchy.buildByMorton(order, e, 8);
  for (std::uint32_t q = 0; q < 100; ++q) {
    const vec3 at = random3(4, q, 0) * vec3(5, 3, 1);
    const Bounds box{at, at + random3(4, q, 1) * 0.3f};
    std::vector<bool> found(e.size(), false);
    hierarchy.forEachLeaf(box, [&](std::uint32_t first, std::uint32_t count) {
      for (std::uint32_t i = first; i < first + count; ++i) found[i] = true;
    });
    for (std::uint32_t i = 0; i < e.size(); ++i) {
      const Bounds b = e.bounds(i);
      bool meets = true;
      for (int axis = 0; axis < 3; ++axis)
        meets = meets && b.lower[axis] <= box.upper[axis] && b.upper[axis] >= box.lower[axis];
      if (meets) {
        EXPECT_TRUE(found[i]);
      }
    }
  }
}

}  // namespace
}  // namespace isophote::photon_bvh

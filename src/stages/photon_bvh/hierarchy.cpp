// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_bvh/hierarchy.h"

#include "base/stop_check.h"
#include "math/morton.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>

namespace isophote::photon_bvh {

namespace {

constexpr std::uint32_t kCodeBits = 30;
constexpr std::size_t kGrain = 2048;

tbb::blocked_range<std::size_t> rangeOf(std::size_t count) { return {0, count, kGrain}; }

}  // namespace

void sortByMorton(const PhotonMap& map, KeyedSort& sort, LargeVector<KeyedIndex>& order, const Job& job) {
  const std::vector<Photon>& photons = map.photons;
  const Bounds box = tbb::parallel_reduce(
      rangeOf(photons.size()), Bounds{},
      [&](const auto& range, Bounds bounds) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) bounds.extend(photons[i].position);
        return bounds;
      },
      [](Bounds a, const Bounds& b) {
        a.extend(b);
        return a;
      });
  job.throwIfStopped();
  const vec3 cells = float(1u << (kCodeBits / 3)) / max(box.size(), vec3(1e-30f));
  order.resize(photons.size());
  tbb::parallel_for(rangeOf(photons.size()), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      order[i] = {mortonCode((photons[i].position - box.lower) * cells, kCodeBits / 3), std::uint32_t(i)};
  });
  job.throwIfStopped();
  sort.sort(order, kCodeBits);
}

Hierarchy::Part Hierarchy::join(const Part& left, const Part& right, std::uint32_t slot,
                                std::uint32_t leafPhotons) {
  Part joined{left.bounds, {}, left.photons + right.photons};
  joined.bounds.extend(right.bounds);
  taken_[slot] = joined.photons > leafPhotons ? 1u : 0u;
  if (taken_[slot] != 0u) {
    sparse_[slot] = {{left.bounds, right.bounds}, {left.child, right.child}};
    joined.child = {slot, 0};
  } else {
    joined.child = {left.child.first, joined.photons};
  }
  return joined;
}

void Hierarchy::finish(const Part& root, std::size_t slots) {
  std::uint32_t nodes = 0;
  for (std::size_t i = 0; i < slots; ++i) {
    const std::uint32_t taken = taken_[i];
    taken_[i] = nodes;
    nodes += taken;
  }
  const auto numbered = [&](Child child) { return child.count > 0 ? child : Child{taken_[child.first], 0}; };
  nodes_.resize(nodes);
  tbb::parallel_for(rangeOf(slots), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if ((i + 1 < slots ? taken_[i + 1] : nodes) == taken_[i]) continue;
      Node node = sparse_[i];
      for (Child& child : node.child) child = numbered(child);
      nodes_[taken_[i]] = node;
    }
  });
  root_ = numbered(root.child);
  bounds_ = root.bounds;
}

void Hierarchy::buildByMorton(const LargeVector<KeyedIndex>& codes, const Ellipsoids& ellipsoids,
                              std::uint32_t leafPhotons, const Job& job) {
  runs_.clear();
  for (std::uint32_t i = 0; i < codes.size(); ++i)
    if (i == 0 || codes[i].key != codes[i - 1].key) runs_.push_back(i);
  const std::size_t runs = runs_.size();
  runs_.push_back(std::uint32_t(codes.size()));
  parts_.resize(runs);
  first_.resize(runs);
  last_.resize(runs);
  splits_.resize(runs - 1);
  taken_.resize(runs);
  if (sparse_.size() < runs) sparse_.resize(runs);
  tbb::parallel_for(rangeOf(runs), [&](const auto& range) {
    job.throwIfStopped();
    for (std::size_t r = range.begin(); r < range.end(); ++r) {
      const std::uint32_t first = runs_[r], count = runs_[r + 1] - first;
      Part part{{}, {first, count}, count};
      for (std::uint32_t i = first; i < first + count; ++i) part.bounds.extend(ellipsoids.bounds(i));
      parts_[r] = part;
      first_[r] = last_[r] = std::uint32_t(r);
      if (r + 1 == runs) continue;
      const std::uint32_t differing = codes[first].key ^ codes[runs_[r + 1]].key;
      splits_[r] = {std::uint32_t(std::bit_width(differing)) - 1, std::uint32_t(r)};
    }
  });
  job.throwIfStopped();
  sort_.sort(splits_, 5);
  for (std::size_t begin = 0, end = 0; begin < splits_.size(); begin = end) {
    while (end < splits_.size() && splits_[end].key == splits_[begin].key) ++end;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, kGrain), [&](const auto& range) {
      job.throwIfStopped();
      for (std::size_t s = range.begin(); s < range.end(); ++s) {
        const std::uint32_t split = splits_[s].index;
        const std::uint32_t left = first_[split], right = split + 1, last = last_[right];
        parts_[left] = join(parts_[left], parts_[right], split, leafPhotons);
        last_[left] = last;
        first_[last] = left;
      }
    });
  }
  job.throwIfStopped();
  finish(parts_[0], runs - 1);
}

/// The recursion of the voxel volume heuristic, on three orders of the same photons.
struct Hierarchy::VolumeBuild {
  Hierarchy& tree;
  const Ellipsoids& ellipsoids;
  std::uint32_t leafPhotons;
  const Job& job;
  std::vector<std::uint32_t> orders[3];  ///< By centre along each axis.
  std::vector<std::uint32_t> spare;
  std::vector<std::uint8_t> isRight;
  std::vector<float> costs;  ///< By place of the split, of what lies right of it.

  static double volume(const Bounds& b) {
    const vec3 size = b.size();
    return double(size.x) * double(size.y) * double(size.z);
  }

  struct Split {
    int axis = 0;
    std::uint32_t at = 0;
    double cost = 1e300;
  };

  Split best(std::uint32_t begin, std::uint32_t end, int depth) {
    // Deep in the hierarchy in halves, so that its depth has a bound.
    constexpr int kDeep = 48;
    if (depth > kDeep) return {0, begin + (end - begin) / 2, 0.0};
    Split split;
    StopCheck check(job);
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<std::uint32_t>& order = orders[axis];
      Bounds bounds;
      for (std::uint32_t i = end - 1; i > begin; --i) {
        check();
        bounds.extend(ellipsoids.bounds(order[i]));
        costs[i] = float(volume(bounds) * double(end - i));
      }
      bounds = {};
      for (std::uint32_t i = begin + 1; i < end; ++i) {
        check();
        bounds.extend(ellipsoids.bounds(order[i - 1]));
        const double cost = volume(bounds) * double(i - begin) + double(costs[i]);
        if (cost < split.cost) split = {axis, i, cost};
      }
    }
    // Boxes without volume: halves.
    if (split.at == 0) split = {0, begin + (end - begin) / 2, 0.0};
    return split;
  }

  void partition(std::uint32_t begin, std::uint32_t end, const Split& split) {
    for (std::uint32_t i = begin; i < end; ++i) isRight[orders[split.axis][i]] = i >= split.at ? 1 : 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == split.axis) continue;
      std::uint32_t left = begin, right = split.at;
      for (std::uint32_t i = begin; i < end; ++i) {
        const std::uint32_t photon = orders[axis][i];
        spare[isRight[photon] != 0 ? right++ : left++] = photon;
      }
      std::copy(spare.begin() + begin, spare.begin() + end, orders[axis].begin() + begin);
    }
  }

  Part build(std::uint32_t begin, std::uint32_t end, int depth) {
    constexpr std::uint32_t kWorthThreads = 4096;
    if (end - begin <= leafPhotons) {
      Part leaf{{}, {begin, end - begin}, end - begin};
      for (std::uint32_t i = begin; i < end; ++i) leaf.bounds.extend(ellipsoids.bounds(orders[0][i]));
      return leaf;
    }
    const Split split = best(begin, end, depth);
    partition(begin, end, split);
    Part halves[2];
    const auto half = [&](int which) {
      halves[which] = which == 0 ? build(begin, split.at, depth + 1) : build(split.at, end, depth + 1);
    };
    if (end - begin > kWorthThreads) {
      tbb::parallel_for(0, 2, half);
    } else {
      half(0);
      half(1);
    }
    return tree.join(halves[0], halves[1], split.at, leafPhotons);
  }
};

void Hierarchy::buildByVolume(const Ellipsoids& ellipsoids, std::uint32_t leafPhotons,
                              LargeVector<KeyedIndex>& order, const Job& job) {
  const std::size_t count = ellipsoids.size();
  VolumeBuild build{*this,
                    ellipsoids,
                    leafPhotons,
                    job,
                    {},
                    std::vector<std::uint32_t>(count),
                    std::vector<std::uint8_t>(count),
                    std::vector<float>(count)};
  tbb::parallel_for(0, 3, [&](int axis) {
    build.orders[axis].resize(count);
    for (std::size_t i = 0; i < count; ++i) build.orders[axis][i] = std::uint32_t(i);
    StopCheck check(job);
    std::ranges::sort(build.orders[axis], {}, [&](std::uint32_t i) {
      check();
      return std::pair(ellipsoids.lower[axis][i] + ellipsoids.upper[axis][i], i);
    });
  });
  taken_.assign(count, 0);
  if (sparse_.size() < count) sparse_.resize(count);
  const Part root = build.build(0, std::uint32_t(count), 0);
  finish(root, count);
  order.resize(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = {0, build.orders[0][i]};
}

}  // namespace isophote::photon_bvh

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/photon_clusters/clusters.h"
#include "stages/photon_clusters/photon_clusters.h"

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote::photon_clusters {

inline constexpr std::uint32_t kNodeWidth = 32;
inline constexpr int kKeyBits = 5;  ///< Of a key, for each level.

/// The nodes of one level, one array a component so that a photon meets 32 of them in one loop.
struct Level {
  std::vector<float> lowerX, lowerY, lowerZ, upperX, upperY, upperZ;
  std::vector<float> axisX, axisY, axisZ;  ///< Of the cone of normals.
  /// A photon whose direction has a cosine with the axis below -reject meets only backs, one above accept
  /// only fronts; 2: none does.
  std::vector<float> reject, accept;
  std::vector<std::uint32_t> firstChild;  ///< In the level below; for clusters their own place.
  std::vector<std::uint32_t> childMask;   ///< Bit i: the child whose key ends in i exists.
  std::vector<std::uint32_t> parent;      ///< In the level above; unset in the top level.
  std::vector<std::uint32_t> samples;     ///< View samples below.
  /// 1: a photon that encloses the node without being accepted goes on to its children, some of which may.
  std::vector<std::uint8_t> divides;
  std::vector<vec3> power;              ///< Accepted by the node as a whole: irradiance [W/m^2].
  std::vector<std::uint32_t> accepted;  ///< Photons in it.

  std::size_t size() const { return childMask.size(); }
  std::uint32_t childCount(std::size_t node) const { return std::uint32_t(std::popcount(childMask[node])); }
  void resize(std::size_t nodes);
};

/// What a photon's sphere does to up to 32 neighbours of a level, a bit each.
struct NodeHits {
  std::uint32_t touched;   ///< May reach a sample in it that faces it.
  std::uint32_t enclosed;  ///< Of them, those whose samples all lie within the sphere.
  std::uint32_t accepted;  ///< Of them, those whose samples all feel the photon alike.
};
using HitFn = void (*)(const Level& level, std::uint32_t first, std::uint32_t count,
                       const PhotonSphere& photon, NodeHits& hits);
HitFn hitFor(SimdLevel level);

/// The hierarchy over clusters: each level groups the nodes of the one below whose keys differ in the last
/// five bits alone, until 32 or fewer are left.
class ClusterTree {
 public:
  /// Reuses memory.
  void build(const std::vector<Cluster>& clusters, bool cone, TrivialAccept trivial);

  /// levels()[0] are the clusters, in their order; the last is the top. Empty without clusters.
  std::span<Level> levels() { return {levels_.data(), used_}; }
  std::span<const Level> levels() const { return {levels_.data(), used_}; }
  std::uint64_t bytes() const;

  /// Calls enclosed(level, node, accepted) for nodes that lie within the sphere, and touched(level, node) for
  /// other nodes of level `stop` that it may reach, from `count` nodes of `level` on down. Where a node does
  /// not accept the photon and a child may, the walk goes on: reading a list at every sample of a node costs
  /// more than that.
  template <class Enclosed, class Touched>
  void descend(HitFn hit, const PhotonSphere& photon, std::size_t level, std::uint32_t first,
               std::uint32_t count, std::size_t stop, Enclosed&& enclosed, Touched&& touched) const {
    const Level& nodes = levels_[level];
    NodeHits hits;
    hit(nodes, first, count, photon, hits);
    const auto forEach = [first](std::uint32_t bits, auto&& visit) {
      for (; bits != 0; bits &= bits - 1) visit(first + std::uint32_t(std::countr_zero(bits)));
    };
    // One kind after the other, so that the processor foresees where they go.
    const std::uint32_t held = hits.touched & hits.enclosed;
    std::uint32_t goesOn = hits.touched & ~held;
    forEach(held & hits.accepted, [&](std::uint32_t node) { enclosed(level, node, true); });
    forEach(held & ~hits.accepted, [&](std::uint32_t node) {
      if (level == 0 || nodes.divides[node] == 0)
        enclosed(level, node, false);
      else
        goesOn |= 1u << (node - first);
    });
    forEach(goesOn, [&](std::uint32_t node) {
      if (level == stop)
        touched(level, node);
      else
        descend(hit, photon, level - 1, nodes.firstChild[node], nodes.childCount(node), stop, enclosed,
                touched);
    });
  }

  /// Adds to each node's accepted power that of all nodes above it.
  void spreadPower();

 private:
  void buildClusters(const std::vector<Cluster>& clusters, TrivialAccept trivial);
  void buildAbove(std::size_t below);
  void setThresholds(Level& level, bool cone, TrivialAccept trivial) const;

  std::vector<Level> levels_;
  std::size_t used_ = 0;
  // Of the level that was built last, and of the one below it.
  std::vector<std::uint64_t> keys_, keysBelow_;
  std::vector<Cone> cones_, conesBelow_;
  std::vector<std::uint8_t> kinds_, kindsBelow_;
};

}  // namespace isophote::photon_clusters

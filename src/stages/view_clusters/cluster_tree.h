// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/view_clusters/clusters.h"

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote::view_clusters {

inline constexpr std::uint32_t kNodeWidth = 32;
inline constexpr int kKeyBits = 5;  ///< Of a key, for each level.

/// Surfaces that feel every photon on their front alike, so that a node of them may accept one as a whole.
/// kAll: wherever, and no node above the clusters keeps what it does not accept.
enum class Alike { kNone, kFlatDiffuse, kDiffuse, kAll };

struct Node {
  Bounds bounds;
  vec3 axis{0.0f};  ///< Of the cone of normals.
  /// A photon whose direction has a cosine with the axis below -reject meets only backs, one above accept
  /// only fronts; 2: none does.
  float reject = 2, accept = 2;
  std::uint32_t firstChild = 0;  ///< In the level below; for clusters their own place.
  std::uint32_t childMask = 0;   ///< Bit i: the child whose key ends in i exists.
  std::uint32_t parent = 0;      ///< In the level above; unset in the top level.
  std::uint32_t samples = 0;     ///< View samples below.
  /// 1: a photon that encloses the node without being accepted goes on to its children, some of which may.
  std::uint32_t divides = 0;

  std::uint32_t childCount() const { return std::uint32_t(std::popcount(childMask)); }
};

/// The nodes of one level.
struct Level {
  std::vector<Node> nodes;
  std::vector<std::uint64_t> keys;
  std::vector<Cone> cones;
  std::vector<std::uint8_t> kinds;  ///< What all clusters below a node have in common.

  /// Whether light from behind counts at some sample of a node.
  bool transmits(std::size_t node) const;
  std::size_t size() const { return nodes.size(); }
  void resize(std::size_t count);
};

/// The hierarchy over clusters: each level groups the nodes of the one below whose keys differ in the last
/// five bits alone, until 32 or fewer are left.
class ClusterTree {
 public:
  /// Reuses memory.
  void build(const Clusters& clusters, bool cone, Alike alike);

  /// levels()[0] are the clusters, in their order; the last is the top. Empty without clusters.
  std::span<const Level> levels() const { return {levels_.data(), used_}; }
  std::uint64_t bytes() const;

 private:
  void buildClusters(const Clusters& clusters, bool cone, Alike alike);
  void buildAbove(std::size_t below, bool cone, Alike alike);

  std::vector<Level> levels_;
  std::size_t used_ = 0;
};

}  // namespace isophote::view_clusters

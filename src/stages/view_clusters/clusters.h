// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_estimate/sphere_loops.h"
#include "stages/view_clusters/cluster_size.h"

#include <cmath>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote::view_clusters {

/// Directions of normals: all within `angle` of `axis`.
struct Cone {
  vec3 axis{0, 0, 1};
  float angle = 4.0f;  ///< [radians]; more than a quarter of a turn says nothing.
};

/// The narrowest cone around the mean of the cones' axes that holds them all; coneAt(i) is one of `count`.
template <class ConeAt>
Cone coneAround(std::size_t count, ConeAt&& coneAt) {
  vec3 sum(0.0f);
  for (std::size_t i = 0; i < count; ++i) sum += coneAt(i).axis;
  Cone all{sum * inversesqrt(max(dot(sum, sum), 1e-20f)), 0.0f};
  for (std::size_t i = 0; i < count; ++i) {
    const Cone& one = coneAt(i);
    all.angle = max(all.angle, one.angle + std::acos(clamp(dot(all.axis, one.axis), -1.0f, 1.0f)));
  }
  return all;
}

/// The view samples that one cell of the view frustum, or a run of secondary tiles, has in one tile.
struct Patch {
  std::uint64_t key;    ///< Of the cell. Nodes of the tree share its upper bits.
  std::uint64_t lanes;  ///< Bit i is set where lane i of the tile belongs to it.
  std::uint32_t tile;
  photon_estimate::SphereLoopKind kind;
  Bounds bounds;
  Cone cone;  ///< Of the geometric normals.
};

/// The patches of one cell: a leaf of the tree.
struct Cluster {
  std::uint64_t key;
  std::uint32_t firstPatch;
  std::uint32_t patches;
};

/// Finds the clusters of a view.
class Clusters {
 public:
  /// Reuses memory. `cellDepth` is the depth of a cell over its width. `byFace` parts each cell further by
  /// which of the six faces of a cube its geometric normals point through, and the tree above likewise, so
  /// that cones of normals are narrow and corners are not one surface.
  void build(const ViewSamples& view, ClusterSize size, float cellDepth, SimdLevel simd, bool byFace = false);

  /// All patches, cluster by cluster.
  const std::vector<Patch>& patches() const { return patches_; }
  /// In ascending order of their keys, which differ.
  const std::vector<Cluster>& all() const { return clusters_; }
  std::span<const Patch> patchesOf(std::size_t cluster) const {
    return {patches_.data() + clusters_[cluster].firstPatch, clusters_[cluster].patches};
  }
  std::uint64_t bytes() const { return clusters_.size() * sizeof(Cluster) + patches_.size() * sizeof(Patch); }

 private:
  /// Where a patch was found.
  struct Found {
    std::uint64_t key;
    std::uint32_t chunk, place;
    auto operator<=>(const Found&) const = default;
  };
  void sortPatches();

  std::vector<std::vector<Patch>> chunks_;  ///< As found, tile by tile.
  std::vector<std::size_t> chunkBegin_;
  std::vector<Found> order_;
  std::vector<Patch> patches_;
  std::vector<Cluster> clusters_;
};

}  // namespace isophote::view_clusters

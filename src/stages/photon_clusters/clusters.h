// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_estimate/sphere_loops.h"

#include <cstdint>
#include <vector>

namespace isophote::photon_clusters {

/// Directions of normals: all within `angle` of `axis`.
struct Cone {
  vec3 axis{0, 0, 1};
  float angle = 4.0f;  ///< [radians]; more than a quarter of a turn says nothing.
};

/// The view samples of one cell of the view frustum, or of one secondary tile.
struct Cluster {
  std::uint64_t key;    ///< Nodes of the tree share its upper bits.
  std::uint64_t lanes;  ///< Bit i is set where lane i of the tile belongs to it.
  std::uint32_t tile;
  photon_estimate::SphereLoopKind kind;
  Bounds bounds;
  Cone cone;  ///< Of the geometric normals.
};

/// Finds the clusters of a view.
class Clusters {
 public:
  /// In ascending order of their keys; reuses memory. `cellDepth` is the depth of a cell over its width.
  void build(const ViewSamples& view, float cellDepth, SimdLevel simd);
  const std::vector<Cluster>& all() const { return clusters_; }

 private:
  std::vector<Cluster> clusters_;
  std::vector<std::vector<Cluster>> chunks_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;  ///< Key, and place before sorting.
  std::vector<Cluster> unsorted_;
};

}  // namespace isophote::photon_clusters

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_clusters/clusters.h"

namespace isophote::photon_clusters {

/// The samples of a cluster as the loops want them: side by side in the first lanes of a tile, the last group
/// of lanes filled up with samples that no photon reaches. A cluster that is all of its tile is not copied.
class PackedSamples {
 public:
  void pack(const Cluster& cluster, const ViewTile& tile);

  const ViewTile& tile() const { return *tile_; }
  /// To be summed up; 0 after pack().
  RadianceTile& sums() { return sums_; }
  int lanes() const { return lanes_; }
  /// Adds the sums to the lanes that they belong to.
  void addTo(RadianceTile& out) const;

 private:
  const ViewTile* tile_ = nullptr;
  int lanes_ = 0;  ///< A multiple of kGroupLanes.
  int count_ = 0;
  std::uint8_t from_[kTileLanes];  ///< Lane of the cluster's tile.
  ViewTile copy_;
  RadianceTile sums_;
};

}  // namespace isophote::photon_clusters

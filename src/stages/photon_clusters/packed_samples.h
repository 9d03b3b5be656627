// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_clusters/clusters.h"

namespace isophote::photon_clusters {

/// The samples of a patch as the loops want them: side by side in the first lanes of a tile, the last group
/// of lanes filled up with samples that no photon reaches. A patch that is all of its tile is not copied.
class PackedSamples {
 public:
  /// For loops of `kind`. The sums start from `power`, which every sample feels alike: irradiance [W/m^2], 0
  /// unless the patch is Lambertian.
  void pack(const Patch& patch, photon_estimate::SphereLoopKind kind, const ViewTile& tile, vec3 power);

  const ViewTile& tile() const { return *tile_; }
  /// To be summed up: irradiance where the patch is Lambertian, else radiance.
  RadianceTile& sums() { return sums_; }
  int lanes() const { return lanes_; }
  /// Adds the radiance to the lanes that it belongs to.
  void addTo(RadianceTile& out) const;

 private:
  const ViewTile* original_ = nullptr;
  const ViewTile* tile_ = nullptr;
  bool lambertian_ = false;
  int lanes_ = 0;  ///< A multiple of kGroupLanes.
  int count_ = 0;
  std::uint8_t from_[kTileLanes];  ///< Lane of the patch's tile.
  ViewTile copy_;
  RadianceTile sums_;
};

}  // namespace isophote::photon_clusters

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_estimate/sphere_loops.h"

#include <cstdint>

namespace isophote::photon_estimate {

/// Some samples of a tile as the loops want them: side by side in the first lanes of a tile, the last group
/// of lanes filled up with samples that no photon reaches. All samples of a tile are not copied.
class PackedSamples {
 public:
  /// Those whose bits are set in `lanes`, for loops of `kind`. Of a tile that transmits they keep their
  /// lanes. The sums start from `power`, which every sample feels alike: irradiance [W/m^2], 0 unless the
  /// tile is Lambertian.
  void pack(const ViewTile& tile, std::uint64_t lanes, SphereLoopKind kind, vec3 power = vec3(0.0f));

  const ViewTile& tile() const { return *tile_; }
  /// To be summed up: irradiance where the tile is Lambertian, else radiance.
  RadianceTile& sums() { return sums_; }
  int lanes() const { return lanes_; }
  /// Adds the sums to the lanes that they belong to.
  void addTo(RadianceTile& out) const;
  /// The same as radiance, whatever they are.
  void addRadianceTo(RadianceTile& out) const;

 private:
  const ViewTile* original_ = nullptr;
  const ViewTile* tile_ = nullptr;
  bool lambertian_ = false;
  int lanes_ = 0;  ///< A multiple of kGroupLanes.
  int count_ = 0;
  std::uint8_t from_[kTileLanes];  ///< Lane of the original tile.
  ViewTile copy_;
  RadianceTile sums_;
};

}  // namespace isophote::photon_estimate

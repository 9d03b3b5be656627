// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_estimate/photon_loops.h"

#include <cstdint>

namespace isophote::photon_bvh {

/// Some samples of a tile as the loops want them: side by side in the first lanes of a tile, the last group
/// of lanes filled up with samples that no photon reaches. All samples of a tile are not copied.
class PackedLanes {
 public:
  /// Those whose bits are set in `lanes`. Of a tile that transmits they keep their lanes.
  void pack(const ViewTile& tile, std::uint64_t lanes);

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
  std::uint8_t from_[kTileLanes];  ///< Lane of the tile.
  ViewTile copy_;
  RadianceTile sums_;
};

}  // namespace isophote::photon_bvh

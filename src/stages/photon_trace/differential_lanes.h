// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_trace/hit_lanes.h"
#include "stages/photon_trace/path_differential.h"

#include <cstdint>
#include <span>

namespace isophote {

/// The differentials of the photons of HitLanes: arrive() after HitLanes::arrive(), leave() after
/// HitLanes::scatter(). Curvature that comes from normal maps is left out: mirrors and glass bend neighbours
/// by their vertices' normals alone.
class DifferentialLanes {
 public:
  /// Follows `bySlot` to the surfaces. photonsOfLight: emitted by each light.
  void arrive(const HitLanes& hits, const PathColumns& paths, const PathDifferential* bySlot,
              std::span<const float> photonsOfLight);
  /// Of the photon that arrived in that lane, before leave().
  PhotonFootprint footprint(const HitLanes& hits, std::uint32_t lane) const;
  /// Turns what arrived into what goes on from the surfaces.
  void leave(const HitLanes& hits);
  PathDifferential leaving(std::uint32_t lane) const { return {at(lane), scattered_[lane]}; }

 private:
  friend struct DifferentialLoops;

  SHARED_FN PhotonDifferential at(std::uint32_t i) const {
    return {positionX_[i], positionY_[i], directionX_[i], directionY_[i]};
  }
  SHARED_FN void set(std::uint32_t i, const PhotonDifferential& d) {
    positionX_.set(i, d.positionX);
    positionY_.set(i, d.positionY);
    directionX_.set(i, d.directionX);
    directionY_.set(i, d.directionY);
  }
  void leaveByDelta(const HitLanes& hits, std::uint32_t lane, const Bsdf& bsdf, std::uint32_t lobe);

  HitVectors positionX_, positionY_, directionX_, directionY_;
  HitColumn<float> way_;      ///< From where the photon left to here [m].
  HitColumn<float> photons_;  ///< Emitted by its light.
  HitColumn<std::uint32_t> scattered_;
  HitColumn<std::uint32_t> lobe_;
};

}  // namespace isophote

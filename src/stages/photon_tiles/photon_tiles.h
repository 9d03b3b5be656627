// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_trace/photon_map.h"

#include <memory>

namespace isophote {

struct PhotonTilesSettings {
  float radius = 0;

  void visit(auto&& v) {
    v("radius", radius,
      {.help = "Radius in which a photon is felt, the same for all; 0: automatic.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
  }
};

/// Radiance estimate by tiles (Mara et al. 2013, as VSCH measures itself against it): photons of one radius
/// go to the lists of the screen's tiles of 32 x 32 pixels whose frustum, cut at the tile's nearest and
/// farthest sample, they touch; every view sample tests all photons of its tile. Kernel 1 / (pi r^2), full
/// BSDF. What is seen in mirrors and through glass goes into tiles of up to 1024 samples by its bounds in the
/// world.
///
/// Photons count as in PhotonVolumes. The same bytes come out at any number of threads and any instruction
/// set.
class PhotonTiles {
 public:
  struct In {
    const ViewSamples& view;
    const PhotonMap& map;
    float radius;  ///< Resolved: settings.radius, or the automatic one [m].
    SimdLevel simd = bestSimdLevel();
  };

  explicit PhotonTiles(PhotonTilesSettings settings);
  ~PhotonTiles();
  PhotonTiles(PhotonTiles&&) noexcept;
  PhotonTiles& operator=(PhotonTiles&&) noexcept;

  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused. Lists that would take more than a part
  /// of the memory budget are made and worked off in several sub-passes over the photons. Stats: counters
  /// photon_tiles.pairsTested (pairs of a view sample and a photon of its tile's list), .pairsRejected (of
  /// them, farther apart than the radius), .pairsContributing (where the photon adds light), .listEntries,
  /// .subPasses.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  PhotonTilesSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

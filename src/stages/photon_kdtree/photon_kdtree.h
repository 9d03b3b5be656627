// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_trace/photon_map.h"

namespace isophote {

struct PhotonKdtreeSettings {
  std::uint32_t nearest = 100;
  float radius = 0;

  void visit(auto&& v) {
    v("nearest", nearest,
      {.help = "Photons an estimate gathers (k nearest); 0: all within `radius`.", .min = 0, .max = 65536});
    v("radius", radius,
      {.help = "Largest gathering radius, or the radius when `nearest` is 0; 0: automatic.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
  }
};

/// The classic radiance estimate (Jensen 1996): at each view sample, the k nearest photons, or all within a
/// fixed radius, found in a kd-tree, over the area of the disc that holds them. Photons on the back side
/// neither contribute nor count.
class PhotonKdtree {
 public:
  struct In {
    const ViewSamples& view;
    const PhotonMap& map;
    float radius;  ///< Resolved: settings.radius, or the automatic one [m].
  };

  explicit PhotonKdtree(PhotonKdtreeSettings settings) : settings_(settings) {}
  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {}) const;

 private:
  PhotonKdtreeSettings settings_;
};

}  // namespace isophote

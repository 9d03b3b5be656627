// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_estimate/kernel.h"
#include "stages/photon_trace/photon_map.h"

#include <memory>

namespace isophote {

struct PhotonVolumesSettings {
  float radius = 0;
  float densityReference = 5e-4f;
  float radiusMin = 0.5f;
  float radiusMax = 1.5f;
  float flatness = 0.8f;
  Kernel kernel = Kernel::kEpanechnikov;

  void visit(auto&& v) {
    v("radius", radius,
      {.help = "Radius of a photon whose path density is densityReference; 0: automatic.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("densityReference", densityReference,
      {.help = "Path density at which a photon has the radius `radius`; rarer paths get a larger one.",
       .min = 1e-12,
       .max = 1e6});
    v("radiusMin", radiusMin, {.help = "Smallest radius, as a multiple of `radius`.", .min = 1e-3, .max = 1});
    v("radiusMax", radiusMax, {.help = "Largest radius, as a multiple of `radius`.", .min = 1, .max = 1e3});
    v("flatness", flatness,
      {.help = "Height of a photon's ellipsoid over its radius; small values leak less around corners.",
       .min = 0.01,
       .max = 1});
    v("kernel", kernel, {.help = "Weight of a photon over its ellipsoid."});
  }
};

/// Radiance estimate by scattering (ISPM 5): every photon adds its power, weighted by a kernel over a
/// flattened ellipsoid and the full BSDF, to every view sample inside the ellipsoid. On the CPU, photons are
/// binned to the tiles whose view samples they can reach, through a tree over the tiles' bounds that follows
/// the screen, and each tile loops over its photons.
///
/// A photon counts where it arrives on the eye's side of the geometric surface. What is stored is flux per
/// area, which already holds the cosine of arrival, so no other one is multiplied in. The same bytes come out
/// at any number of threads, any memory budget and any instruction set.
class PhotonVolumes {
 public:
  struct In {
    const ViewSamples& view;
    const PhotonMap& map;
    float radius;  ///< Resolved: settings.radius, or the automatic one [m].
    SimdLevel simd = bestSimdLevel();
  };

  explicit PhotonVolumes(PhotonVolumesSettings settings);
  ~PhotonVolumes();
  PhotonVolumes(PhotonVolumes&&) noexcept;
  PhotonVolumes& operator=(PhotonVolumes&&) noexcept;

  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused, also that of lists between runs.
  /// Stats: counters photon_volumes.pairsTested (pairs of a photon and a view sample on a tile's list) and
  /// .pairsContributing (of them, where the photon adds light), bytes of volumes and lists.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  PhotonVolumesSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

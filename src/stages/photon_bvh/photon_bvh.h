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

/// How the hierarchy over the photons is split.
enum class PhotonSplit : std::uint32_t { kMorton, kVolume };
template <>
struct EnumNames<PhotonSplit> {
  static constexpr std::array names{"morton", "volume"};
};

struct PhotonBvhSettings {
  float radius = 0;
  float smoothing = 0;
  float smoothingCaustic = 10;
  float compression = 0.75f;
  float referenceLength = 1;
  float radiusMin = 0;
  float radiusMax = 0;
  float flatness = 1;
  Kernel kernel = Kernel::kEpanechnikov;
  PhotonSplit split = PhotonSplit::kMorton;
  std::uint32_t leafPhotons = 0;

  void visit(auto&& v) {
    v("radius", radius,
      {.help =
           "Middle radius of the footprints of diffusely scattered photons, which sets their smoothing; 0: "
           "by `smoothing`.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("smoothing", smoothing,
      {.help = "Footprints of diffusely scattered photons, in spacings of photons; 0: automatic.",
       .min = 0,
       .max = 1e6});
    v("smoothingCaustic", smoothingCaustic,
      {.help =
           "The same of photons that only mirrors, refraction and glossy surfaces have turned: small values "
           "keep caustics sharp.",
       .min = 1e-3,
       .max = 1e6});
    v("compression", compression,
      {.help =
           "How far sizes of footprints are drawn together: those of scattered photons grow with the power 1 "
           "- compression of their spacing.",
       .min = 0,
       .max = 1});
    v("referenceLength", referenceLength,
      {.help = "Unit of the lengths that are compressed; where `smoothing` is automatic, it changes nothing.",
       .unit = "m",
       .min = 1e-6,
       .max = 1e6});
    v("radiusMin", radiusMin,
      {.help = "Smallest semi-axis of a footprint; 0: a twentieth of the middle radius.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("radiusMax", radiusMax,
      {.help = "Largest semi-axis of a footprint; 0: four times the middle radius.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("flatness", flatness,
      {.help = "Height of a photon's ellipsoid over its smaller semi-axis.", .min = 0.01, .max = 10});
    v("kernel", kernel, {.help = "Weight of a photon over its footprint."});
    v("split", split,
      {.help =
           "Hierarchy over the photons: by their places along a Morton curve, which is quick to build, or by "
           "least volume times photons of the halves, which is a little quicker to ask."});
    v("leafPhotons", leafPhotons,
      {.help = "Photons at which nothing is split any more; 0: automatic, in proportion to the area of all "
               "footprints over that of all surfaces.",
       .min = 0,
       .max = 65536});
  }
};

/// Radiance estimate by photon differentials (IGPM): every photon has a footprint of its own, an ellipsoid
/// over the ellipse that its neighbours span (physics/photon_differential.shared.h), and counts at every view
/// sample in it. A hierarchy of boxes around the ellipsoids is asked once for each tile of view samples; the
/// photons that it finds are held against all samples of the tile.
///
/// Photons count as in PhotonVolumes. The same bytes come out at any number of threads and any instruction
/// set.
class PhotonBvh {
 public:
  struct In {
    const ViewSamples& view;
    const PhotonMap& map;    ///< With footprints.
    float radius;            ///< Resolved: middle radius of scattered photons [m].
    float shrink = 1;        ///< Of this pass against the first, for all that `radius` does not scale.
    double surfaceArea = 1;  ///< Of the scene [m^2].
    SimdLevel simd = bestSimdLevel();
  };

  explicit PhotonBvh(PhotonBvhSettings settings);
  ~PhotonBvh();
  PhotonBvh(PhotonBvh&&) noexcept;
  PhotonBvh& operator=(PhotonBvh&&) noexcept;

  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused. Stats: stages photon_bvh.build and
  /// photon_bvh; counters (of photon_bvh.) smoothing, leafPhotons, nodes, pairsTested (pairs of a photon and
  /// a lane of a group of samples), pairsContributing (of them, where the photon adds light).
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  PhotonBvhSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

/// The middle radius that a smoothing factor gives the scattered photons of a map [m]; 0 where there are
/// none.
float middleRadius(const PhotonMap& map, const PhotonBvhSettings& settings, float smoothing);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_trace/photon_map.h"

#include <array>
#include <memory>

namespace isophote {

/// What an octant of directions counts at a view sample.
enum class OctantWeights : std::uint32_t { kPart, kPublished };
template <>
struct EnumNames<OctantWeights> {
  static constexpr std::array names{"part", "published"};
};

struct PhotonDirectionalSettings {
  float radius = 0;
  std::uint32_t cells = 60;
  float cellDepth = 1;
  std::uint32_t level = 0;
  OctantWeights weights = OctantWeights::kPart;

  void visit(auto&& v) {
    v("radius", radius,
      {.help = "Radius in which a photon is felt, the same for all; 0: automatic.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("cells", cells,
      {.help = "Cells of the view frustum across the picture, at least; samples of one share one sum of "
               "light. As many as come of the widest cells of 4, 8, 16 or 32 pixels.",
       .min = 1,
       .max = 16384});
    v("cellDepth", cellDepth,
      {.help = "Depth of a cell of the view frustum over its width.", .min = 0.25, .max = 1e6});
    v("level", level,
      {.help = "Sum up light for nodes so many levels above the cells instead, 32 children each: faster and "
               "coarser.",
       .min = 0,
       .max = 12});
    v("weights", weights,
      {.help = "What light from an octant of directions counts at a surface. part: as the part of it above "
               "the surface says, octants of the world; published: by twice the cosine with the octant's "
               "middle, octants of the view, which is 8 to 20 % too bright and changes as the camera "
               "turns."});
  }
};

/// Irradiance by directional flux (VSCH 4.7): photons go down the hierarchy over clusters of view samples, as
/// in PhotonClusters, but are added up at its leaves, into one sum for each octant of the directions that
/// they come from, instead of being read from lists by every view sample. Light is then the same all over a
/// cluster but for the normals: it wants to be smoothed (IrradianceBlur).
///
/// A leaf feels a photon as far as its samples lie within the photon's radius, which is told by the distance
/// of its middle, in a ramp as wide as the leaf, and as far as its cone of normals faces it. An octant's flux
/// is shared between the samples of a leaf by their geometric normals as light that is constant over the
/// octant would be, so that their mean is what arrived: exactly so on a flat leaf. Shading normals then scale
/// each octant likewise, by |cosine|; a photon's own factor cannot be applied.
///
/// Clusters are parted by the faces of a cube that their normals point through, so that walls of a corner do
/// not share their light.
class PhotonDirectional {
 public:
  struct In {
    const ViewSamples& view;
    const PhotonMap& map;
    float radius;  ///< Resolved: settings.radius, or the automatic one [m].
    SimdLevel simd = bestSimdLevel();
  };

  explicit PhotonDirectional(PhotonDirectionalSettings settings);
  ~PhotonDirectional();
  PhotonDirectional(PhotonDirectional&&) noexcept;
  PhotonDirectional& operator=(PhotonDirectional&&) noexcept;

  /// For in.view.tiles[i], both overwritten, memory reused: irradiance[i] at the geometric normals [W/m^2],
  /// and reflectance[i], what it is to be multiplied by to be radiance [1/sr]: the diffuse reflectance over
  /// pi, with what the shading normal changes. Glossy reflection counts as if it were diffuse, with the
  /// reflectance that a mirror in its place has; so does rough refraction, for the light from behind.
  /// Photons are worked off in several sub-passes where their lists would take more than a part of the
  /// memory budget. Stats: stages photon_directional.build, .shallow, photon_directional (sums at the
  /// leaves), .shade; counters (of photon_directional.) pairsTested (of a leaf and a photon),
  /// pairsContributing, pairsAccepted (of a node above and a photon that all its samples feel alike), nodes
  /// (by level, the clusters first), subPasses.
  void run(const In& in, Radiance& irradiance, Radiance& reflectance, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  PhotonDirectionalSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_quads/photon_quads.shared.h"
#include "stages/photon_trace/photon_map.h"

#include <array>
#include <cstdint>
#include <memory>

namespace isophote {

/// How light falls off over a quad.
enum class QuadFalloff : std::uint32_t {
  kConstant = kFalloffConstant,
  kEpanechnikov = kFalloffEpanechnikov,
  kQuartic = kFalloffQuartic,
};
template <>
struct EnumNames<QuadFalloff> {
  static constexpr std::array names{"constant", "epanechnikov", "quartic"};
};

struct PhotonQuadsSettings {
  float radius = 0;
  float densityReference = 5e-4f;
  float radiusMin = 0.5f;
  float radiusMax = 1.5f;
  QuadFalloff falloff = QuadFalloff::kEpanechnikov;
  float depth = 2;
  bool corners = true;
  float flatness = 1;

  void visit(auto&& v) {
    v("radius", radius,
      {.help = "Half the side of a photon's quad whose path density is densityReference; 0: automatic.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("densityReference", densityReference,
      {.help = "Path density at which a photon has the radius `radius`; rarer paths get a larger one.",
       .min = 1e-12,
       .max = 1e6});
    v("radiusMin", radiusMin, {.help = "Smallest radius, as a multiple of `radius`.", .min = 1e-3, .max = 1});
    v("radiusMax", radiusMax, {.help = "Largest radius, as a multiple of `radius`.", .min = 1, .max = 1e3});
    v("falloff", falloff, {.help = "How light falls off from the middle of a quad to its rim."});
    v("depth", depth,
      {.help = "How far before or behind its quad, along the line of sight, a photon is felt, over its "
               "radius; large values leak onto steps and past edges.",
       .min = 0.01,
       .max = 100});
    v("corners", corners,
      {.help = "Let volumes take over where the normals' weight fades a quad out, so that corners do not "
               "darken."});
    v("flatness", flatness,
      {.help = "Height of these volumes over their radius; 1: spheres.", .min = 0.01, .max = 1});
  }
};

/// Radiance estimate by photon quads (SSPM 3.3): every photon is a quad on the plane of its surface that
/// carries a round falloff. It adds its power to every view sample whose line of sight meets the quad near
/// the sample, weighted by the cosine between both surfaces' geometric normals; quads that turn their back to
/// the eye add nothing.
///
/// What the thesis leaves open or differs in: its quads have no depth, here they are felt up to `depth`
/// before and behind. Its photons have no direction and light Lambertian surfaces alone; these have one, and
/// meet the full BSDF, as PhotonVolumes', with the same rules for which photons count. What is seen in
/// mirrors and through glass is seen along the last segment of the eye's path, so quads serve it likewise.
///
/// Biased where surfaces bend: the part of a quad beyond a corner is lost, and light that its normals' weight
/// takes; `corners` gives it to the adjoining surface. Both vanish with the radius.
class PhotonQuads {
 public:
  struct In {
    const ViewSamples& view;
    const PhotonMap& map;
    float radius;  ///< Resolved: settings.radius, or the automatic one [m].
    SimdLevel simd = bestSimdLevel();
  };

  explicit PhotonQuads(PhotonQuadsSettings settings);
  ~PhotonQuads();
  PhotonQuads(PhotonQuads&&) noexcept;
  PhotonQuads& operator=(PhotonQuads&&) noexcept;

  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused. The same bytes come out at any number of
  /// threads, any memory budget and any instruction set. Stats: counters (of photon_quads.) culled (photons
  /// left out because no sample can see their quad's front), pairsTested (pairs of a photon and a view sample
  /// on a tile's list), pairsContributing (of them, where the photon adds light).
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  PhotonQuadsSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

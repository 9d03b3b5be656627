// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/differential_lanes.h"

#include "math/simd.h"

namespace isophote {

/// The loops over lanes, compiled for each instruction set.
struct DifferentialLoops {
  static SHARED_FN void arrive(DifferentialLanes& d, const HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i)
      d.set(i, arrivingDifferential(d.at(i), h.rayDirection_[i], d.way_[i], h.points.ng[i]));
  }

  /// The part of the photons that went on, by roulette and by what was absorbed.
  static SHARED_FN float survival(const HitLanes& h, std::uint32_t i) {
    return min(1.0f - h.absorbed[i] / max(h.mean[i], 1e-37f), 1.0f);
  }

  static SHARED_FN void leaveLambert(DifferentialLanes& d, const HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      const PhotonDifferential left = sparserDifferential(d.at(i), survival(h, i));
      d.set(i, scatteredDifferential(left, h.direction[i], photonSpacing(4.0f * kPi, d.photons_[i])));
      d.scattered_[i] = 1u;
    }
  }

  /// What goes on by that lobe, where it is none that sends all photons one way; those go on as they arrived,
  /// only sparser.
  static SHARED_FN PhotonDifferential leave(PhotonDifferential arrived, const Bsdf& b, vec3 wo, vec3 wi,
                                            vec3 ng, vec3 ns, float entering, float photons, float survival,
                                            float choice, std::uint32_t& lobe) {
    const vec4 p = lobeProbabilities(b, abs(dot(wo, ns)), entering);
    float rest;
    lobe = chooseLobe(b, p, choice, rest);
    const float rough = p.x + p.y;
    const float share = lobe == kLobeMirror ? p.z : lobe == kLobeRefract ? p.w : rough;
    const PhotonDifferential left = sparserDifferential(arrived, survival * share);
    const float pdf = pdfBsdf(b, wi, wo, ng, ns, entering) / max(rough, 1e-7f);
    const float spacing =
        lobe == kLobeDiffuse ? photonSpacing(4.0f * kPi, photons) : lobeSpacing(pdf, photons);
    const PhotonDifferential anew = scatteredDifferential(left, wi, spacing);
    const float delta = lobe == kLobeMirror || lobe == kLobeRefract ? 1.0f : 0.0f;
    PhotonDifferential result;
    result.positionX = mix(anew.positionX, left.positionX, delta);
    result.positionY = mix(anew.positionY, left.positionY, delta);
    result.directionX = mix(anew.directionX, left.directionX, delta);
    result.directionY = mix(anew.directionY, left.directionY, delta);
    return result;
  }

  static SHARED_FN void leaveOpaque(DifferentialLanes& d, const HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      std::uint32_t lobe;
      d.set(i, leave(d.at(i), h.opaqueBsdf(i), -h.rayDirection_[i], h.direction[i], h.points.ng[i],
                     h.points.ns[i], h.points.entering[i], d.photons_[i], survival(h, i), h.random_[0][i],
                     lobe));
      d.lobe_[i] = lobe;
    }
  }
};

namespace {

ISOPHOTE_SIMD(arriveLanes, DifferentialLoops::arrive, (DifferentialLanes & d, const HitLanes& h), (d, h))
ISOPHOTE_SIMD(leaveLambert, DifferentialLoops::leaveLambert, (DifferentialLanes & d, const HitLanes& h),
              (d, h))
ISOPHOTE_SIMD(leaveOpaque, DifferentialLoops::leaveOpaque, (DifferentialLanes & d, const HitLanes& h), (d, h))

/// Of the interpolated normal, on the side of arrival; 0 where the triangle has none.
vec3 stepOfNormal(const ShadedTriangle& t, float u, float v, float side, vec3 step) {
  if (t.normal[0] == kNoDirection) return vec3(0.0f);
  return side * normalStep(t.position[1] - t.position[0], t.position[2] - t.position[0],
                           unpackDirection(t.normal[0]), unpackDirection(t.normal[1]),
                           unpackDirection(t.normal[2]), u, v, step);
}

}  // namespace

void DifferentialLanes::arrive(const HitLanes& hits, const PathColumns& paths, const PathDifferential* bySlot,
                               std::span<const float> photonsOfLight) {
  for (std::uint32_t i = 0; i < hits.count; ++i) {
    const std::uint32_t slot = std::uint32_t(hits.slot_[i]);
    set(i, bySlot[slot].step);
    scattered_[i] = bySlot[slot].scattered;
    photons_[i] = photonsOfLight[hits.light[i]];
    way_[i] = dot(hits.points.position[i] - paths.origin[slot], hits.rayDirection_[i]);
  }
  arriveLanesFor(bestSimdLevel())(*this, hits);
}

PhotonFootprint DifferentialLanes::footprint(const HitLanes& hits, std::uint32_t i) const {
  // What blends is met by a part of the photons alone.
  const float sparser = sqrt(hits.storedShare[i]);
  PhotonFootprint f = photonFootprint(at(i), photonSpacing(4.0f * kPi, photons_[i]), scattered_[i]);
  f.axisX *= sparser;
  f.axisY *= sparser;
  return f;
}

void DifferentialLanes::leave(const HitLanes& hits) {
  const SimdLevel level = bestSimdLevel();
  if (hits.lambert_) {
    leaveLambertFor(level)(*this, hits);
    return;
  }
  const DifferentialLanes arrived = *this;
  leaveOpaqueFor(level)(*this, hits);
  for (std::uint32_t i = 0; i < hits.count; ++i) {
    const bool odd = (hits.odd_ >> i & 1u) != 0u;
    const Bsdf bsdf = odd ? hits.bsdf_[i] : hits.opaqueBsdf(i);
    if (odd)
      set(i,
          DifferentialLoops::leave(arrived.at(i), bsdf, -hits.rayDirection_[i], hits.direction[i],
                                   hits.points.ng[i], hits.points.ns[i], hits.points.entering[i], photons_[i],
                                   DifferentialLoops::survival(hits, i), hits.random_[0][i], lobe_[i]));
    if (lobe_[i] == kLobeDiffuse) scattered_[i] = 1u;
    if (lobe_[i] == kLobeMirror || lobe_[i] == kLobeRefract) leaveByDelta(hits, i, bsdf, lobe_[i]);
  }
}

/// Turns the steps of direction as a mirror or smooth refraction turns the photon.
void DifferentialLanes::leaveByDelta(const HitLanes& hits, std::uint32_t i, const Bsdf& bsdf,
                                     std::uint32_t lobe) {
  if (lobe == kLobeRefract && (bsdf.flags & kMaterialThinWalled) != 0u) return;
  const vec3 direction = hits.rayDirection_[i], leaving = hits.direction[i];
  const vec3 ng = hits.points.ng[i], ns = hits.points.ns[i];
  const ShadedTriangle triangle = hits.triangles_[i];
  const auto normalStepOf = [&](vec3 step) {
    return stepOfNormal(triangle, hits.points.u[i], hits.points.v[i], hits.points.side[i], step);
  };
  if (lobe == kLobeMirror) {
    // As mirrorDirection() has chosen.
    const bool shaded = dot(2.0f * dot(-direction, ns) * ns + direction, ng) > 0.0f;
    const vec3 n = shaded ? ns : ng;
    const float curved = shaded ? 1.0f : 0.0f;
    directionX_.set(i, mirroredStep(direction, directionX_[i], n, curved * normalStepOf(positionX_[i])));
    directionY_.set(i, mirroredStep(direction, directionY_[i], n, curved * normalStepOf(positionY_[i])));
    return;
  }
  const float eta = hits.points.entering[i] > 0.5f ? bsdf.ior : 1.0f / bsdf.ior;
  // As refractionOf() has chosen.
  const bool shaded = dot(refractDirection(-direction, ns, eta), ng) < 0.0f;
  const vec3 n = shaded ? ns : ng;
  const float curved = shaded ? 1.0f : 0.0f;
  directionX_.set(
      i, refractedStep(direction, directionX_[i], leaving, n, curved * normalStepOf(positionX_[i]), eta));
  directionY_.set(
      i, refractedStep(direction, directionY_[i], leaving, n, curved * normalStepOf(positionY_[i]), eta));
}

}  // namespace isophote

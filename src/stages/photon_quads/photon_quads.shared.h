// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// A photon as a quad on the plane of its surface.
#ifndef ISOPHOTE_STAGES_PHOTON_QUADS_SHARED_H
#define ISOPHOTE_STAGES_PHOTON_QUADS_SHARED_H

#include "physics/photon.shared.h"

SHARED_BEGIN

/// The round picture of how light falls off over a quad, unpacked for the inner loop together with the
/// ellipsoid that stands in for it in corners. 64 bytes.
struct PhotonQuad {
  vec3 position;
  float inverseRadius2;  ///< 1 / r^2 [1/m^2]
  vec3 normal;           ///< Geometric normal of the surface hit, on the side of arrival.
  float inverseDepth2;   ///< 1 / depth^2: how far before or behind it along the line of sight it is felt.
  vec3 direction;        ///< Towards where the photon came from.
  float normalTerm;      ///< PhotonVolume::normalTerm of the ellipsoid.
  vec3 weightedPower;    ///< Power times the falloff's normalisation [W/m^2].
  uint sight;            ///< Where the eye is, as photonSight() packs it; kNoSight where it does not matter.
};

/// No line of sight packs to this.
SHARED_CONST uint kNoSight = 0xffffffffu;

/// The lines along which the eye sees what lies around a photon, packed.
struct PhotonSight {
  vec3 direction;  ///< Towards the eye, unit.
  float spread;    ///< Sine of the largest angle between it and a line of sight to the quad.
};

/// Packed with the direction's four lowest bits of either coordinate given to the spread, which is rounded up
/// and holds the rounding of both. kNoSight where lines of sight are spread too far to tell much.
SHARED_FN uint photonSight(PhotonSight s) {
  uint spread = uint(min((s.spread + 2e-3f) * 254.0f, 254.0f)) + 1u;
  if (spread > 254u) return kNoSight;
  return (packDirection(s.direction) & 0xfff0fff0u) | (spread & 15u) | ((spread >> 4u) << 16u);
}

SHARED_FN PhotonSight unpackSight(uint bits) {
  PhotonSight s;
  s.direction = unpackDirection(bits & 0xfff0fff0u);
  s.spread = float((bits & 15u) | ((bits >> 16u) & 15u) << 4u) * (1.0f / 254.0f);
  return s;
}

SHARED_CONST uint kFalloffConstant = 0u;      ///< 1 inside.
SHARED_CONST uint kFalloffEpanechnikov = 1u;  ///< 1 - t^2.
SHARED_CONST uint kFalloffQuartic = 2u;       ///< (1 - t^2)^2.

// By arithmetic where a comparison would do: loops that decide by several do not vectorise.

/// Falloff at squared distance t2 in units of the radius: 0 from the rim on.
SHARED_FN float falloffValue(uint falloff, float t2) {
  float inside = max(1.0f - t2, 0.0f);
  float steepness = falloff == kFalloffConstant ? 1e30f : 1.0f;
  float squares = falloff == kFalloffQuartic ? 1.0f : 0.0f;
  return min(inside * steepness, 1.0f) * (1.0f + (inside - 1.0f) * squares);
}

/// What makes its integral over the quad's plane 1 [1/m^2].
SHARED_FN float falloffNormalisation(uint falloff, float radius) {
  return (float(falloff) + 1.0f) * kInvPi / (radius * radius);
}

/// Squared distance from the photon to where the line of sight through a surface meets its plane, in units of
/// its radius, and to that the squared distance along the line in units of its depth, which keeps surfaces
/// before and behind the plane out. wo: unit, towards the eye.
SHARED_FN float quadDistance2(PhotonQuad p, vec3 position, vec3 wo) {
  vec3 d = position - p.position;
  float facing = dot(wo, p.normal);
  float along = dot(d, p.normal) * facing / max(facing * facing, 1e-12f);
  vec3 onPlane = d - wo * along;
  return dot(onPlane, onPlane) * p.inverseRadius2 + along * along * p.inverseDepth2;
}

/// Weight of the normals (SSPM eq. 1): 1 where the surface lies in the quad's plane, 0 from a right angle on
/// and where the quad turns its back to the eye. Both normals are geometric ones, so that it costs no light
/// on surfaces whose shading normals vary, and tends to 1 as quads shrink.
SHARED_FN float quadNormalWeight(PhotonQuad p, vec3 wo, vec3 ng) {
  float seen = clamp(dot(wo, p.normal) * 1e30f, 0.0f, 1.0f);
  return seen * clamp(dot(p.normal, ng), 0.0f, 1.0f);
}

/// How strongly a photon is felt, its falloff's normalisation not multiplied in.
SHARED_FN float quadFelt(PhotonQuad p, uint falloff, vec3 position, vec3 wo, vec3 ng) {
  return falloffValue(falloff, quadDistance2(p, position, wo)) * quadNormalWeight(p, wo, ng);
}
/// The same on surfaces through which light goes: from both sides.
SHARED_FN float quadFeltBothSides(PhotonQuad p, uint falloff, vec3 position, vec3 wo, vec3 ng) {
  return falloffValue(falloff, quadDistance2(p, position, wo)) * abs(dot(p.normal, ng));
}

/// As PhotonVolume's ellipsoidDistance2.
SHARED_FN float cornerDistance2(PhotonQuad p, vec3 position) {
  vec3 d = position - p.position;
  float along = dot(d, p.normal);
  return dot(d, d) * p.inverseRadius2 + along * along * p.normalTerm;
}

/// Quads, and in corners volumes: these take what the weight of the normals leaves of the quad.
SHARED_FN float quadFeltWithCorners(PhotonQuad p, uint falloff, vec3 position, vec3 wo, vec3 ng) {
  float weight = quadNormalWeight(p, wo, ng);
  return falloffValue(falloff, quadDistance2(p, position, wo)) * weight +
         falloffValue(falloff, cornerDistance2(p, position)) * (1.0f - weight);
}

/// depth: as a multiple of the radius; flatness: height / radius of the ellipsoid in corners, in (0, 1].
SHARED_FN PhotonQuad photonQuad(Photon p, uint falloff, float radius, float depth, float flatness) {
  PhotonQuad q;
  q.position = p.position;
  q.inverseRadius2 = 1.0f / (radius * radius);
  q.normal = unpackDirection(p.normal);
  q.inverseDepth2 = q.inverseRadius2 / (depth * depth);
  q.direction = unpackDirection(p.direction);
  q.normalTerm = (1.0f / (flatness * flatness) - 1.0f) * q.inverseRadius2;
  q.weightedPower = p.power * falloffNormalisation(falloff, radius);
  q.sight = kNoSight;
  return q;
}

SHARED_END

#endif

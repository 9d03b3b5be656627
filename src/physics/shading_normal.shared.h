// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Shading normals: from normal maps, with tangents in one word, and what their differing from the geometric
// normal does to light.
#ifndef ISOPHOTE_PHYSICS_SHADING_NORMAL_SHARED_H
#define ISOPHOTE_PHYSICS_SHADING_NORMAL_SHARED_H

#include "math/sampling.shared.h"
#include "math/shared.h"

SHARED_BEGIN

/// Least cosine between the geometric normal and one bent by a normal map: what is bent further counts as
/// bent so far, so that it stays above the surface.
SHARED_CONST float kLeastNormalCosine = 0.02f;
SHARED_CONST uint kTangentSign = 0x10000u;

/// Packs a unit tangent and the side of its bitangent, cross(normal, tangent) * sign, into one word; the
/// error is at most 1.3e-4 radians.
SHARED_FN uint packTangent(vec3 tangent, float sign) {
  uint bits = packDirection(tangent) & ~kTangentSign;
  return sign < 0.0f ? bits | kTangentSign : bits;
}

SHARED_FN vec3 unpackTangent(uint bits) { return unpackDirection(bits & ~kTangentSign); }

SHARED_FN float tangentSign(uint bits) { return (bits & kTangentSign) != 0u ? -1.0f : 1.0f; }

/// Bends the shading normal ns, on the side of ng, as a normal map says. texel: its colour mapped to [-1, 1],
/// x along the tangent, y along the bitangent, both already scaled. side is -1 where ns is the opposite of
/// the normal that the tangent belongs to, else 1.
SHARED_FN vec3 mappedNormal(vec3 ns, vec3 ng, vec3 tangent, float sign, float side, vec3 texel) {
  vec3 bent = tangent * (side * texel.x) + cross(ns, tangent) * (sign * texel.y) + ns * texel.z;
  bent = bent * inversesqrt(max(dot(bent, bent), 1e-12f));
  float missing = max(kLeastNormalCosine - dot(bent, ng), 0.0f);
  bent = bent + ng * missing;
  return bent * inversesqrt(max(dot(bent, bent), 1e-12f));
}

/// The most that the two cosines of a direction, with the shading and with the geometric normal, count apart.
/// A bent normal would have a surface reflect light that hardly meets it, and show light where it is hardly
/// seen: photons carry the ratio of the cosines, without bound at grazing angles. Here such a surface fades
/// instead (lightFade, viewFade), for photons and for paths from the eye alike.
SHARED_CONST float kMaxCosineRatio = 16.0f;

/// What is left of light from wi that meets a surface at a much smaller angle than its shading normal says.
SHARED_FN float lightFade(vec3 wi, vec3 ng, vec3 ns) {
  return min(kMaxCosineRatio * abs(dot(wi, ng)) / max(abs(dot(wi, ns)), 1e-12f), 1.0f);
}

/// What is left of light towards wo, from which the shading normal's surface is seen at a much smaller angle
/// than the geometric one's.
SHARED_FN float viewFade(vec3 wo, vec3 ng, vec3 ns) {
  return min(kMaxCosineRatio * abs(dot(wo, ns)) / max(abs(dot(wo, ng)), 1e-12f), 1.0f);
}

/// What a photon's power is multiplied by when it scatters at a surface whose shading normal differs from its
/// geometric one, on top of BsdfSample::weight (Veach 1997, 5.3), both fades multiplied in. wi: where it came
/// from, wo: where it goes.
SHARED_FN float photonShadingFactor(vec3 wi, vec3 wo, vec3 ng, vec3 ns) {
  float light = min(abs(dot(wi, ns)) / max(abs(dot(wi, ng)), 1e-12f), kMaxCosineRatio);
  float view = min(abs(dot(wo, ng)) / max(abs(dot(wo, ns)), 1e-12f), kMaxCosineRatio);
  return light * view;
}

/// The same on an eye path's way: light that comes from wi and is seen from wo.
SHARED_FN float eyeShadingFactor(vec3 wi, vec3 wo, vec3 ng, vec3 ns) {
  return lightFade(wi, ng, ns) * viewFade(wo, ng, ns);
}

/// Weight of a stored photon at an eye sample: stored flux per area already holds the geometric cosine, the
/// shading normal wants its own. lightFade() is multiplied in, viewFade() is not. 0 on the back side. ng lies
/// on the eye's side.
SHARED_FN float photonEstimateFactor(vec3 wi, vec3 ng, vec3 ns) {
  float geometric = dot(wi, ng);
  float shading = abs(dot(wi, ns));
  return geometric > 0.0f ? min(shading / max(geometric, 1e-12f), kMaxCosineRatio) : 0.0f;
}

/// The same at a sample that light goes through: photons of both sides count.
SHARED_FN float photonEstimateFactorBothSides(vec3 wi, vec3 ng, vec3 ns) {
  return min(abs(dot(wi, ns)) / max(abs(dot(wi, ng)), 1e-12f), kMaxCosineRatio);
}

SHARED_END

#endif

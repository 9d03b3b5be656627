// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Shading normals from normal maps, and tangents in one word.
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

SHARED_END

#endif

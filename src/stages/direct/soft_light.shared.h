// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Point, spot and directional lights that are given a size: samples of them, how wide their shadows' edges
// are, and how far the shadow at one point of a picture may stand for that at another (SSPM 3.4; Robison and
// Shirley 2009).
#ifndef ISOPHOTE_STAGES_DIRECT_SOFT_LIGHT_SHARED_H
#define ISOPHOTE_STAGES_DIRECT_SOFT_LIGHT_SHARED_H

#include "math/sampling.shared.h"
#include "physics/emission.shared.h"

SHARED_BEGIN

/// Surfaces lit at a smaller cosine are taken for lit at this one where shadows are stretched along them.
SHARED_CONST float kSoftLeastCosine = 0.1f;
/// How near its occluder may come to a light, in distances between light and surface, before the penumbra
/// grows no more.
SHARED_CONST float kSoftLeastGap = 0.05f;
/// Distance from the tangent plane at which a tap counts no more, in radii of the blur.
SHARED_CONST float kSoftPlaneReach = 0.5f;

/// Sample of a light that is given a size: of points and spots the radius of a sphere [m], of directional
/// lights the tangent of half the angle under which they are seen. Its power is that of the light without
/// extent, and so is a spot's falloff. `size` above 0.
SHARED_FN LightSample sampleSoftLight(Light light, float size, vec3 from, vec2 u) {
  Light sphere = light;
  sphere.radius = size;
  LightSample s = samplePoint(sphere, from, u);
  vec3 toCentre = light.position - from;
  float cosAxis = -dot(toCentre, light.direction) / max(length(toCentre), 1e-6f);
  float falloff = light.type == kLightSpot ? spotFalloff(light, cosAxis) : 1.0f;
  s.radiance = s.radiance * falloff;
  float sin2 = size * size / (1.0f + size * size);
  float oneMinusCos = sin2 / (1.0f + sqrt(1.0f - sin2));
  float far = light.type == kLightDirectional ? 1.0f : 0.0f;
  if (far > 0.5f) {
    s.wi = normalize(basisAround(-light.direction) * sampleNarrowCone(u, oneMinusCos));
    s.distance = kInfiniteDistance;
    s.radiance = light.colour * (kInvPi / sin2);
    s.pdf = 1.0f / (2.0f * kPi * oneMinusCos);
    s.isDelta = 0.0f;
  }
  return s;
}

/// How far the edge of a shadow is smeared on a surface that faces the light, to each side [m]: what throws
/// it lies `occluder` away, the light `distance`. `parallel` is 1 for directional lights.
SHARED_FN float penumbraRadius(float size, float parallel, float occluder, float distance) {
  float gap = max(distance - occluder, kSoftLeastGap * distance);
  return size * occluder * (parallel > 0.5f ? 1.0f : 1.0f / gap);
}

/// The axis, perpendicular to wi, of a disc, along wi onto the tangent plane of normal n.
SHARED_FN vec3 shearedAxis(vec3 axis, vec3 wi, vec3 n) {
  return axis - wi * (dot(axis, n) / max(dot(wi, n), kSoftLeastCosine));
}

/// Weight of a tap by its surface: `off` its distance from the tangent plane, `cellsPerMetre` 1 over that at
/// which it counts no more, `alike` the cosine between the normals. In place of the thesis's exponential,
/// which would not end.
SHARED_FN float softTapWeight(float off, float perMetre, float alike) {
  float x = off * perMetre;
  float near = max(1.0f - x * x, 0.0f);
  float facing = max(alike, 0.0f);
  float facing2 = facing * facing;
  return near * near * facing2 * facing2;
}

/// A unit vector in 3 x 10 bits: loops unpack it with less work than an octahedral one.
SHARED_FN uint packNormal10(vec3 n) {
  uint x = uint(clamp(n.x * 511.0f + 512.5f, 0.0f, 1023.0f));
  uint y = uint(clamp(n.y * 511.0f + 512.5f, 0.0f, 1023.0f));
  uint z = uint(clamp(n.z * 511.0f + 512.5f, 0.0f, 1023.0f));
  return x | (y << 10u) | (z << 20u);
}

/// Within 0.002 of unit length.
SHARED_FN vec3 unpackNormal10(uint bits) {
  return vec3(float(int(bits & 1023u)) - 512.0f, float(int((bits >> 10u) & 1023u)) - 512.0f,
              float(int((bits >> 20u) & 1023u)) - 512.0f) *
         (1.0f / 511.0f);
}

SHARED_END

#endif

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trace/surface.h"

namespace isophote {

struct PlaneHit {
  float t;
  float u;
  float v;
};

/// Where a ray meets the plane of a triangle that it is known to pass through; u and v moved into the
/// triangle. The centroid serves for triangles seen so exactly from their edge that rounding leaves nothing.
SHARED_FN PlaneHit planeHit(const vec3* position, const Ray& ray) {
  const vec3 edge1 = position[1] - position[0];
  const vec3 edge2 = position[2] - position[0];
  const vec3 s = ray.origin - position[0];
  const vec3 p = cross(ray.direction, edge2);
  const vec3 q = cross(s, edge1);
  const float determinant = dot(edge1, p);
  const float inverse = 1.0f / determinant;
  const bool edgeOn = !(abs(determinant) > 1e-30f);
  const float uMet = max(edgeOn ? 1.0f / 3.0f : dot(s, p) * inverse, 0.0f);
  const float vMet = max(edgeOn ? 1.0f / 3.0f : dot(ray.direction, q) * inverse, 0.0f);
  const float scale = 1.0f / max(uMet + vMet, 1.0f);
  const float t = edgeOn ? dot((edge1 + edge2) * (1.0f / 3.0f) - s, ray.direction) : dot(edge2, q) * inverse;
  return {max(t, 0.0f), uMet * scale, vMet * scale};
}

}  // namespace isophote

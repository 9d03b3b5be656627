// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/bsdf.shared.h"
#include "scene/scene.h"
#include "trace/trace_scene.h"

namespace isophote {

/// Everything that shading needs at a hit, textures looked up. Both normals are turned to the side that the
/// ray came from.
struct Surface {
  vec3 position;   ///< From the barycentric coordinates: closer to the triangle than origin + t * direction.
  vec3 ng;         ///< Geometric normal, unit.
  vec3 ns;         ///< Shading normal, unit.
  float entering;  ///< 1 when the ray came from the front (outside) of the triangle.
  Bsdf bsdf;
  vec3 emission;    ///< Emitted radiance towards the ray's origin [W/(m^2 sr)].
  vec3 baseColour;  ///< Reflectance for the albedo layer.
};

Surface surfaceAt(const Scene& scene, const Ray& ray, const Hit& hit);

/// A ray that leaves `position` on the side of `direction`, moved off the surface by a few units of float
/// precision.
Ray rayFrom(vec3 position, vec3 ng, vec3 direction, float tMax = 1e30f);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/bsdf.shared.h"
#include "scene/mesh_emission.h"
#include "scene/texture_sample.h"
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

namespace detail {

struct TexturedMaterial {
  vec3 baseColour;
  float metallic;
  float roughness;
  float transmission;
  vec3 emission;
};

/// Factors times textures at uv.
inline TexturedMaterial texturedMaterial(const Scene& scene, const Material& m, vec2 uv) {
  TexturedMaterial t{m.baseColour, m.metallic, m.roughness, m.transmission, m.emission};
  if (m.baseColourTexture >= 0) {
    const vec4 texel = sampleTexture(scene.textures[std::size_t(m.baseColourTexture)], uv);
    t.baseColour *= vec3(texel.x, texel.y, texel.z);
  }
  if (m.metallicRoughnessTexture >= 0) {
    const vec4 texel = sampleTexture(scene.textures[std::size_t(m.metallicRoughnessTexture)], uv);
    t.roughness *= texel.y;
    t.metallic *= texel.z;
  }
  if (m.transmissionTexture >= 0)
    t.transmission *= sampleTexture(scene.textures[std::size_t(m.transmissionTexture)], uv).x;
  t.emission = emittedRadiance(scene, m, uv);
  return t;
}

}  // namespace detail

/// A point of a triangle: what does not depend on the material. The normals as in Surface.
struct SurfacePoint {
  vec3 position;
  vec3 ng;
  vec3 ns;
  float entering;
};

/// The point of a triangle in world space with barycentric weights u and v, met by a ray of that direction.
SHARED_FN SurfacePoint surfacePoint(const ShadedTriangle& t, float u, float v, vec3 rayDirection) {
  const float w = 1.0f - u - v;
  SurfacePoint s;
  s.position = t.position[0] * w + t.position[1] * u + t.position[2] * v;
  const vec3 scaledNormal = cross(t.position[1] - t.position[0], t.position[2] - t.position[0]);
  const vec3 front = scaledNormal * inversesqrt(max(dot(scaledNormal, scaledNormal), 1e-37f));
  s.entering = dot(rayDirection, front) < 0.0f ? 1.0f : 0.0f;
  s.ng = front * (s.entering > 0.5f ? 1.0f : -1.0f);
  const vec3 n = t.normal[0] * w + t.normal[1] * u + t.normal[2] * v;
  const float length2 = dot(n, n);
  const float scale = inversesqrt(max(length2, 1e-12f)) * (dot(n, s.ng) < 0.0f ? -1.0f : 1.0f);
  // Normals that cancel out or point through the triangle are the file's mistake; the triangle's own serves.
  const bool own = length2 <= 1e-12f;
  s.ns = vec3(own ? s.ng.x : n.x * scale, own ? s.ng.y : n.y * scale, own ? s.ng.z : n.z * scale);
  return s;
}

SHARED_FN vec2 uvAt(const ShadedTriangle& t, float u, float v) {
  return t.uv[0] * (1.0f - u - v) + t.uv[1] * u + t.uv[2] * v;
}

/// The triangle in world space; its normals are not unit where the instance is scaled.
SHARED_FN ShadedTriangle worldTriangle(const ShadedInstance& instance, std::uint32_t index) {
  ShadedTriangle t = instance.triangles[index];
  if (!instance.inWorldSpace)
    for (int k = 0; k < 3; ++k) {
      t.position[k] = instance.worldFromObject * vec4(t.position[k], 1.0f);
      t.normal[k] = instance.normalFromObject * t.normal[k];
    }
  return t;
}

SHARED_FN Surface surfaceAt(const TraceScene& trace, const Ray& ray, const Hit& hit) {
  const ShadedInstance& instance = trace.instance(hit.instance);
  const ShadedTriangle triangle = worldTriangle(instance, hit.triangle);
  const SurfacePoint point = surfacePoint(triangle, hit.u, hit.v, ray.direction);
  Surface s;
  s.position = point.position;
  s.ng = point.ng;
  s.ns = point.ns;
  s.entering = point.entering;
  const Material& m = *instance.material;
  const detail::TexturedMaterial t = detail::texturedMaterial(trace.scene(), m, uvAt(triangle, hit.u, hit.v));
  s.baseColour = t.baseColour;
  s.bsdf = bsdfFromMaterial(m, t.baseColour, t.metallic, t.roughness, t.transmission);
  s.emission = s.entering > 0.5f || (m.flags & kMaterialDoubleSided) != 0u ? t.emission : vec3(0.0f);
  return s;
}

/// Where a ray may start that leaves `position` on the side of `direction`: moved off the surface by a few
/// units of float precision, so that it does not meet the surface that it leaves.
SHARED_FN vec3 offsetFrom(vec3 position, vec3 ng, vec3 direction) {
  const float size = max(max(abs(position.x), abs(position.y)), max(abs(position.z), 1e-3f));
  const float step = dot(direction, ng) >= 0.0f ? 2e-6f : -2e-6f;
  return position + ng * (step * size);
}

SHARED_FN Ray rayFrom(vec3 position, vec3 ng, vec3 direction, float tMax = 1e30f) {
  return {offsetFrom(position, ng, direction), 0.0f, direction, tMax};
}

}  // namespace isophote

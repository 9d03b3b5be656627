// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/bsdf.shared.h"
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
  if (m.emissionTexture >= 0) {
    const vec4 texel = sampleTexture(scene.textures[std::size_t(m.emissionTexture)], uv);
    t.emission *= vec3(texel.x, texel.y, texel.z);
  }
  return t;
}

}  // namespace detail

SHARED_FN Surface surfaceAt(const TraceScene& trace, const Ray& ray, const Hit& hit) {
  const ShadedInstance& instance = trace.instance(hit.instance);
  const ShadedTriangle& triangle = instance.triangles[hit.triangle];
  vec3 p0 = triangle.position[0], p1 = triangle.position[1], p2 = triangle.position[2];
  if (!instance.identity) {
    p0 = instance.worldFromObject * vec4(p0, 1.0f);
    p1 = instance.worldFromObject * vec4(p1, 1.0f);
    p2 = instance.worldFromObject * vec4(p2, 1.0f);
  }
  const float w = 1.0f - hit.u - hit.v;
  Surface s;
  s.position = p0 * w + p1 * hit.u + p2 * hit.v;

  const vec3 scaledNormal = cross(p1 - p0, p2 - p0);
  const vec3 front = scaledNormal * inversesqrt(max(dot(scaledNormal, scaledNormal), 1e-37f));
  const bool fromFront = dot(ray.direction, front) < 0.0f;
  s.entering = fromFront ? 1.0f : 0.0f;
  s.ng = fromFront ? front : -front;
  s.ns = s.ng;
  if (instance.hasNormals) {
    vec3 n = triangle.normal[0] * w + triangle.normal[1] * hit.u + triangle.normal[2] * hit.v;
    if (!instance.identity) n = instance.normalFromObject * n;
    const float length2 = dot(n, n);
    // Normals that cancel out or point through the triangle are the file's mistake; the triangle's own
    // serves.
    if (length2 > 1e-12f) {
      n *= inversesqrt(length2);
      s.ns = dot(n, s.ng) < 0.0f ? -n : n;
    }
  }

  const Material& m = *instance.material;
  const vec2 uv = triangle.uv[0] * w + triangle.uv[1] * hit.u + triangle.uv[2] * hit.v;
  const detail::TexturedMaterial t = detail::texturedMaterial(trace.scene(), m, uv);
  s.baseColour = t.baseColour;
  s.bsdf = bsdfFromMaterial(m, t.baseColour, t.metallic, t.roughness, t.transmission);
  s.emission = fromFront || (m.flags & kMaterialDoubleSided) != 0u ? t.emission : vec3(0.0f);
  return s;
}

// What surfaceAt() reads depends on what it has read before: the triangle, then texels. Loops over many hits
// call these two some hits ahead, the second a few hits after the first, and so wait for memory once instead
// of at every hit. Both take valid hits.

SHARED_FN void prefetchTriangle(const TraceScene& trace, const Hit& hit) {
  const ShadedTriangle* triangle = trace.instance(hit.instance).triangles + hit.triangle;
  __builtin_prefetch(triangle);
  __builtin_prefetch(&triangle->uv[2].y);
}

SHARED_FN void prefetchTexels(const TraceScene& trace, const Hit& hit) {
  const ShadedInstance& instance = trace.instance(hit.instance);
  const Material& m = *instance.material;
  if (max(m.baseColourTexture, m.metallicRoughnessTexture) < 0) return;
  const ShadedTriangle& t = instance.triangles[hit.triangle];
  const vec2 uv = t.uv[0] * (1.0f - hit.u - hit.v) + t.uv[1] * hit.u + t.uv[2] * hit.v;
  for (const int texture : {m.baseColourTexture, m.metallicRoughnessTexture})
    if (texture >= 0) prefetchTexels(trace.scene().textures[std::size_t(texture)], uv);
}

/// Where a ray may start that leaves `position` on the side of `direction`: moved off the surface by a few
/// units of float precision, so that it does not meet the surface that it leaves.
inline vec3 offsetFrom(vec3 position, vec3 ng, vec3 direction) {
  const float size = max(max(abs(position.x), abs(position.y)), max(abs(position.z), 1e-3f));
  const float step = dot(direction, ng) >= 0.0f ? 2e-6f : -2e-6f;
  return position + ng * (step * size);
}

inline Ray rayFrom(vec3 position, vec3 ng, vec3 direction, float tMax = 1e30f) {
  return {offsetFrom(position, ng, direction), 0.0f, direction, tMax};
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/bsdf.shared.h"
#include "physics/shading_normal.shared.h"
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
  vec3 absorption;  ///< Of the solid behind its front [1/m]; 0 where there is none.
  float solid;      ///< 1 where light that goes through enters or leaves a solid.
  float coverage;   ///< Alpha where it is blended, else 1.
};

namespace detail {

/// A material with its textures at one place in its factors.
inline Material texturedMaterial(const Scene& scene, Material m, vec2 uv, vec4 vertexColour) {
  const auto sample = [&](int texture) { return sampleTexture(scene.textures[std::size_t(texture)], uv); };
  const auto rgb = [](vec4 texel) { return vec3(texel.x, texel.y, texel.z); };
  m.baseColour *= rgb(vertexColour);
  if (m.baseColourTexture >= 0) m.baseColour *= rgb(sample(m.baseColourTexture));
  if (m.metallicRoughnessTexture >= 0) {
    const vec4 texel = sample(m.metallicRoughnessTexture);
    m.roughness *= texel.y;
    m.metallic *= texel.z;
  }
  if (m.transmissionTexture >= 0) m.transmission *= sample(m.transmissionTexture).x;
  m.emission = emittedRadiance(scene, m, uv);
  if (m.specularTexture >= 0) m.specular *= sample(m.specularTexture).w;
  if (m.specularColourTexture >= 0) m.specularColour *= rgb(sample(m.specularColourTexture));
  return m;
}

}  // namespace detail

/// A point of a triangle: what does not depend on the material. The normals as in Surface.
struct SurfacePoint {
  vec3 position;
  vec3 ng;
  vec3 ns;
  float entering;
  float side;  ///< -1 where ns is the opposite of the vertices' normal, else 1.
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
  const vec3 n =
      unpackDirection(t.normal[0]) * w + unpackDirection(t.normal[1]) * u + unpackDirection(t.normal[2]) * v;
  const float length2 = dot(n, n);
  // Normals that cancel out are the file's mistake; the triangle's own serves.
  const bool own = t.normal[0] == kNoDirection || length2 <= 1e-12f;
  // A choice between numbers: the compiler does not vectorise one between comparisons.
  const float ownSide = s.entering < 0.5f ? -1.0f : 1.0f;
  const float itsSide = dot(n, s.ng) < 0.0f ? -1.0f : 1.0f;
  s.side = own ? ownSide : itsSide;
  const float scale = inversesqrt(max(length2, 1e-12f)) * s.side;
  s.ns = vec3(own ? s.ng.x : n.x * scale, own ? s.ng.y : n.y * scale, own ? s.ng.z : n.z * scale);
  return s;
}

SHARED_FN vec2 uvAt(const ShadedTriangle& t, float u, float v) {
  return t.uv[0] * (1.0f - u - v) + t.uv[1] * u + t.uv[2] * v;
}

/// Linear colour of the vertices, and their alpha.
SHARED_FN vec4 colourAt(const ShadedTriangle& t, float u, float v) {
  const auto decode = [](uint c) __attribute__((always_inline)) {
    return vec4(float(int(c & 255u)), float(int((c >> 8u) & 255u)), float(int((c >> 16u) & 255u)),
                float(int(c >> 24u)));
  };
  return (decode(t.colour[0]) * (1.0f - u - v) + decode(t.colour[1]) * u + decode(t.colour[2]) * v) / 255.0f;
}

/// The shading normal of a point, bent by what a normal map says there (sampleNormal). Where the triangle has
/// no tangents it stays as it is.
SHARED_FN vec3 bentNormal(const ShadedTriangle& t, float u, float v, vec3 ns, vec3 ng, float side, vec3 texel,
                          float scale) {
  const vec3 tangent = unpackTangent(t.tangent[0]) * (1.0f - u - v) + unpackTangent(t.tangent[1]) * u +
                       unpackTangent(t.tangent[2]) * v;
  const vec3 scaled(texel.x * scale, texel.y * scale, texel.z);
  const vec3 bent = mappedNormal(ns, ng, tangent, tangentSign(t.tangent[0]), side, scaled);
  const bool none = t.tangent[0] == kNoDirection || scale == 0.0f;
  return vec3(none ? +ns.x : +bent.x, none ? +ns.y : +bent.y, none ? +ns.z : +bent.z);
}

/// Unit, however long the vector is.
SHARED_FN vec3 unitOf(vec3 v) {
  const float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
  return largest > 0.0f ? normalize(v / largest) : vec3(0.0f, 1.0f, 0.0f);
}

/// The triangle in world space.
SHARED_FN ShadedTriangle worldTriangle(const ShadedInstance& instance, std::uint32_t index) {
  ShadedTriangle t = instance.triangles[index];
  if (instance.inWorldSpace) return t;
  for (int k = 0; k < 3; ++k) {
    t.position[k] = instance.worldFromObject * vec4(t.position[k], 1.0f);
    if (t.normal[k] != kNoDirection)
      t.normal[k] = packDirection(unitOf(instance.normalFromObject * unpackDirection(t.normal[k])));
    if (t.tangent[k] != kNoDirection)
      t.tangent[k] =
          packTangent(unitOf(vec3(instance.worldFromObject * vec4(unpackTangent(t.tangent[k]), 0.0f))),
                      tangentSign(t.tangent[k]));
  }
  return t;
}

SHARED_FN Surface surfaceAt(const TraceScene& trace, const Ray& ray, const Hit& hit) {
  const ShadedInstance& instance = trace.instance(hit.instance);
  const ShadedTriangle triangle = worldTriangle(instance, hit.triangle);
  const SurfacePoint point = surfacePoint(triangle, hit.u, hit.v, ray.direction);
  const vec2 uv = uvAt(triangle, hit.u, hit.v);
  Surface s;
  s.position = point.position;
  s.ng = point.ng;
  s.ns = point.ns;
  if (instance.shadedMaterial->normalMapped) {
    const vec3 texel = sampleNormal(instance.shadedMaterial->normalTexture, uv);
    s.ns = bentNormal(triangle, hit.u, hit.v, point.ns, point.ng, point.side, texel,
                      instance.shadedMaterial->normalScale);
  }
  s.entering = point.entering;
  s.coverage = trace.coverageAt(hit);
  Material m =
      detail::texturedMaterial(trace.scene(), *instance.material, uv, colourAt(triangle, hit.u, hit.v));
  const bool unlit = (m.flags & kMaterialUnlit) != 0u;
  s.baseColour = m.baseColour;
  s.emission = unlit                                                         ? m.baseColour
               : s.entering > 0.5f || (m.flags & kMaterialDoubleSided) != 0u ? m.emission
                                                                             : vec3(0.0f);
  if (unlit) {
    m.baseColour = vec3(0.0f);
    m.metallic = m.transmission = m.specular = 0.0f;
  }
  s.bsdf = bsdfFromMaterial(m, m.baseColour, m.metallic, m.roughness, m.transmission);
  s.solid = s.bsdf.through > 0.0f && (m.flags & kMaterialThinWalled) == 0u ? 1.0f : 0.0f;
  s.absorption = s.solid > 0.5f ? m.absorption : vec3(0.0f);
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

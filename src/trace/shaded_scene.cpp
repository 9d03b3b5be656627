// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/shaded_scene.h"

#include "base/error.h"
#include "trace/surface.h"
#include "trace/tangents.h"

#include <tbb/parallel_for.h>

namespace isophote {

namespace {

mat3 linearPart(const mat4x3& m) { return mat3(m[0], m[1], m[2]); }

uint packColour(vec4 colour) {
  const vec4 c = clamp(colour, vec4(0.0f), vec4(1.0f)) * 255.0f + vec4(0.5f);
  return uint(c.x) | uint(c.y) << 8u | uint(c.z) << 16u | uint(c.w) << 24u;
}

/// Tangents are packed where `tangents` has them: one for each corner of each triangle.
ShadedTriangle shadedTriangle(const Mesh& mesh, std::size_t triangle, const std::vector<uint>& tangents) {
  const uvec3 index = mesh.triangles[triangle];
  ShadedTriangle t;
  for (int k = 0; k < 3; ++k) {
    t.position[k] = mesh.positions[index[k]];
    t.normal[k] = mesh.normals.empty() ? kNoDirection : packDirection(mesh.normals[index[k]]);
    t.tangent[k] = tangents.empty() ? kNoDirection : tangents[3 * triangle + std::size_t(k)];
    t.colour[k] = mesh.colours.empty() ? 0xffffffffu : packColour(mesh.colours[index[k]]);
    t.uv[k] = mesh.uvs.empty() ? vec2(0.0f) : mesh.uvs[index[k]];
  }
  return t;
}

TextureView viewOrWhite(const Scene& scene, int texture) {
  static constexpr std::uint8_t kWhite[4] = {255, 255, 255, 255};
  if (texture < 0) return {kWhite, 1, 1, 0, 0, 0, 0, 0.0f, 0};
  return viewOf(scene.textures[std::size_t(texture)]);
}

Scattering scatteringOf(const Material& m) {
  const bool coloured =
      m.specularColour != vec3(1.0f) || m.specularTexture >= 0 || m.specularColourTexture >= 0;
  const bool blended = (m.flags & kMaterialAlphaBlend) != 0u;
  if (m.transmission > 0.0f || (coloured && m.specular > 0.0f) || blended) return Scattering::kAny;
  return m.specular == 0.0f && m.metallic == 0.0f ? Scattering::kLambert : Scattering::kOpaque;
}

}  // namespace

std::vector<std::size_t> gatherTriangles(const Scene& scene, const std::vector<std::uint32_t>& uses,
                                         std::uint64_t budgetBytes, LargeVector<ShadedTriangle>& triangles) {
  std::vector<std::size_t> first(scene.meshes.size(), 0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    first[i] = count;
    count += uses[i] > 0 ? scene.meshes[i].triangles.size() : 0;
  }
  if (count * sizeof(ShadedTriangle) > budgetBytes)
    fail(ErrorKind::kResources, "", "{} triangles do not fit the memory budget of {} MiB", count,
         budgetBytes >> 20);
  triangles.resize(count);
  tbb::parallel_for(std::size_t(0), scene.meshes.size(), [&](std::size_t i) {
    const Mesh& mesh = scene.meshes[i];
    if (uses[i] == 0) return;
    const bool mapped = scene.materials[mesh.material].normalTexture >= 0;
    const std::vector<uint> tangents = mapped ? cornerTangents(mesh) : std::vector<uint>();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      triangles[first[i] + t] = shadedTriangle(mesh, t, tangents);
  });
  return first;
}

ShadedMaterial shadedMaterial(const Scene& scene, const Material& m) {
  ShadedMaterial s;
  const bool unlit = (m.flags & kMaterialUnlit) != 0u;
  s.baseColour = unlit ? vec3(0.0f) : m.baseColour;
  s.metallic = unlit ? 0.0f : m.metallic;
  s.roughness = m.roughness;
  s.specular = unlit ? 0.0f : m.specular;
  s.ior = m.ior;
  s.blended = (m.flags & kMaterialAlphaBlend) != 0u;
  s.scattering = unlit && !s.blended ? Scattering::kLambert : scatteringOf(m);
  const int ofMetal = s.scattering == Scattering::kLambert ? -1 : m.metallicRoughnessTexture;
  s.textureOfMetal = ofMetal >= 0;
  s.normalMapped = m.normalTexture >= 0 && m.normalScale != 0.0f && !unlit;
  s.normalScale = s.normalMapped ? m.normalScale : 0.0f;
  s.textured = m.baseColourTexture >= 0 || s.textureOfMetal || s.normalMapped;
  s.colourTexture = viewOrWhite(scene, m.baseColourTexture);
  s.metallicRoughnessTexture = viewOrWhite(scene, ofMetal);
  s.normalTexture = viewOrWhite(scene, s.normalMapped ? m.normalTexture : -1);
  return s;
}

bool absorbsInside(const Material& m) {
  return m.transmission > 0.0f && (m.flags & kMaterialThinWalled) == 0u && m.absorption != vec3(0.0f);
}

ShadedInstance shadedInstance(const Scene& scene, const Instance& instance, const ShadedTriangle* triangles,
                              const ShadedMaterial* materials) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  ShadedInstance s;
  s.triangles = triangles;
  s.material = &scene.materials[mesh.material];
  s.shadedMaterial = materials + mesh.material;
  s.worldFromObject = instance.worldFromObject;
  s.inWorldSpace = instance.worldFromObject == mat4x3(1.0f);
  s.coloured = !mesh.colours.empty();
  const mat3 linear = linearPart(instance.worldFromObject);
  // finishScene() leaves no instance that mirrors, so the cofactors keep the normals' side.
  s.normalFromObject =
      mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
  return s;
}

void moveToWorld(ShadedInstance& instance, std::size_t count, LargeVector<ShadedTriangle>& triangles) {
  if (instance.inWorldSpace) return;
  ShadedTriangle* first = triangles.data() + (instance.triangles - triangles.data());
  tbb::parallel_for(std::size_t(0), count,
                    [&](std::size_t i) { first[i] = worldTriangle(instance, std::uint32_t(i)); });
  instance.inWorldSpace = true;
}

}  // namespace isophote

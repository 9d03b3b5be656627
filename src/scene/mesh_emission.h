// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/emission.shared.h"
#include "scene/alpha_mask.h"

#include <span>
#include <vector>

namespace isophote {

/// What a material's front emits at uv [W/(m^2 sr)].
inline vec3 emittedRadiance(const Scene& scene, const Material& material, vec2 uv) {
  if (material.emissionTexture < 0) return material.emission;
  const vec4 texel = sampleTexture(scene.textures[std::size_t(material.emissionTexture)], uv);
  return material.emission * vec3(texel.x, texel.y, texel.z);
}

/// Whether radiance differs between points of the mesh: by a texture of emission, or by holes.
inline bool emitsUnevenly(const Scene& scene, const Mesh& mesh) {
  const Material& m = scene.materials[mesh.material];
  return m.emissionTexture >= 0 || isMasked(scene, mesh);
}

/// What a triangle emits at barycentric weights b of its second and third vertex; 0 in the holes of a mask.
inline vec3 emittedRadiance(const Scene& scene, const Mesh& mesh, std::uint32_t triangle, vec2 b) {
  if (isMasked(scene, mesh) && !texelIsThere(scene, mesh, triangle, b.x, b.y)) return vec3(0.0f);
  vec2 uv(0.0f);
  if (!mesh.uvs.empty()) {
    const uvec3 index = mesh.triangles[triangle];
    uv = mesh.uvs[index.x] * (1.0f - b.x - b.y) + mesh.uvs[index.y] * b.x + mesh.uvs[index.z] * b.y;
  }
  return emittedRadiance(scene, scene.materials[mesh.material], uv);
}

/// A triangle of a mesh light with the radiance that it has where sampleTriangle(u) falls: for emitTriangle()
/// and sampleEmissiveTriangle() with the same numbers.
inline EmissiveTriangle litAt(const Scene& scene, const EmissiveTriangle& triangle, vec2 u) {
  EmissiveTriangle lit = triangle;
  const Mesh& mesh = scene.meshes[scene.instances[triangle.instance].mesh];
  if (emitsUnevenly(scene, mesh))
    lit.radiance = emittedRadiance(scene, mesh, triangle.triangle, sampleTriangle(u));
  return lit;
}

/// The triangle of a mesh light that u in [0, 1) picks, with its probability.
inline const EmissiveTriangle& chooseTriangle(const Scene& scene, const Light& light, float u) {
  const float at = u * float(light.triangleCount);
  const std::uint32_t slot = std::min(std::uint32_t(at), light.triangleCount - 1);
  const AliasSlot& alias = scene.emissiveAliases[light.firstTriangle + slot];
  const std::uint32_t chosen = at - float(slot) < alias.own ? slot : alias.other;
  return scene.emissiveTriangles[light.firstTriangle + chosen];
}

/// Probability with which chooseTriangle() picks the triangle of that index in its mesh; 0 where it has no
/// area.
float triangleProbability(const Scene& scene, const Light& light, std::uint32_t triangle);

/// The alias table of numbers that add up to 1.
std::vector<AliasSlot> aliasTable(std::span<const float> probabilities);

/// Turns every instance whose material emits into one mesh light, with its triangles in
/// scene.emissiveTriangles and scene.emissiveAliases.
void addMeshLights(Scene& scene, const Job& job = {});

}  // namespace isophote

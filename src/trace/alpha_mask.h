// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/texture_sample.h"

namespace isophote {

inline bool isMasked(const Scene& scene, const Mesh& mesh) {
  return (scene.materials[mesh.material].flags & kMaterialAlphaMask) != 0u;
}

/// Whether a masked mesh is there at the barycentric weights u and v of one of its triangles.
inline bool texelIsThere(const Scene& scene, const Mesh& mesh, std::uint32_t triangle, float u, float v) {
  const Material& material = scene.materials[mesh.material];
  float alpha = material.alpha;
  if (material.baseColourTexture >= 0 && !mesh.uvs.empty()) {
    const uvec3 index = mesh.triangles[triangle];
    const vec2 uv = mesh.uvs[index.x] * (1.0f - u - v) + mesh.uvs[index.y] * u + mesh.uvs[index.z] * v;
    alpha *= sampleTexture(scene.textures[std::size_t(material.baseColourTexture)], uv).w;
  }
  return alpha >= material.alphaCutoff;
}

}  // namespace isophote

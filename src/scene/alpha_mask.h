// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/texture_sample.h"

namespace isophote {

inline bool isMasked(const Scene& scene, const Mesh& mesh) {
  return (scene.materials[mesh.material].flags & kMaterialAlphaMask) != 0u;
}

/// The alpha of sampleTexture() alone.
inline float sampleAlpha(const Texture& texture, vec2 uv) {
  const TextureView view = viewOf(texture);
  const TexelSquare square = texelSquare(view, boundedUv(uv));
  const auto alpha = [&](std::size_t i) {
    return detail::kLinearFrom8.values[view.rgba[std::size_t(square.index[i]) * 4 + 3]];
  };
  const float upper = mix(alpha(0), alpha(1), square.weightX);
  const float lower = mix(alpha(2), alpha(3), square.weightX);
  return mix(upper, lower, square.weightY);
}

inline bool isBlended(const Scene& scene, const Mesh& mesh) {
  return (scene.materials[mesh.material].flags & kMaterialAlphaBlend) != 0u;
}

/// Alpha of a mesh at the barycentric weights u and v of one of its triangles.
inline float alphaAt(const Scene& scene, const Mesh& mesh, std::uint32_t triangle, float u, float v) {
  const Material& material = scene.materials[mesh.material];
  float alpha = material.alpha;
  const uvec3 index = mesh.triangles[triangle];
  const float w = 1.0f - u - v;
  if (material.baseColourTexture >= 0 && !mesh.uvs.empty()) {
    const vec2 uv = mesh.uvs[index.x] * w + mesh.uvs[index.y] * u + mesh.uvs[index.z] * v;
    alpha *= sampleAlpha(scene.textures[std::size_t(material.baseColourTexture)], uv);
  }
  if (!mesh.colours.empty())
    alpha *= mesh.colours[index.x].w * w + mesh.colours[index.y].w * u + mesh.colours[index.z].w * v;
  return alpha;
}

/// Whether a masked mesh is there at the barycentric weights u and v of one of its triangles.
inline bool texelIsThere(const Scene& scene, const Mesh& mesh, std::uint32_t triangle, float u, float v) {
  return alphaAt(scene, mesh, triangle, u, v) >= scene.materials[mesh.material].alphaCutoff;
}

}  // namespace isophote

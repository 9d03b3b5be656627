// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/tangents.h"

#include "physics/shading_normal.shared.h"

#include <array>
#include <cmath>

namespace isophote {

namespace {

/// Direction in which u grows over a triangle, and on which side of it v grows.
struct TriangleTangent {
  vec3 along{0.0f};  ///< Unit; 0 where the coordinates span no area.
  bool mirrors = false;
};

TriangleTangent tangentOf(const Mesh& mesh, const uvec3& index) {
  const vec3 e1 = mesh.positions[index.y] - mesh.positions[index.x];
  const vec3 e2 = mesh.positions[index.z] - mesh.positions[index.x];
  const vec2 d1 = mesh.uvs[index.y] - mesh.uvs[index.x];
  const vec2 d2 = mesh.uvs[index.z] - mesh.uvs[index.x];
  const float area = d1.x * d2.y - d2.x * d1.y;
  const vec3 along = (e1 * d2.y - e2 * d1.y) * (area < 0.0f ? -1.0f : 1.0f);
  const float size = length(along);
  TriangleTangent t;
  if (area != 0.0f && size > 0.0f && size < 1e30f) t.along = along / size;
  // In glTF v grows downwards in the image, and the green of a normal map points up: against v.
  t.mirrors = area > 0.0f;
  return t;
}

float angleBetween(vec3 a, vec3 b) {
  const float size = length(a) * length(b);
  return size > 0.0f ? std::acos(clamp(dot(a, b) / size, -1.0f, 1.0f)) : 0.0f;
}

/// Sums at each vertex, apart for both sides of the bitangent.
using TangentSums = std::vector<std::array<vec3, 2>>;

TangentSums sumTangents(const Mesh& mesh) {
  TangentSums sums(mesh.positions.size(), {vec3(0.0f), vec3(0.0f)});
  for (const uvec3& index : mesh.triangles) {
    const TriangleTangent t = tangentOf(mesh, index);
    for (int k = 0; k < 3; ++k) {
      const vec3 corner = mesh.positions[index[k]];
      const vec3 next = mesh.positions[index[(k + 1) % 3]] - corner;
      const vec3 last = mesh.positions[index[(k + 2) % 3]] - corner;
      const vec3 n = mesh.normals.empty() ? cross(next, last) : mesh.normals[index[k]];
      const float n2 = dot(n, n);
      const vec3 flat = n2 > 0.0f ? t.along - n * (dot(t.along, n) / n2) : t.along;
      const float size = length(flat);
      if (size > 1e-6f) sums[index[k]][t.mirrors ? 1 : 0] += flat * (angleBetween(next, last) / size);
    }
  }
  return sums;
}

}  // namespace

std::vector<uint> cornerTangents(const Mesh& mesh) {
  if (mesh.uvs.empty()) return {};
  std::vector<uint> corners;
  corners.reserve(mesh.triangles.size() * 3);
  if (!mesh.tangents.empty()) {
    for (const uvec3& index : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const vec4 t = mesh.tangents[index[k]];
        corners.push_back(packTangent(vec3(t), t.w));
      }
    return corners;
  }
  const TangentSums sums = sumTangents(mesh);
  for (const uvec3& index : mesh.triangles) {
    const TriangleTangent own = tangentOf(mesh, index);
    for (int k = 0; k < 3; ++k) {
      vec3 t = sums[index[k]][own.mirrors ? 1 : 0];
      const float size = length(t);
      t = size > 1e-6f ? t / size : own.along;
      corners.push_back(t == vec3(0.0f) ? kNoDirection : packTangent(t, own.mirrors ? -1.0f : 1.0f));
    }
  }
  return corners;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/obj_geometry.h"
#include "scene/triangulate.h"

#include <bit>

namespace isophote {

namespace {

/// Gives each distinct corner a number, in order of first appearance. An open hash table: one allocation for
/// all.
class CornerNumbers {
 public:
  explicit CornerNumbers(std::size_t most) : slots_(std::bit_ceil(2 * most + 1), kObjNone) {}

  std::uint32_t numberOf(const ObjCorner& corner) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash(corner) & mask;
    while (slots_[slot] != kObjNone && distinct_[slots_[slot]] != corner) slot = (slot + 1) & mask;
    if (slots_[slot] == kObjNone) {
      slots_[slot] = std::uint32_t(distinct_.size());
      distinct_.push_back(corner);
    }
    return slots_[slot];
  }

  const std::vector<ObjCorner>& distinct() const { return distinct_; }

 private:
  static std::size_t hash(const ObjCorner& c) {
    std::uint64_t h = c.position * 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 32) ^ c.uv) * 0xd6e8feb86659fd93ull;
    h = (h ^ (h >> 32) ^ c.normal) * 0xd6e8feb86659fd93ull;
    return std::size_t(h ^ (h >> 32));
  }

  std::vector<std::uint32_t> slots_;
  std::vector<ObjCorner> distinct_;
};

void appendTriangles(const ObjGeometry& geometry, const ObjGroup& group, CornerNumbers& numbers,
                     std::vector<uvec3>& triangles, const Job& job) {
  std::vector<vec3> polygon;
  std::vector<uvec3> parts;
  std::vector<std::uint32_t> vertices;
  triangles.reserve(group.corners.size() - 2 * group.faceSizes.size());
  std::size_t first = 0;
  for (std::size_t face = 0; face < group.faceSizes.size(); ++face) {
    if (face % 8192 == 0) job.throwIfStopped();
    const std::size_t size = group.faceSizes[face];
    vertices.clear();
    for (std::size_t i = first; i < first + size; ++i) vertices.push_back(numbers.numberOf(group.corners[i]));
    if (size == 3) {
      triangles.emplace_back(vertices[0], vertices[1], vertices[2]);
    } else {
      polygon.clear();
      parts.clear();
      for (std::size_t i = first; i < first + size; ++i) {
        polygon.push_back(geometry.positions[group.corners[i].position]);
      }
      triangulatePolygon(polygon, parts);
      for (const uvec3& t : parts) triangles.emplace_back(vertices[t.x], vertices[t.y], vertices[t.z]);
    }
    first += size;
  }
}

}  // namespace

Mesh buildObjMesh(const ObjGeometry& geometry, const ObjGroup& group, const Job& job) {
  Mesh mesh;
  mesh.name = group.name;
  mesh.material = group.material;
  CornerNumbers numbers(group.corners.size());
  appendTriangles(geometry, group, numbers, mesh.triangles, job);
  const std::vector<ObjCorner>& corners = numbers.distinct();
  mesh.positions.reserve(corners.size());
  for (const ObjCorner& corner : corners) mesh.positions.push_back(geometry.positions[corner.position]);
  if (group.hasUvs) {
    mesh.uvs.reserve(corners.size());
    for (const ObjCorner& corner : corners) {
      // A corner without texture coordinates among others takes the origin.
      const vec2 uv = corner.uv == kObjNone ? vec2(0.0f) : geometry.uvs[corner.uv];
      mesh.uvs.emplace_back(uv.x, 1.0f - uv.y);
    }
  }
  if (group.hasNormals) {
    mesh.normals.reserve(corners.size());
    for (const ObjCorner& corner : corners) mesh.normals.push_back(geometry.normals[corner.normal]);
  }
  return mesh;
}

}  // namespace isophote

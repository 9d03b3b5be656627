// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace isophote {

namespace {

uint vertexCount(const Mesh& mesh) { return uint(mesh.positions.size()); }

void addVertex(Mesh& mesh, vec3 position, vec3 normal, vec2 uv) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uvs.push_back(uv);
}

/// Points of a grid, row by row, with what it takes to turn them into triangles.
struct Grid {
  Patch patch;
  std::vector<vec3> points;

  std::size_t index(int column, int row) const {
    return std::size_t(row) * std::size_t(patch.columns + 1) + std::size_t(column);
  }
};

/// Sums of the area-weighted normals of the triangles around each grid point, seams joined.
std::vector<vec3> gridNormals(const Grid& grid) {
  const Patch& patch = grid.patch;
  std::vector<vec3> sums(grid.points.size(), vec3(0.0f));
  for (int row = 0; row < patch.rows; ++row) {
    for (int column = 0; column < patch.columns; ++column) {
      const std::size_t a = grid.index(column, row), b = grid.index(column + 1, row);
      const std::size_t c = grid.index(column + 1, row + 1), d = grid.index(column, row + 1);
      const vec3 normal = cross(grid.points[c] - grid.points[a], grid.points[d] - grid.points[b]);
      for (const std::size_t corner : {a, b, c, d}) sums[corner] += normal;
    }
  }
  const auto join = [&](std::size_t a, std::size_t b) { sums[a] = sums[b] = sums[a] + sums[b]; };
  if (patch.closedColumns) {
    for (int row = 0; row <= patch.rows; ++row) join(grid.index(0, row), grid.index(patch.columns, row));
  }
  if (patch.closedRows) {
    for (int column = 0; column <= patch.columns; ++column)
      join(grid.index(column, 0), grid.index(column, patch.rows));
  }
  for (vec3& sum : sums) sum = normalize(sum);
  return sums;
}

/// Two triangles a grid cell, less those without area (at the poles of a sphere, say).
void addGridTriangles(Mesh& mesh, const Grid& grid, uint first) {
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const vec3 normal = cross(grid.points[b] - grid.points[a], grid.points[c] - grid.points[a]);
    if (length(normal) > 1e-10f)
      mesh.triangles.emplace_back(first + uint(a), first + uint(b), first + uint(c));
  };
  for (int row = 0; row < grid.patch.rows; ++row) {
    for (int column = 0; column < grid.patch.columns; ++column) {
      const std::size_t a = grid.index(column, row), b = grid.index(column + 1, row);
      const std::size_t c = grid.index(column + 1, row + 1), d = grid.index(column, row + 1);
      add(a, b, c);
      add(a, c, d);
    }
  }
}

/// Metres along the middle of a patch, in each direction.
std::vector<float> lengthsAlong(const Grid& grid, bool columns) {
  const int count = columns ? grid.patch.columns : grid.patch.rows;
  const int middle = (columns ? grid.patch.rows : grid.patch.columns) / 2;
  std::vector<float> lengths(std::size_t(count) + 1, 0.0f);
  for (int i = 1; i <= count; ++i) {
    const vec3 here = grid.points[columns ? grid.index(i, middle) : grid.index(middle, i)];
    const vec3 before = grid.points[columns ? grid.index(i - 1, middle) : grid.index(middle, i - 1)];
    lengths[std::size_t(i)] = lengths[std::size_t(i) - 1] + length(here - before);
  }
  return lengths;
}

vec3 onProfile(const ProfilePoint& point, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  const float square = 1.0f / std::max(std::abs(c), std::abs(s));
  const float radius = point.radius * (1.0f + point.squareness * (square - 1.0f));
  return {radius * c, point.height, radius * s};
}

}  // namespace

void addQuad(Mesh& mesh, vec3 corner, vec3 edgeU, vec3 edgeV) {
  const uint first = vertexCount(mesh);
  const vec3 normal = normalize(cross(edgeU, edgeV));
  const float u = length(edgeU), v = length(edgeV);
  addVertex(mesh, corner, normal, {0, v});
  addVertex(mesh, corner + edgeU, normal, {u, v});
  addVertex(mesh, corner + edgeU + edgeV, normal, {u, 0});
  addVertex(mesh, corner + edgeV, normal, {0, 0});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

void addTriangle(Mesh& mesh, vec3 a, vec3 b, vec3 c) {
  const uint first = vertexCount(mesh);
  const vec3 normal = normalize(cross(b - a, c - a));
  const vec3 along = normalize(b - a);
  const vec3 up = cross(normal, along);
  for (const vec3 p : {a, b, c}) addVertex(mesh, p, normal, {dot(p - a, along), -dot(p - a, up)});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
}

void addBox(Mesh& mesh, vec3 lower, vec3 upper) {
  const vec3 size = upper - lower;
  const vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  addQuad(mesh, lower + z, x, y);       // +z
  addQuad(mesh, lower + x, -x, y);      // -z
  addQuad(mesh, upper - y, -z, y);      // +x
  addQuad(mesh, lower, z, y);           // -x
  addQuad(mesh, lower + y + z, x, -z);  // +y
  addQuad(mesh, lower, x, z);           // -y
}

void addRoom(Mesh& mesh, vec3 lower, vec3 upper) {
  Mesh box;
  addBox(box, lower, upper);
  flip(box);
  append(mesh, box);
}

void addSphere(Mesh& mesh, vec3 centre, float radius, int slices, int stacks) {
  Grid grid{{slices, stacks, true, false}, {}};
  const uint first = vertexCount(mesh);
  for (int stack = 0; stack <= stacks; ++stack) {
    // Exact poles: the last ring must collapse into one point.
    const float polar = kPi * float(stack) / float(stacks);
    const float ring = stack == 0 || stack == stacks ? 0.0f : std::sin(polar);
    for (int slice = 0; slice <= slices; ++slice) {
      // The seam's two columns are the same points to the last bit.
      const float azimuth = 2.0f * kPi * float(slice % slices) / float(slices);
      const vec3 normal =
          normalize(vec3(ring * std::sin(azimuth), std::cos(polar), ring * std::cos(azimuth)));
      grid.points.push_back(centre + radius * normal);
      addVertex(mesh, grid.points.back(), normal,
                radius * vec2(2.0f * kPi * float(slice) / float(slices), polar));
    }
  }
  // Rows run downwards here, so columns (eastwards) x rows point inwards: swap.
  const std::size_t before = mesh.triangles.size();
  addGridTriangles(mesh, grid, first);
  for (std::size_t i = before; i < mesh.triangles.size(); ++i)
    std::swap(mesh.triangles[i].y, mesh.triangles[i].z);
}

void addPatch(Mesh& mesh, const Patch& patch, const std::function<vec3(int, int)>& surface) {
  Grid grid{patch, {}};
  for (int row = 0; row <= patch.rows; ++row) {
    for (int column = 0; column <= patch.columns; ++column) {
      grid.points.push_back(surface(patch.closedColumns ? column % patch.columns : column,
                                    patch.closedRows ? row % patch.rows : row));
    }
  }
  const std::vector<vec3> normals = gridNormals(grid);
  const std::vector<float> u = lengthsAlong(grid, true), v = lengthsAlong(grid, false);
  const uint first = vertexCount(mesh);
  for (int row = 0; row <= patch.rows; ++row) {
    for (int column = 0; column <= patch.columns; ++column) {
      const std::size_t at = grid.index(column, row);
      addVertex(mesh, grid.points[at], normals[at], {u[std::size_t(column)], v.back() - v[std::size_t(row)]});
    }
  }
  addGridTriangles(mesh, grid, first);
}

void addSweep(Mesh& mesh, std::span<const ProfilePoint> profile, int columns, bool closed,
              const std::function<vec3(int, const ProfilePoint&)>& surface) {
  constexpr float kSame = 1e-5f;  // [m]; rounding apart
  const auto same = [](const ProfilePoint& a, const ProfilePoint& b) {
    return std::abs(a.radius - b.radius) < kSame && std::abs(a.height - b.height) < kSame;
  };
  std::size_t begin = 0;
  while (begin + 1 < profile.size()) {
    if (same(profile[begin], profile[begin + 1])) {
      ++begin;
      continue;
    }
    std::size_t end = begin + 1;
    while (end + 1 < profile.size() && !same(profile[end], profile[end + 1])) ++end;
    addPatch(mesh, {columns, int(end - begin), closed, false},
             [&](int column, int row) { return surface(column, profile[begin + std::size_t(row)]); });
    begin = end;
  }
}

void addLathe(Mesh& mesh, std::span<const ProfilePoint> profile, int slices) {
  // Turning from x towards -z with the profile upwards puts the front outside.
  addSweep(mesh, profile, slices, true, [&](int slice, const ProfilePoint& point) {
    return onProfile(point, -2.0f * kPi * float(slice) / float(slices));
  });
}

void addMoulding(Mesh& mesh, std::span<const ProfilePoint> profile, vec2 half, bool inwards) {
  // Corners in the order that puts the front outside.
  constexpr std::array<vec2, 5> signs{vec2(-1, 1), vec2(1, 1), vec2(1, -1), vec2(-1, -1), vec2(-1, 1)};
  for (std::size_t side = 0; side < 4; ++side) {
    addSweep(mesh, profile, 1, false, [&](int column, const ProfilePoint& point) {
      const vec2 corner = signs[side + std::size_t(inwards ? 1 - column : column)];
      const vec2 at = corner * (half + (inwards ? -point.radius : point.radius));
      return vec3(at.x, point.height, at.y);
    });
  }
}

void append(Mesh& mesh, const Mesh& part) {
  const uint first = vertexCount(mesh);
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (const uvec3 triangle : part.triangles) mesh.triangles.push_back(triangle + first);
}

void flip(Mesh& mesh) {
  for (vec3& normal : mesh.normals) normal = -normal;
  for (uvec3& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
}

void transform(Mesh& mesh, const mat4x3& to) {
  for (vec3& position : mesh.positions) position = to * vec4(position, 1.0f);
  for (vec3& normal : mesh.normals) normal = normalize(to * vec4(normal, 0.0f));
}

void scaleUvs(Mesh& mesh, float metres) {
  for (vec2& uv : mesh.uvs) uv = uv / metres;
}

mat4x3 turnedAndMoved(float degrees, vec3 to) {
  const float angle = degrees * kPi / 180.0f;
  const float c = std::cos(angle), s = std::sin(angle);
  return {vec3(c, 0, -s), vec3(0, 1, 0), vec3(s, 0, c), to};
}

NamedMaterial lambert(std::string name, vec3 albedo) {
  NamedMaterial material{makeMaterial(), std::move(name)};
  material.baseColour = albedo;
  material.specular = 0.0f;
  return material;
}

std::uint32_t addMaterial(Scene& scene, NamedMaterial material) {
  scene.materials.push_back(std::move(material));
  return std::uint32_t(scene.materials.size() - 1);
}

std::uint32_t addMesh(Scene& scene, std::string name, std::uint32_t material, Mesh mesh) {
  mesh.name = std::move(name);
  mesh.material = material;
  scene.meshes.push_back(std::move(mesh));
  return std::uint32_t(scene.meshes.size() - 1);
}

std::uint32_t addObject(Scene& scene, std::string name, std::uint32_t material, Mesh mesh) {
  const std::uint32_t index = addMesh(scene, name, material, std::move(mesh));
  addInstance(scene, std::move(name), index, mat4x3(1.0f));
  return index;
}

void addInstance(Scene& scene, std::string name, std::uint32_t mesh, const mat4x3& worldFromObject) {
  scene.instances.push_back({std::move(name), mesh, worldFromObject});
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_mesh.h"

#include "scene/gltf_accessor.h"

#include <limits>

namespace isophote {

namespace {

enum Mode : std::uint64_t { kTriangles = 4, kStrip = 5, kFan = 6 };

/// The vertices of a primitive in drawing order, before they are joined to triangles.
std::vector<std::uint32_t> readOrder(const GltfDocument& document, const JsonValue& primitive,
                                     std::size_t vertexCount) {
  const std::optional<std::size_t> accessor = findIndex(document, primitive, "indices", "accessors");
  std::vector<std::uint32_t> order;
  if (!accessor) {
    order.resize(vertexCount);
    for (std::size_t i = 0; i < vertexCount; ++i) order[i] = std::uint32_t(i);
    return order;
  }
  const JsonValue user = primitive.at("indices");
  const GltfAccessor indices(document, *accessor, user, 1);
  if (indices.component() != GltfComponent::kUint8 && indices.component() != GltfComponent::kUint16 &&
      indices.component() != GltfComponent::kUint32)
    user.fail("accessor {} holds no unsigned integers", *accessor);
  order.resize(indices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = indices.index(i);
    if (order[i] >= vertexCount)
      user.fail("entry {} of accessor {} names vertex {}, but there are only {}", i, *accessor, order[i],
                vertexCount);
  }
  return order;
}

/// Joins vertices to triangles as glTF's mode says; those that are left over at the end make none.
std::vector<uvec3> joinTriangles(const std::vector<std::uint32_t>& order, std::uint64_t mode) {
  std::vector<uvec3> triangles;
  const std::size_t count = order.size();
  if (mode == kTriangles) {
    triangles.reserve(count / 3);
    for (std::size_t i = 0; i + 2 < count; i += 3)
      triangles.emplace_back(order[i], order[i + 1], order[i + 2]);
    return triangles;
  }
  for (std::size_t i = 0; i + 2 < count; ++i) {
    if (mode == kFan)
      triangles.emplace_back(order[i + 1], order[i + 2], order[0]);
    else
      triangles.emplace_back(order[i], order[i + 1 + i % 2],
                             order[i + 2 - i % 2]);  // every second one is turned round
  }
  return triangles;
}

/// Renumbers the triangles' vertices without gaps; returns which vertex each new one was.
std::vector<std::uint32_t> keepUsedVertices(std::vector<uvec3>& triangles, std::size_t vertexCount) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> newIndex(vertexCount, kUnused);
  for (const uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) newIndex[t[k]] = 0;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < vertexCount; ++i) {
    if (newIndex[i] == kUnused) continue;
    newIndex[i] = std::uint32_t(kept.size());
    kept.push_back(std::uint32_t(i));
  }
  for (uvec3& t : triangles) t = uvec3(newIndex[t.x], newIndex[t.y], newIndex[t.z]);
  return kept;
}

/// Opens a vertex attribute that must have one element for each position.
std::optional<GltfAccessor> openAttribute(const GltfDocument& document, const JsonValue& attributes,
                                          const std::string& name, int components, std::size_t vertexCount) {
  const std::optional<std::size_t> accessor = findIndex(document, attributes, name, "accessors");
  if (!accessor) return std::nullopt;
  const JsonValue user = attributes.at(name);
  GltfAccessor opened(document, *accessor, user, components);
  if (opened.size() != vertexCount)
    user.fail("accessor {} has {} elements for {} positions", *accessor, opened.size(), vertexCount);
  return opened;
}

/// COLOR_0 has three components or four.
std::optional<GltfAccessor> openColours(const GltfDocument& document, const JsonValue& attributes,
                                        std::size_t vertexCount) {
  const std::optional<std::size_t> accessor = findIndex(document, attributes, "COLOR_0", "accessors");
  if (!accessor) return std::nullopt;
  const bool hasAlpha = document.array("accessors")[*accessor].at("type").string() == "VEC4";
  return openAttribute(document, attributes, "COLOR_0", hasAlpha ? 4 : 3, vertexCount);
}

}  // namespace

const std::vector<std::uint32_t>& GltfMeshes::use(std::size_t index) {
  const auto [entry, isNew] = known_.try_emplace(index);
  if (!isNew) return entry->second;
  const JsonValue& mesh = document_.array("meshes")[index];
  const std::string name = nameOf(mesh, mesh.place());
  const std::vector<JsonValue> primitives = mesh.at("primitives").elements();
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    job_.throwIfStopped();
    readPrimitive(primitives[i], primitives.size() > 1 ? fmt::format("{} primitive {}", name, i) : name,
                  entry->second);
  }
  return entry->second;
}

void GltfMeshes::readPrimitive(const JsonValue& primitive, const std::string& name,
                               std::vector<std::uint32_t>& meshes) {
  const std::uint64_t mode = wholeNumber(primitive, "mode", kTriangles);
  if (mode > kFan) primitive.at("mode").fail("{} is none of glTF's modes 0 to 6", mode);
  if (mode < kTriangles) {
    if (!warnedMode_)
      job_.warn(fmt::format("{}: {} is of points or lines; such are left out", document_.file(),
                            primitive.place()));
    warnedMode_ = true;
    return;
  }
  if (primitive.has("targets") && !warnedMorph_) {
    job_.warn(fmt::format("{}: {} has morph targets; such meshes keep their rest shape", document_.file(),
                          primitive.place()));
    warnedMorph_ = true;
  }
  const JsonValue attributes = primitive.at("attributes");
  const std::optional<std::size_t> positionIndex = findIndex(document_, attributes, "POSITION", "accessors");
  if (!positionIndex) return;  // glTF: such a primitive is to be skipped
  const GltfAccessor positions(document_, *positionIndex, attributes.at("POSITION"), 3);
  if (positions.size() >= std::numeric_limits<std::uint32_t>::max())
    attributes.at("POSITION").fail("has {} vertices; split the mesh", positions.size());

  const GltfMaterials::Use& material =
      materials_.use(findIndex(document_, primitive, "material", "materials"));
  std::optional<GltfAccessor> uvs;
  if (material.uvs) {
    const std::string uvName = fmt::format("TEXCOORD_{}", material.uvs->set);
    uvs = openAttribute(document_, attributes, uvName, 2, positions.size());
  }
  const std::optional<GltfAccessor> normals =
      openAttribute(document_, attributes, "NORMAL", 3, positions.size());
  // Tangents are those of the coordinates as they stand in the file.
  const bool follows = uvs && material.normalMapped && !material.uvs->turns();
  const std::optional<GltfAccessor> tangents =
      follows ? openAttribute(document_, attributes, "TANGENT", 4, positions.size()) : std::nullopt;
  const std::optional<GltfAccessor> colours = openColours(document_, attributes, positions.size());

  Mesh mesh;
  mesh.name = name;
  mesh.material = material.material;
  mesh.triangles = joinTriangles(readOrder(document_, primitive, positions.size()), mode);
  if (mesh.triangles.empty()) return;
  const std::vector<std::uint32_t> kept = keepUsedVertices(mesh.triangles, positions.size());
  // Primitives may share their data, so that a small file can ask for much memory.
  usedBytes_ += mesh.triangles.size() * sizeof(uvec3) +
                kept.size() * (2 * sizeof(vec3) + sizeof(vec2) + (tangents ? sizeof(vec4) : 0) +
                               (colours ? sizeof(vec4) : 0));
  if (usedBytes_ > job_.memoryBudgetBytes)
    fail(ErrorKind::kResources, document_.file(), "its meshes need more than the memory budget of {} bytes",
         job_.memoryBudgetBytes);
  mesh.positions.reserve(kept.size());
  for (const std::uint32_t i : kept) mesh.positions.push_back(positions.vector3(i));
  if (normals) {
    mesh.normals.reserve(kept.size());
    for (const std::uint32_t i : kept) mesh.normals.push_back(normals->vector3(i));
  }
  if (uvs) {
    mesh.uvs.reserve(kept.size());
    for (const std::uint32_t i : kept) mesh.uvs.push_back(material.uvs->apply(uvs->vector2(i)));
  }
  if (tangents) {
    mesh.tangents.reserve(kept.size());
    for (const std::uint32_t i : kept)
      mesh.tangents.emplace_back(tangents->vector3(i), tangents->number(i, 3));
  }
  if (colours) {
    mesh.colours.reserve(kept.size());
    for (const std::uint32_t i : kept)
      mesh.colours.emplace_back(colours->vector3(i),
                                colours->components() == 4 ? colours->number(i, 3) : 1.0f);
  }
  meshes.push_back(std::uint32_t(scene_.meshes.size()));
  scene_.meshes.push_back(std::move(mesh));
}

}  // namespace isophote

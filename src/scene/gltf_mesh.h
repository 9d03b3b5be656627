// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/gltf_document.h"
#include "scene/gltf_material.h"

#include <map>
#include <vector>

namespace isophote {

/// Turns glTF meshes into the scene's, each once and only those that are asked for: one Mesh for each
/// primitive of triangles, with the vertices that its triangles use.
class GltfMeshes {
 public:
  GltfMeshes(GltfDocument& document, Scene& scene, GltfMaterials& materials, const Job& job)
      : document_(document), scene_(scene), materials_(materials), job_(job) {}

  /// Indices in scene.meshes of the primitives of the document's mesh `index`.
  const std::vector<std::uint32_t>& use(std::size_t index);

 private:
  void readPrimitive(const JsonValue& primitive, const std::string& name, std::vector<std::uint32_t>& meshes);

  GltfDocument& document_;
  Scene& scene_;
  GltfMaterials& materials_;
  const Job& job_;
  std::map<std::size_t, std::vector<std::uint32_t>> known_;
  std::uint64_t usedBytes_ = 0;
  bool warnedMode_ = false;
  bool warnedMorph_ = false;
};

}  // namespace isophote

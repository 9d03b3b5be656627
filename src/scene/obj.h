// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <filesystem>

namespace isophote {

/// Loads a Wavefront .obj file with its .mtl files and textures: one mesh and one instance for each pair of
/// object (o or g) and material. Faces with and without normals of one pair become two meshes. Unfinished:
/// finishScene() is the caller's. How MTL's Phong terms become a Material is said in obj_material.h. Throws
/// Error(kBadInput) naming file and line; a missing .mtl file or material is grey with a warning.
Scene loadObj(const std::filesystem::path& file, const Job& job = {});

}  // namespace isophote

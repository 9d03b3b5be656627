// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <filesystem>

namespace isophote {

/// Loads a glTF 2.0 file (.gltf or .glb): the default scene (else the first, else all root nodes) in its rest
/// pose, as one Mesh for each primitive and one Instance for each node and primitive.
///
/// Extensions: KHR_lights_punctual (candela is read as W/sr, lux as W/m^2), KHR_materials_transmission, _ior,
/// _specular (factor), _volume (only whether the material is a solid: without thickness it is a thin pane),
/// _emissive_strength, KHR_texture_transform. Alpha blending is read as a mask at one half. Not read:
/// animations, skins, morph targets, normal maps, vertex colours, and further extensions; the last are
/// refused where the file requires them, with a sentence that names them.
///
/// Unfinished: finishScene() is the caller's. Throws Error(kBadInput) naming file and element.
Scene loadGltf(const std::filesystem::path& file, const Job& job = {});

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <string>

namespace isophote {

/// What became of an appended model.
struct MergedModel {
  std::vector<Instance>
      instances;  ///< Still in the model's space, with mesh an index into the scene: for more copies.
  std::size_t firstMaterial = 0;
  std::size_t materialCount = 0;
};

/// Moves everything that an unfinished `model` holds, but its instances, to the end of `scene`. Lights and
/// cameras go through worldFromModel; lights keep their power.
MergedModel appendModel(Scene& scene, Scene&& model, const mat4x3& worldFromModel);

/// Adds the model's instances, placed by worldFromModel. `name` is put before theirs ("left/wheel") unless
/// empty.
void placeModel(Scene& scene, const MergedModel& model, const mat4x3& worldFromModel,
                const std::string& name);

}  // namespace isophote

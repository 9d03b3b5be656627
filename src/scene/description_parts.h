// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/json_value.h"
#include "scene/scene.h"

#include <span>
#include <string>

namespace isophote {

/// One element of "lights". That of an environment with a map lacks the map.
Light readLight(const JsonValue& value);

/// "camera", or one element of "cameras".
Camera readCamera(const JsonValue& value);

/// Changes what an element of "materials" names, in glTF's spelling; what it does not name stays.
void overrideMaterial(Material& material, const JsonValue& overrides);

/// "translation", "rotation" and "scale" of a model.
mat4x3 readTransform(const JsonValue& model);

}  // namespace isophote

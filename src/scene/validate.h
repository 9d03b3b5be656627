// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <string>

namespace isophote {

/// Coordinates and sizes beyond this are refused: products of three of them still fit a float [m].
inline constexpr float kLargestCoordinate = 1e12f;

/// Checks every index and number of a scene as loaders and hosts build it. Throws Error(kBadInput, subject)
/// that names the element at fault. Repairs what is harmless: light directions and normals are made unit
/// length (a zero normal becomes that of its triangles), material factors outside [0, 1] are clamped with a
/// warning.
void validateScene(Scene& scene, const std::string& subject, const Job& job);

/// The same checks for one camera.
void validateCamera(const Camera& camera, const std::string& subject);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace isophote {

/// Total power, mean of RGB [W]; see Light::power. Mesh lights carry theirs already.
float lightPower(const Light& light, const Bounds& bounds);

/// Turns every instance whose material emits into one mesh light, with its triangles in
/// scene.emissiveTriangles.
void addMeshLights(Scene& scene);

}  // namespace isophote

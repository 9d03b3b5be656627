// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace isophote {

/// Of all triangles of all instances, in world space, one side each [m^2].
double surfaceArea(const Scene& scene);

}  // namespace isophote

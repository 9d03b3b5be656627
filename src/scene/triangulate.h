// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <span>
#include <vector>

namespace isophote {

/// Appends the corners.size() - 2 triangles of a simple polygon, as indices into its corners and in its
/// winding: a fan where the polygon is convex, ears cut off where it is not. A polygon that is no simple one
/// (crossing edges, no area) still gets that many triangles.
void triangulatePolygon(std::span<const vec3> corners, std::vector<uvec3>& triangles);

}  // namespace isophote

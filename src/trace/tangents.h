// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <vector>

namespace isophote {

/// The tangents that normal maps of a mesh follow, packTangent()ed, one for each corner of each triangle:
/// Mesh::tangents where it has them; else along growing u, averaged at each vertex over its triangles by
/// their angle there, those that mirror the texture apart from those that do not, and perpendicular to the
/// normal. kNoDirection where texture coordinates give no direction. Empty for a mesh without coordinates.
std::vector<uint> cornerTangents(const Mesh& mesh);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <optional>

namespace isophote {

/// Where a light stands: a point's or spot's centre, a rectangle's middle. None for what has no place of its
/// own: suns, environments and emissive meshes.
std::optional<vec3> lightPosition(const Light& light);

/// Whether a light has a direction that may be chosen: spots and suns.
bool hasAim(const Light& light);

/// The light, standing there [m]. Throws Error(kBadUsage) where it has no place, or that is none.
Light movedLight(Light light, vec3 position);

/// The light, shining that way (of any length but 0); a sun's power follows from the scene's bounds. Throws
/// Error(kBadUsage) where it has no direction, or that is none.
Light aimedLight(Light light, vec3 direction, const Bounds& bounds);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace isophote {

/// Total power, mean of RGB [W]; see Light::power. Mesh lights and environments with a map carry theirs
/// already.
float lightPower(const Light& light, const Bounds& bounds);

/// A spot of that total flux [W], full up to the inner angle from its axis and none from the outer on
/// (0 <= inner <= outer <= 90, outer > 0); position and direction are left open.
Light spotLight(float innerDegrees, float outerDegrees, vec3 watts);

/// What shines from everywhere outside: that radiance, or Scene::environment's times that colour, its middle
/// towards -Z, turned counter-clockwise as seen from above.
Light environmentLight(vec3 colour, bool mapped, double rotationDegrees);

}  // namespace isophote

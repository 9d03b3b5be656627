// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <string>

namespace isophote {

/// Adds what a scene needs to be seen and does not say. Wants validated meshes and bounds.
///
/// No camera: rays from the middle of the bounds tell which of three kinds of scene it is. Fronts are told by
/// the winding alone: many files call all their surfaces double-sided, closed statues too.
/// - An object (most rays escape, or meet backs of surfaces): seen from outside, three quarters from the
///   right and a little above, the whole in view at an aspect of 4:3 and wider.
/// - A stage (most rays meet fronts, but a horizontal side is open): seen through the open side.
/// - A room (fronts all around): seen from inside, from one end of the longer horizontal axis towards the
///   other.
///
/// No light: an object gets a sun of 2.7 W/m^2 from high behind the camera and a sky of 0.25 W/(m^2 sr), in
/// which white just stays below 1; stages and rooms get a point light in the upper middle that gives about 10
/// W/m^2 at the height of the middle. A warning says so.
void addDefaults(Scene& scene, const std::string& subject, const Job& job);

}  // namespace isophote

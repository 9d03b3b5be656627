// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
// For tests, benchmarks and the suites of isophote bench.
#pragma once

#include "scene/scene.h"

#include <cmath>

namespace isophote {

/// The ring, its lamp a spot without extent that just lights it: what bounce maps are for, and whose caustic
/// is sharp.
inline Scene spottedRing() {
  Scene scene = loadScene("caustic-ring");
  Light& lamp = scene.lights.front();
  lamp.type = kLightSpot;
  lamp.radius = 0;
  lamp.direction = normalize(-lamp.position);
  lamp.cosInner = std::cos(0.25f);
  lamp.cosOuter = std::cos(0.28f);
  finishScene(scene, "caustic-ring");
  return scene;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// cornell-box: the standard room for checking indirect light: white, red and green Lambertian walls, two
// white boxes, a lamp in the ceiling. 2 m wide (see addCornellRoom()).
#include "scene/builtin/cornell_room.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

namespace isophote {

namespace {

/// A box of square plan that stands on the floor.
Mesh makeStandingBox(float side, float height, float degrees, vec2 centreXz) {
  Mesh mesh;
  addBox(mesh, {-0.5f * side, 0, -0.5f * side}, {0.5f * side, height, 0.5f * side});
  transform(mesh, turnedAndMoved(degrees, {centreXz.x, 0, centreXz.y}));
  return mesh;
}

}  // namespace

Scene makeCornellBox() {
  Scene scene;
  scene.name = "cornell-box";
  const auto white = addCornellRoom(scene, {});
  addObject(scene, "tall box", white, makeStandingBox(0.6f, 1.2f, 17, {-0.34f, -0.28f}));
  addObject(scene, "short box", white, makeStandingBox(0.6f, 0.6f, -17, {0.33f, 0.36f}));
  return scene;
}

}  // namespace isophote

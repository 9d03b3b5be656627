// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// two-rooms: a lamp in one of two rooms, and a wall of two centimetres between them. No light reaches the
// other room, so that all that an estimate shows there has leaked. Both are open towards the camera, where
// light leaves and nothing returns it; a point light, seen by bounce maps.
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

namespace isophote {

Scene makeTwoRooms() {
  Scene scene;
  scene.name = "two-rooms";
  const auto walls = addMaterial(scene, lambert("walls", {0.75f, 0.72f, 0.66f}));
  const auto partition = addMaterial(scene, lambert("partition", {0.7f, 0.45f, 0.3f}));
  Mesh shell, wall;
  addQuad(shell, {-2, 0, 1}, {4, 0, 0}, {0, 0, -2});
  addQuad(shell, {-2, 2, -1}, {4, 0, 0}, {0, 0, 2});
  addQuad(shell, {-2, 0, -1}, {4, 0, 0}, {0, 2, 0});
  addQuad(shell, {-2, 0, 1}, {0, 0, -2}, {0, 2, 0});
  addQuad(shell, {2, 0, -1}, {0, 0, 2}, {0, 2, 0});
  // Beyond floor, ceiling and back wall, so that no ray slips past its edges.
  addBox(wall, {-0.01f, -0.05f, -1.05f}, {0.01f, 2.05f, 1.05f});
  addObject(scene, "shell", walls, std::move(shell));
  addObject(scene, "partition", partition, std::move(wall));

  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = {-1, 1.6f, 0.1f};
  lamp.colour = {1.4f, 1.3f, 1.15f};
  scene.lights.push_back(lamp);
  scene.cameras.push_back({.name = "front",
                           .eye = {0.5f, 1, 4.6f},
                           .target = {0.05f, 0.95f, 0},
                           .verticalFovDegrees = 36,
                           .aspect = 16.0f / 9.0f});
  return scene;
}

}  // namespace isophote

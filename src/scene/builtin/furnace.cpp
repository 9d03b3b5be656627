// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// furnace, furnace-box: closed rooms whose right picture is known to the last digit. Every wall is Lambertian
// with the albedo rho = 0.5 and emits Le = 1 W/(m^2 sr) inwards. In a closed convex room the radiance that
// arrives is then the same from everywhere, whatever the room's shape, so the answer holds for the polyhedron
// itself and not only for the sphere that it stands for (hence no vertex normals here: interpolated ones
// would break it):
//
//   emitted  = Le                                                 = 1
//   direct   = Le rho                                             = 0.5
//   indirect = Le (rho^2 + ... + rho^(N+1)) for N indirect bounces: 0.25, 0.375, 0.4375, ... -> 0.5
//   all      = Le / (1 - rho) in the limit                        = 2
//
// at every pixel. The sphere has radius 1 m, the cube sides of 2 m; the camera is inside.
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

namespace isophote {

namespace {

Scene makeFurnaceOf(std::string name, Mesh walls) {
  Scene scene;
  scene.name = std::move(name);
  NamedMaterial glowing = lambert("glowing", vec3(0.5f));
  glowing.emission = vec3(1.0f);
  walls.normals.clear();
  addObject(scene, "walls", addMaterial(scene, glowing), std::move(walls));
  scene.cameras.push_back({.name = "inside",
                           .eye = {0, 0, 0.5f},
                           .target = {0.1f, -0.2f, -1},
                           .verticalFovDegrees = 60,
                           .aspect = 1});
  return scene;
}

}  // namespace

Scene makeFurnace() {
  Mesh walls;
  addSphere(walls, vec3(0.0f), 1.0f, 128, 64);
  flip(walls);
  return makeFurnaceOf("furnace", std::move(walls));
}

Scene makeFurnaceBox() {
  Mesh walls;
  addRoom(walls, vec3(-1.0f), vec3(1.0f));
  return makeFurnaceOf("furnace-box", std::move(walls));
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// glass-sphere: specular paths of every kind in one small room: the lamp's caustic through a solid glass
// sphere (two refractions), its reflection off a mirror sphere, and both seen in each other. Everything else
// is Lambertian.
#include "scene/builtin/cornell_room.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

namespace isophote {

namespace {

constexpr float kRadius = 0.4f;
/// Gap under the spheres, so that their lowest points and the floor are not one surface [m].
constexpr float kGap = 0.001f;

Mesh makeBall(vec2 centreXz) {
  Mesh mesh;
  addSphere(mesh, {centreXz.x, kRadius + kGap, centreXz.y}, kRadius, 160, 80);
  return mesh;
}

}  // namespace

Scene makeGlassSphere() {
  Scene scene;
  scene.name = "glass-sphere";
  addCornellRoom(scene, {.left = {0.66f, 0.28f, 0.06f}, .right = {0.08f, 0.22f, 0.58f}});

  NamedMaterial mirror{makeMaterial(), "mirror"};
  mirror.baseColour = vec3(0.95f);
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  addObject(scene, "mirror sphere", addMaterial(scene, mirror), makeBall({-0.45f, -0.4f}));

  NamedMaterial glass{makeMaterial(), "glass"};
  glass.transmission = 1.0f;
  glass.roughness = 0.0f;
  addObject(scene, "glass sphere", addMaterial(scene, glass), makeBall({0.42f, 0.25f}));
  return scene;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// cornell-objects: one of each kind of surface in a Cornell room, after figure 6 of the paper on image space
// photon mapping: a vase of brushed purple metal, a sphere of glass with little refraction, a mirror sphere,
// a white box. Its lamp has an area, so that a path tracer that starts at the eye finds every caustic.
#include "scene/builtin/cornell_room.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

#include <array>

namespace isophote {

namespace {

/// Gap under the objects, so that none shares a surface with the floor [m].
constexpr float kGap = 0.001f;

/// A vase with a foot, a belly and a neck, closed on top.
Mesh makeVase(vec2 centreXz) {
  constexpr std::array profile{
      ProfilePoint{0.0f, 0.0f},   ProfilePoint{0.17f, 0.0f},  ProfilePoint{0.17f, 0.0f},
      ProfilePoint{0.17f, 0.03f}, ProfilePoint{0.12f, 0.08f}, ProfilePoint{0.13f, 0.16f},
      ProfilePoint{0.21f, 0.30f}, ProfilePoint{0.26f, 0.44f}, ProfilePoint{0.25f, 0.58f},
      ProfilePoint{0.17f, 0.72f}, ProfilePoint{0.10f, 0.82f}, ProfilePoint{0.09f, 0.92f},
      ProfilePoint{0.14f, 1.0f},  ProfilePoint{0.14f, 1.0f},  ProfilePoint{0.0f, 1.0f}};
  Mesh mesh;
  addLathe(mesh, profile, 64);
  transform(mesh, turnedAndMoved(0, {centreXz.x, kGap, centreXz.y}));
  return mesh;
}

Mesh makeBall(vec2 centreXz, float radius) {
  Mesh mesh;
  addSphere(mesh, {centreXz.x, radius + kGap, centreXz.y}, radius, 128, 64);
  return mesh;
}

Mesh makeStandingBox(float side, float height, float degrees, vec2 centreXz) {
  Mesh mesh;
  addBox(mesh, {-0.5f * side, 0, -0.5f * side}, {0.5f * side, height, 0.5f * side});
  transform(mesh, turnedAndMoved(degrees, {centreXz.x, kGap, centreXz.y}));
  return mesh;
}

}  // namespace

Scene makeCornellObjects() {
  Scene scene;
  scene.name = "cornell-objects";
  const auto white = addCornellRoom(scene, {});

  NamedMaterial purple{makeMaterial(), "purple"};
  purple.baseColour = {0.6f, 0.25f, 0.75f};
  purple.metallic = 1.0f;
  purple.roughness = 0.35f;
  addObject(scene, "vase", addMaterial(scene, purple), makeVase({-0.5f, -0.25f}));

  NamedMaterial glass{makeMaterial(), "glass"};
  glass.transmission = 1.0f;
  glass.roughness = 0.0f;
  glass.ior = 1.3f;
  addObject(scene, "glass sphere", addMaterial(scene, glass), makeBall({-0.05f, 0.45f}, 0.3f));

  NamedMaterial mirror{makeMaterial(), "mirror"};
  mirror.baseColour = {0.93f, 0.92f, 0.9f};
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  addObject(scene, "mirror sphere", addMaterial(scene, mirror), makeBall({0.62f, 0.4f}, 0.24f));

  addObject(scene, "box", white, makeStandingBox(0.5f, 0.9f, 22, {0.42f, -0.4f}));
  return scene;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// colour-bleed: the least scene in which coloured indirect light is plain to see, for tests that must be fast
// and for comparing engines by hand. A closed room (no photon escapes) with saturated side walls, a white box
// and a green pyramid: 30 triangles. Everything is Lambertian; the light is a true point.
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

namespace isophote {

namespace {

/// The room's corners [m].
constexpr vec3 kLower{-2, 0, -2};
constexpr vec3 kUpper{2, 3, 2};

Mesh makePyramid(float halfSide, float height) {
  const vec3 a(-halfSide, 0, halfSide), b(halfSide, 0, halfSide), c(halfSide, 0, -halfSide),
      d(-halfSide, 0, -halfSide);
  const vec3 top(0, height, 0);
  Mesh mesh;
  addTriangle(mesh, a, b, top);
  addTriangle(mesh, b, c, top);
  addTriangle(mesh, c, d, top);
  addTriangle(mesh, d, a, top);
  addQuad(mesh, d, c - d, a - d);
  return mesh;
}

}  // namespace

Scene makeColourBleed() {
  Scene scene;
  scene.name = "colour-bleed";
  const auto white = addMaterial(scene, lambert("white", vec3(0.75f)));
  const auto red = addMaterial(scene, lambert("red", {0.75f, 0.04f, 0.03f}));
  const auto blue = addMaterial(scene, lambert("blue", {0.03f, 0.10f, 0.75f}));
  const auto yellow = addMaterial(scene, lambert("yellow", {0.75f, 0.55f, 0.03f}));
  const auto green = addMaterial(scene, lambert("green", {0.05f, 0.65f, 0.08f}));

  const vec3 size = kUpper - kLower;
  const vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  Mesh plain, left, right, back;
  addQuad(plain, kLower + z, x, -z);      // floor
  addQuad(plain, kLower + y, x, z);       // ceiling
  addQuad(plain, kLower + x + z, -x, y);  // behind the camera
  addObject(scene, "floor, ceiling and front", white, std::move(plain));
  addQuad(left, kLower + z, -z, y);
  addObject(scene, "left wall", red, std::move(left));
  addQuad(right, kLower + x, z, y);
  addObject(scene, "right wall", blue, std::move(right));
  addQuad(back, kLower, x, y);
  addObject(scene, "back wall", yellow, std::move(back));

  Mesh box;
  addBox(box, {-0.5f, 0, -0.5f}, {0.5f, 1.2f, 0.5f});
  transform(box, turnedAndMoved(28, {-0.65f, 0, -0.85f}));
  addObject(scene, "box", white, std::move(box));
  Mesh pyramid = makePyramid(0.45f, 0.9f);
  transform(pyramid, turnedAndMoved(-15, {0.85f, 0, -0.35f}));
  addObject(scene, "pyramid", green, std::move(pyramid));

  Light light{};
  light.type = kLightPoint;
  light.position = {0.2f, 2.5f, 0.3f};
  light.colour = vec3(4.5f);
  scene.lights.push_back(light);
  scene.cameras.push_back(
      {.name = "front", .eye = {0, 1.5f, 1.95f}, .target = {0, 1.1f, -2}, .verticalFovDegrees = 68});
  return scene;
}

}  // namespace isophote

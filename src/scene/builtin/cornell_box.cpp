// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// cornell-box: the standard room for checking indirect light. White, red and green Lambertian walls, two
// white boxes. The room is the cube x, z in [-1, 1], y in [0, 2] metres, open at z = 1, where the camera's
// picture (aspect 1) ends exactly at its edges. The lamp is an emissive quad set flush into the ceiling, so
// that no light is caught above it and the surface has no gap.
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

#include <array>

namespace isophote {

namespace {

/// Half the sides of the lamp along x and z [m].
constexpr float kLampHalfX = 0.26f;
constexpr float kLampHalfZ = 0.21f;

/// A rectangle at height y that looks downwards.
void addCeiling(Mesh& mesh, vec2 lowerXz, vec2 upperXz, float y) {
  addQuad(mesh, {lowerXz.x, y, lowerXz.y}, {upperXz.x - lowerXz.x, 0, 0}, {0, 0, upperXz.y - lowerXz.y});
}

/// Floor, back wall and the frame of ceiling around the lamp.
Mesh makeWhiteWalls() {
  Mesh mesh;
  addQuad(mesh, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
  addQuad(mesh, {-1, 0, -1}, {2, 0, 0}, {0, 2, 0});
  // Eight rectangles that share whole edges: no T-junction for a rasteriser to leave a gap at.
  constexpr std::array x{-1.0f, -kLampHalfX, kLampHalfX, 1.0f};
  constexpr std::array z{-1.0f, -kLampHalfZ, kLampHalfZ, 1.0f};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const bool lamp = i == 1 && j == 1;
      if (!lamp) addCeiling(mesh, {x[i], z[j]}, {x[i + 1], z[j + 1]}, 2);
    }
  }
  return mesh;
}

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
  const auto white = addMaterial(scene, lambert("white", {0.73f, 0.72f, 0.69f}));
  const auto red = addMaterial(scene, lambert("red", {0.62f, 0.06f, 0.05f}));
  const auto green = addMaterial(scene, lambert("green", {0.13f, 0.46f, 0.10f}));
  NamedMaterial lampMaterial = lambert("lamp", vec3(0.0f));
  lampMaterial.emission = {16.0f, 12.5f, 8.0f};
  const auto lamp = addMaterial(scene, lampMaterial);

  addObject(scene, "floor, back and ceiling", white, makeWhiteWalls());
  Mesh left, right, lampMesh;
  addQuad(left, {-1, 0, 1}, {0, 0, -2}, {0, 2, 0});
  addObject(scene, "left wall", red, std::move(left));
  addQuad(right, {1, 0, -1}, {0, 0, 2}, {0, 2, 0});
  addObject(scene, "right wall", green, std::move(right));
  addObject(scene, "tall box", white, makeStandingBox(0.6f, 1.2f, 17, {-0.34f, -0.28f}));
  addObject(scene, "short box", white, makeStandingBox(0.6f, 0.6f, -17, {0.33f, 0.36f}));
  addCeiling(lampMesh, {-kLampHalfX, -kLampHalfZ}, {kLampHalfX, kLampHalfZ}, 2);
  addObject(scene, "lamp", lamp, std::move(lampMesh));

  // The opening is 2 m high and 2.8 m away: the field of view is 2 atan(1 / 2.8).
  scene.cameras.push_back({.name = "front",
                           .eye = {0, 1, 3.8f},
                           .target = {0, 1, 0},
                           .verticalFovDegrees = 39.3076f,
                           .aspect = 1});
  return scene;
}

}  // namespace isophote

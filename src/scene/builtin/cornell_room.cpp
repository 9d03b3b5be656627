// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/cornell_room.h"

#include "scene/builtin/shapes.h"

#include <array>

namespace isophote {

namespace {

/// Half the sides of the lamp along x and z [m].
constexpr float kLampHalfX = 0.26f;
constexpr float kLampHalfZ = 0.21f;

/// A rectangle of the ceiling; looks downwards.
void addCeiling(Mesh& mesh, vec2 lowerXz, vec2 upperXz) {
  addQuad(mesh, {lowerXz.x, 2, lowerXz.y}, {upperXz.x - lowerXz.x, 0, 0}, {0, 0, upperXz.y - lowerXz.y});
}

/// Floor, back wall and the ceiling around the lamp.
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
      if (!lamp) addCeiling(mesh, {x[i], z[j]}, {x[i + 1], z[j + 1]});
    }
  }
  return mesh;
}

}  // namespace

std::uint32_t addCornellRoom(Scene& scene, const CornellRoom& room) {
  const auto white = addMaterial(scene, lambert("white", room.white));
  const auto leftColour = addMaterial(scene, lambert("left", room.left));
  const auto rightColour = addMaterial(scene, lambert("right", room.right));
  NamedMaterial lampMaterial = lambert("lamp", vec3(0.0f));
  lampMaterial.emission = {27.0f, 22.0f, 15.5f};
  const auto lampLight = addMaterial(scene, lampMaterial);

  Mesh left, right, lamp;
  addQuad(left, {-1, 0, 1}, {0, 0, -2}, {0, 2, 0});
  addQuad(right, {1, 0, -1}, {0, 0, 2}, {0, 2, 0});
  addCeiling(lamp, {-kLampHalfX, -kLampHalfZ}, {kLampHalfX, kLampHalfZ});
  addObject(scene, "floor, back and ceiling", white, makeWhiteWalls());
  addObject(scene, "left wall", leftColour, std::move(left));
  addObject(scene, "right wall", rightColour, std::move(right));
  addObject(scene, "lamp", lampLight, std::move(lamp));

  // The opening is 2 m high and 2.8 m away: the field of view is 2 atan(1 / 2.8).
  scene.cameras.push_back({.name = "front",
                           .eye = {0, 1, 3.8f},
                           .target = {0, 1, 0},
                           .verticalFovDegrees = 39.3076f,
                           .aspect = 1});
  return white;
}

}  // namespace isophote

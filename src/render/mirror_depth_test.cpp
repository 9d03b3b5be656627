// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cpu_frame.h"
#include "render/reference.h"
#include "scene/builtin/shapes.h"

#include <gtest/gtest.h>

namespace isophote {
namespace {

/// Two perfect mirrors face each other along a corridor that ends in a glowing wall.
Scene mirrorCorridor(float length) {
  Scene scene;
  NamedMaterial mirror{makeMaterial(), "mirror"};
  mirror.baseColour = vec3(1.0f);
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  NamedMaterial glow{makeMaterial(), "glow"};
  glow.emission = vec3(1.0f);
  Mesh mirrors, end;
  addQuad(mirrors, {-0.5f, -5, 1}, {0, 0, -length - 1}, {0, 10, 0});
  addQuad(mirrors, {0.5f, -5, -length}, {0, 0, length + 1}, {0, 10, 0});
  addQuad(end, {-0.5f, -5, -length}, {1, 0, 0}, {0, 10, 0});
  addObject(scene, "mirrors", addMaterial(scene, mirror), std::move(mirrors));
  addObject(scene, "end", addMaterial(scene, glow), std::move(end));
  scene.cameras.push_back({.name = "c", .eye = vec3(0), .target = {1, 0, -1}, .verticalFovDegrees = 1});
  finishScene(scene, "corridor");
  return scene;
}

/// Light runs along the wall of a drinking glass as in a fibre, reflected some twenty or thirty times; where
/// it is given up, glass looks black. Here each metre is one reflection.
TEST(MirrorDepth, SufficesForLightWithinTheWallOfAGlass) {
  const Scene scene = mirrorCorridor(29.0f);
  RenderSettings settings;
  settings.frame.width = settings.frame.height = 4;
  settings.photonTrace.photons = 10;
  Stats stats;
  const Film film = renderCpu(scene, scene.cameras.front(), settings, stats);
  for (const vec3& pixel : film.layers.at("emitted").pixels) EXPECT_NEAR(pixel.x, 1.0f, 1e-3f);
  ReferenceSettings reference;
  reference.width = reference.height = 4;
  reference.spp = 4;
  const Film expected = renderReference(scene, scene.cameras.front(), reference, stats);
  for (const vec3& pixel : expected.layers.at("emitted").pixels) EXPECT_NEAR(pixel.x, 1.0f, 1e-3f);
}

}  // namespace
}  // namespace isophote

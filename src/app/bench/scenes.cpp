// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/scenes.h"

#include "scene/builtin/shapes.h"

#include <fmt/format.h>

#include <array>

namespace isophote::bench {
namespace {

/// A model under one lamp, and what stands in for it.
struct KnownScene {
  PublicScene scene;
  const char* name;
  const char* model;  ///< Below a folder of assets.
  vec3 lamp;
  float watts;
  Camera camera;
  const char* standIn;  ///< A built-in scene.
};

std::span<const KnownScene> knownScenes() {
  static const std::array scenes{
      KnownScene{PublicScene::kSponzaDabrovic,
                 "Sponza (Dabrovic's)",
                 "sponza-dabrovic/sponza.obj",
                 {0, 7, 0},
                 1500,
                 {.name = "", .eye = {13.5f, 2.2f, 0}, .target = {-4, 4, 0}, .verticalFovDegrees = 60},
                 "atrium"},
      KnownScene{
          PublicScene::kSponzaCrytek,
          "Sponza (Crytek's)",
          "sponza-crytek/sponza.gltf",
          {0, 4.5f, -0.3f},
          1500,
          {.name = "", .eye = {8.5f, 1.6f, -0.3f}, .target = {-2, 2.6f, -0.3f}, .verticalFovDegrees = 60},
          "atrium"},
      KnownScene{PublicScene::kSibenik,
                 "Sibenik",
                 "sibenik/sibenik.obj",
                 {0, -4, 0},
                 2000,
                 {.name = "", .eye = {-15, -11, 0}, .target = {10, -8, 0}, .verticalFovDegrees = 60},
                 "atrium"},
      KnownScene{
          PublicScene::kConference,
          "Conference",
          "conference/conference.obj",
          {1.4f, 2.2f, -0.8f},
          150,
          {.name = "", .eye = {5.8f, 1.7f, 1.9f}, .target = {0, 0.8f, -1.2f}, .verticalFovDegrees = 55},
          "cornell-objects"},
  };
  return scenes;
}

const KnownScene& known(PublicScene wanted) {
  for (const KnownScene& scene : knownScenes())
    if (scene.scene == wanted) return scene;
  return knownScenes().front();
}

void setLamp(Scene& scene, vec3 position, float watts) {
  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = position;
  lamp.colour = vec3(watts / (4.0f * kPi));
  scene.lights = {lamp};
}

}  // namespace

SceneChoice choosePublicScene(PublicScene wanted, std::span<const std::filesystem::path> folders,
                              const Job& job) {
  if (wanted == PublicScene::kRing) return {mirrorRing(), "ring of 128 triangles", false};
  const KnownScene& scene = known(wanted);
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path file = folder / scene.model;
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) continue;
    SceneChoice choice{loadScene(file.string(), {}, job), scene.name, false};
    setLamp(choice.scene, scene.lamp, scene.watts);
    choice.scene.cameras = {scene.camera};
    finishScene(choice.scene, scene.model, job);
    return choice;
  }
  return {loadScene(scene.standIn, {}, job), fmt::format("{}, for {}", scene.standIn, scene.name), true};
}

Scene mirrorRing() {
  Scene scene;
  Mesh room, cylinder;
  addQuad(room, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
  addQuad(room, {-2, 3, -2}, {4, 0, 0}, {0, 0, 4});
  addQuad(room, {-2, 0, -2}, {4, 0, 0}, {0, 3, 0});
  addQuad(room, {-2, 0, 2}, {0, 0, -4}, {0, 3, 0});
  addQuad(room, {2, 0, -2}, {0, 0, 4}, {0, 3, 0});
  const std::array profile{ProfilePoint{0.7f, 0.0f}, ProfilePoint{0.7f, 0.3f}};
  addLathe(cylinder, profile, 64);
  NamedMaterial mirror{makeMaterial(), "mirror"};
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  mirror.baseColour = vec3(0.9f);
  addObject(scene, "room", addMaterial(scene, lambert("room", vec3(0.6f))), room);
  addObject(scene, "ring", addMaterial(scene, mirror), cylinder);
  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = {-1.4f, 1.5f, 0};
  lamp.colour = vec3(8.0f);
  scene.lights = {lamp};
  scene.cameras = {{.name = "", .eye = {0, 1.9f, 1.9f}, .target = {0, 0, -0.2f}, .verticalFovDegrees = 60}};
  finishScene(scene, "ring");
  return scene;
}

}  // namespace isophote::bench

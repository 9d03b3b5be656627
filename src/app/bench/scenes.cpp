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

Light pointLight(vec3 position, vec3 watts) {
  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = position;
  lamp.colour = watts / (4.0f * kPi);
  return lamp;
}

constexpr std::size_t kLevelLamps = 30;

/// The lamps of scenes/zdm2-lamps.json: cold, warm and white ones in turns.
void setLevelLamps(Scene& scene, std::span<const vec3> positions) {
  constexpr std::array kWatts{vec3(17, 22, 32), vec3(32, 21, 12), vec3(30, 28, 25)};
  scene.lights.clear();
  for (std::size_t i = 0; i < positions.size(); ++i)
    scene.lights.push_back(pointLight(positions[i], kWatts[i % kWatts.size()]));
}

/// A model whose own lights, or lack of them, do not matter: warnings about them say nothing.
Scene loadUnlit(const std::filesystem::path& file, const Job& job) {
  Job quiet = job;
  quiet.log = {};
  return loadScene(file.string(), {}, quiet);
}

SceneChoice level(const std::filesystem::path& file, const Job& job) {
  constexpr std::array<vec3, kLevelLamps> kPositions{
      vec3(-17.48f, 3.78f, 10.53f),   vec3(-21.69f, 3.58f, 7.97f),   vec3(-15.91f, 2.18f, 15.44f),
      vec3(-20.35f, 3.78f, 17.42f),   vec3(-22.42f, 3.58f, 1.16f),   vec3(-17.64f, 2.18f, -1.46f),
      vec3(-21.59f, 3.58f, 12.81f),   vec3(-17.48f, 2.18f, 3.3f),    vec3(-18.88f, 1.38f, -12.9f),
      vec3(-7.3f, 0.58f, -0.77f),     vec3(-16.55f, -4.62f, -6.41f), vec3(-2.31f, -1.02f, 0.86f),
      vec3(-15.56f, -1.1f, 8.91f),    vec3(-23.29f, 3.58f, -3.97f),  vec3(-18.2f, 1.38f, -18.99f),
      vec3(-13.03f, -4.22f, -18.85f), vec3(-23.22f, -5.82f, -8.01f), vec3(-20.01f, 2.98f, -8.74f),
      vec3(10.1f, 0.58f, 16.69f),     vec3(7.31f, -1.02f, -0.31f),   vec3(-1.12f, -0.81f, 5.93f),
      vec3(0.14f, -3.42f, -4.62f),    vec3(-8.25f, 0.18f, -21.44f),  vec3(-8.23f, 3.78f, -7.99f),
      vec3(-11.9f, -4.22f, -9.49f),   vec3(1.25f, -4.22f, -8.92f),   vec3(-10.58f, 2.18f, 17.95f),
      vec3(7.84f, -1.02f, -5.89f),    vec3(12.08f, -1.02f, -0.82f),  vec3(-7.21f, 11.78f, -8.58f)};
  SceneChoice choice{loadUnlit(file, job), "game level, 30 lamps", false};
  setLevelLamps(choice.scene, kPositions);
  choice.scene.cameras = {
      {.name = "hall", .eye = {-13.5f, 3.4f, 15.6f}, .target = {-21, 2.4f, 9.5f}, .verticalFovDegrees = 60}};
  finishScene(choice.scene, choice.name, job);
  return choice;
}

SceneChoice levelStandIn(const Job& job) {
  SceneChoice choice{loadScene("atrium", {}, job), "atrium with 30 lamps, for a game level", true};
  const Bounds& bounds = choice.scene.bounds;
  std::vector<vec3> positions;
  constexpr std::size_t kRows = 3, kColumns = kLevelLamps / kRows;
  for (std::size_t i = 0; i < kLevelLamps; ++i) {
    const vec3 part((float(i % kColumns) + 0.5f) / float(kColumns), 0.35f,
                    (float(i / kColumns) + 0.5f) / float(kRows));
    positions.push_back(bounds.lower + part * (bounds.upper - bounds.lower));
  }
  setLevelLamps(choice.scene, positions);
  finishScene(choice.scene, choice.name, job);
  return choice;
}

SceneChoice chooseLevel(std::span<const std::filesystem::path> folders, const Job& job) {
  for (const std::filesystem::path& folder : folders) {
    std::error_code ignored;
    if (const std::filesystem::path file = folder / "zdm2/zdm2.glb"; std::filesystem::exists(file, ignored))
      return level(file, job);
  }
  return levelStandIn(job);
}

}  // namespace

SceneChoice choosePublicScene(PublicScene wanted, std::span<const std::filesystem::path> folders,
                              const Job& job) {
  if (wanted == PublicScene::kRing) return {mirrorRing(), "ring of 128 triangles", false};
  if (wanted == PublicScene::kLevel) return chooseLevel(folders, job);
  const KnownScene& scene = known(wanted);
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path file = folder / scene.model;
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) continue;
    SceneChoice choice{loadUnlit(file, job), scene.name, false};
    choice.scene.lights = {pointLight(scene.lamp, vec3(scene.watts))};
    choice.scene.cameras = {scene.camera};
    finishScene(choice.scene, scene.model, job);
    return choice;
  }
  return {loadScene(scene.standIn, {}, job), fmt::format("{}, for {}", scene.standIn, scene.name), true};
}

Scene underPointLight(const std::string& builtin, vec3 position, float watts) {
  Scene scene = loadScene(builtin);
  for (NamedMaterial& material : scene.materials) material.emission = vec3(0.0f);
  scene.lights = {pointLight(position, vec3(watts))};
  finishScene(scene, builtin);
  return scene;
}

Scene mirrorRing() {
  Scene scene;
  scene.name = "ring";
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
  scene.lights = {pointLight({-1.4f, 1.5f, 0}, vec3(32.0f * kPi))};
  scene.cameras = {{.name = "", .eye = {0, 1.9f, 1.9f}, .target = {0, 0, -0.2f}, .verticalFovDegrees = 60}};
  finishScene(scene, "ring");
  return scene;
}

}  // namespace isophote::bench

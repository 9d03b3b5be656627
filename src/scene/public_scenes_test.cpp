// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Opens the public test scenes, which lie beside the checkout where a person has them.
#include "base/error.h"
#include "scene/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

namespace isophote {
namespace {

std::filesystem::path assetFolder() {
  if (const char* folder = std::getenv("ISOPHOTE_ASSETS")) return folder;
  return std::filesystem::path(ISOPHOTE_SOURCE_DIR) / ".." / "shared" / "scenes";
}

std::size_t trianglesOf(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) count += scene.meshes[instance.mesh].triangles.size();
  return count;
}

class PublicScenes : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(assetFolder()))
      GTEST_SKIP() << "there are no public scenes in " << assetFolder() << " (set ISOPHOTE_ASSETS)";
  }
};

TEST_F(PublicScenes, EveryGltfFileOpens) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(assetFolder())) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".gltf" || extension == ".glb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  EXPECT_FALSE(files.empty());
  for (const std::filesystem::path& file : files) {
    try {
      const Scene scene = loadScene(file.string());
      EXPECT_GT(trianglesOf(scene), 0u) << file;
      EXPECT_FALSE(scene.lights.empty()) << file;
      EXPECT_FALSE(scene.cameras.empty()) << file;
      for (const Light& light : scene.lights) EXPECT_GT(light.power, 0.0f) << file;
    } catch (const Error& e) {
      ADD_FAILURE() << e.what();
    }
  }
}

TEST_F(PublicScenes, SponzaLoadsFastAndSmall) {
  const std::filesystem::path file = assetFolder() / "sponza-crytek" / "sponza.gltf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
  const auto start = std::chrono::steady_clock::now();
  const Scene scene = loadScene(file.string());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(trianglesOf(scene), 262267u);
  EXPECT_EQ(scene.materials.size(), 25u);
  EXPECT_EQ(std::count_if(scene.materials.begin(), scene.materials.end(),
                          [](const NamedMaterial& m) { return (m.flags & kMaterialAlphaMask) != 0u; }),
            3);
  EXPECT_LT(std::abs(scene.bounds.upper.y - 11.4f), 0.1f);
  RecordProperty("seconds", std::to_string(seconds));
  RecordProperty("bytes", std::to_string(sceneBytes(scene)));
}

TEST_F(PublicScenes, KnownFactsHold) {
  const auto open = [](const std::string& path) { return loadScene((assetFolder() / path).string()); };
  const Scene cornell = open("bevy/CornellBox.glb");
  EXPECT_EQ(trianglesOf(cornell), 36u);
  ASSERT_EQ(cornell.lights.size(), 1u);
  EXPECT_EQ(cornell.lights[0].type, kLightMesh);
  EXPECT_EQ(
      trianglesOf(open("gltf-samples/MetalRoughSpheresNoTextures/glTF/MetalRoughSpheresNoTextures.gltf")),
      1040409u);
  EXPECT_EQ(trianglesOf(open("zdm2/zdm2.glb")), 58772u);
  const Scene cameras = open("gltf-samples/Cameras/glTF/Cameras.gltf");
  ASSERT_EQ(cameras.cameras.size(), 2u);
  EXPECT_EQ(cameras.cameras[0].orthographicHeight, 0.0f);
  EXPECT_GT(cameras.cameras[1].orthographicHeight, 0.0f);
  EXPECT_EQ(open("gltf-samples/MultipleScenes/glTF/MultipleScenes.gltf").instances.size(), 1u);
  EXPECT_GT(open("gltf-samples/SimpleInstancing/glTF/SimpleInstancing.gltf").instances.size(), 100u);
  const Scene lamp = open("gltf-samples/LightsPunctualLamp/glTF/LightsPunctualLamp.gltf");
  EXPECT_TRUE(std::any_of(lamp.lights.begin(), lamp.lights.end(),
                          [](const Light& l) { return l.type == kLightPoint; }));
}

}  // namespace
}  // namespace isophote

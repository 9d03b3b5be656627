// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "scene/gltf.h"
#include "scene/gltf_test_model.h"
#include "support/files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace isophote {

/// Opens models that a test wrote into a folder of its own.
class Gltf : public testing::Test {
 protected:
  Scene load(const std::string& bytes, const std::string& name = "model.gltf") {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    Job job;
    job.log = [this](LogLevel level, std::string_view message) {
      if (level == LogLevel::kWarning) warnings_ += std::string(message) + "\n";
    };
    Scene scene = loadGltf(folder_ / name, job);
    finishScene(scene, name, job);
    return scene;
  }

  /// The bytes must be refused in one line that names the file and holds `part`.
  void expectRefused(const std::string& bytes, const std::string& part,
                     const std::string& name = "model.gltf") {
    try {
      load(bytes, name);
      ADD_FAILURE() << "opened, but expected: " << part;
    } catch (const Error& e) {
      const std::string what = e.what();
      EXPECT_TRUE(e.kind() == ErrorKind::kBadInput || e.kind() == ErrorKind::kResources) << what;
      EXPECT_NE(what.find(name), std::string::npos) << what;
      EXPECT_NE(what.find(part), std::string::npos) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
  }

  /// What squareModel() describes.
  static void expectSquare(const Scene& scene) {
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.name, "square");
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[2], vec3(1, 1, 0));
    EXPECT_EQ(mesh.normals.at(3), vec3(0, 0, 1));
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.triangles[1], uvec3(0, 2, 3));
    EXPECT_EQ(scene.materials.at(mesh.material).name, "paint");
  }

  TestFolder testFolder_;
  std::filesystem::path folder_ = testFolder_.path();
  std::string warnings_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Files that cannot be read: refused in one sentence, or survived.
#include "scene/gltf_test_fixture.h"

#include <cstring>
#include <limits>

namespace isophote {
namespace {

using test::GltfModel;
using test::squareModel;

TEST_F(Gltf, NamesRequiredExtensionsThatItCannotRead) {
  GltfModel m = squareModel();
  m.json["extensionsRequired"] = {"KHR_draco_mesh_compression", "KHR_lights_punctual",
                                  "EXT_meshopt_compression"};
  expectRefused(m.gltf(),
                "requires KHR_draco_mesh_compression and EXT_meshopt_compression, which cannot be read");
  m.json["extensionsRequired"] = {"KHR_materials_sheen"};
  m.json["extensionsUsed"] = {"KHR_materials_sheen"};
  load(m.gltf());
  EXPECT_NE(warnings_.find("is read without KHR_materials_sheen"), std::string::npos) << warnings_;
}

TEST_F(Gltf, NamesBadAccessors) {
  const auto refused = [&](auto&& change, const std::string& part) {
    GltfModel m = squareModel();
    change(m.json);
    expectRefused(m.gltf(), part);
  };
  using nlohmann::json;
  refused([](json& j) { j["accessors"][0]["count"] = 5; },
          "meshes[0].primitives[0].attributes.POSITION: reads 5 elements up to byte 60");
  refused([](json& j) { j["accessors"][0]["count"] = 9007199254740992ll; }, "POSITION: reads");
  refused([](json& j) { j["accessors"][0]["count"] = 1e300; }, "accessors[0].count: must be a whole number");
  refused([](json& j) { j["accessors"][0]["count"] = -1; }, "accessors[0].count: must be a whole number");
  refused([](json& j) { j["accessors"][0]["byteOffset"] = 4; }, "POSITION: reads");
  refused([](json& j) { j["accessors"][0]["byteOffset"] = 9007199254740992ll; }, "POSITION: reads");
  refused([](json& j) { j["accessors"][0]["type"] = "VEC2"; }, "is of type \"VEC2\", but VEC3 is wanted");
  refused([](json& j) { j["accessors"][0]["componentType"] = 5130; },
          "5130 is none of glTF's component types");
  refused([](json& j) { j["accessors"][0]["bufferView"] = 9; },
          "accessors[0].bufferView: names bufferViews[9]");
  refused([](json& j) { j["accessors"][0].erase("bufferView"), j["accessors"][0]["count"] = 4000000000u; },
          "no bufferView");
  refused([](json& j) { j["accessors"][1]["count"] = 3; },
          "NORMAL: accessor 1 has 3 elements for 4 positions");
  refused([](json& j) { j["bufferViews"][0]["byteLength"] = 1e12; }, "bufferViews[0]: reaches");
  refused([](json& j) { j["bufferViews"][0]["byteOffset"] = 1e12; }, "bufferViews[0]: reaches");
  refused([](json& j) { j["bufferViews"][0]["buffer"] = 1; }, "bufferViews[0].buffer: names buffers[1]");
  refused([](json& j) { j["bufferViews"][0]["byteStride"] = 8; }, "bufferViews[0].byteStride");
  refused([](json& j) { j["accessors"][3]["componentType"] = 5126; },
          "indices: reads 6 elements up to byte 24");
  refused([](json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 77; },
          "POSITION: names accessors[77]");
  refused([](json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }, "mode: 7 is none");
  refused([](json& j) { j["meshes"][0]["primitives"][0]["material"] = 3; }, "material: names materials[3]");
  refused([](json& j) { j["nodes"][0]["mesh"] = "x"; }, "nodes[0].mesh: must be a whole number");
  refused(
      [](json& j) {
        j["nodes"][0]["rotation"] = {0, 0, 0, 0};
      },
      "nodes[0]: has a rotation of length zero");
  refused(
      [](json& j) {
        j["nodes"][0]["matrix"] = {1, 2};
      },
      "nodes[0].matrix: expected an array of 16 numbers");
  refused([](json& j) { j["nodes"][0]["translation"] = {1e30, 0, 0}; }, "instance 0");
  refused([](json& j) { j["scenes"][0]["nodes"] = {5}; }, "scenes[0].nodes[0]: names no node");
  refused([](json& j) { j["scene"] = 5; }, "scene: names scenes[5]");
  refused([](json& j) { j["asset"]["version"] = "1.0"; }, "glTF version \"1.0\"");
  refused([](json& j) { j.erase("asset"); }, "\"asset\" is missing");
  refused([](json& j) { j["accessors"] = 3; }, "accessors: expected an array");
}

TEST_F(Gltf, NamesBadVerticesAndIndices) {
  GltfModel m = squareModel();
  m.primitive()["indices"] = m.add<std::uint32_t>({0, 1, 4000000000u}, 5125, "SCALAR", 1);
  expectRefused(m.gltf(), "names vertex 4000000000, but there are only 4");
  m = squareModel();
  m.primitive()["attributes"]["POSITION"] =
      m.addVec3({0, 0, 0, 1, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0, 0, 1, 0});
  expectRefused(m.gltf(), "mesh 0 \"square\", vertex 2: the position is not a finite number");
}

TEST_F(Gltf, NamesBadFiles) {
  GltfModel m = squareModel();
  m.gltf();
  m.json["buffers"][0]["byteLength"] = 4096;
  expectRefused(m.json.dump(), "buffers[0]: says 4096 bytes, but its data URI has");
  m.json["buffers"][0]["uri"] = "gone.bin";
  expectRefused(m.json.dump(), "gone.bin is missing");
  m.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,AA*A";
  expectRefused(m.json.dump(), "buffers[0].uri: is not valid base64");
  m.json["buffers"][0].erase("uri");
  expectRefused(m.json.dump(), "buffers[0]: has no uri");
  expectRefused("", "broken or cut off");
  expectRefused("[1, 2]", "no object");
  expectRefused(std::string(100000, '['), "broken or cut off");
  expectRefused("no glb at all, but long enough", "does not begin with", "model.glb");
  try {
    loadGltf(folder_ / "nothing.gltf");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("nothing.gltf"), std::string::npos) << e.what();
  }
}

TEST_F(Gltf, RefusesAKeyGivenTwice) {
  std::string text = squareModel().gltf();
  text.insert(text.find("\"POSITION\""), "\"NORMAL\":1,\"NORMAL\":1,");
  expectRefused(text, "meshes[0].primitives[0].attributes: the key \"NORMAL\" is given twice; keep one");
}

TEST_F(Gltf, KeepsToTheMemoryBudget) {
  const auto refusal = [&](const std::string& bytes) {
    std::ofstream(folder_ / "model.gltf", std::ios::binary) << bytes;
    Job job;
    job.memoryBudgetBytes = std::uint64_t(8) << 20;
    return errorOf([&] { loadGltf(folder_ / "model.gltf", job); }, ErrorKind::kResources);
  };
  // A few bytes that ask for 100,000 copies, or for 1,000 under a long name.
  GltfModel copies = squareModel();
  copies.json["accessors"].push_back({{"componentType", 5126}, {"count", 100000}, {"type", "VEC3"}});
  copies.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      copies.json["accessors"].size() - 1;
  EXPECT_NE(refusal(copies.gltf()).find("its instances need more than the memory budget of 8 MiB"),
            std::string::npos);
  copies.json["accessors"].back()["count"] = 1000;
  copies.json["nodes"][0]["name"] = std::string(20000, 'x');
  EXPECT_NE(refusal(copies.gltf()).find("its instances need more"), std::string::npos);
  GltfModel nested = squareModel();
  nested.json["extras"] = std::string(200000, '[');
  EXPECT_NE(refusal(nested.gltf()).find("bytes of JSON need more"), std::string::npos);
}

TEST_F(Gltf, DeepJsonDoesNotOverflowTheStack) {
  GltfModel m = squareModel();
  m.json["extras"] = "HERE";
  std::string text = m.gltf();
  text.replace(text.find("\"HERE\""), 6, std::string(200000, '[') + std::string(200000, ']'));
  expectSquare(load(text));
}

TEST_F(Gltf, RefusesGlbCutOffAnywhere) {
  const std::string whole = squareModel().glb();
  const auto refuse = [&](std::size_t size) {
    std::string bytes = whole.substr(0, size);
    expectRefused(bytes, "model.glb", "model.glb");
    if (size < 12) return;
    // With a header that agrees: now a chunk does not fit, or the buffer is too short.
    const auto total = std::uint32_t(size);
    std::memcpy(bytes.data() + 8, &total, 4);
    expectRefused(bytes, "model.glb", "model.glb");
  };
  for (std::size_t size = 0; size <= 32; ++size) refuse(size);
  for (std::size_t percent = 1; percent < 100; ++percent) refuse(whole.size() * percent / 100);
  for (std::size_t missing = 1; missing <= 16; ++missing) refuse(whole.size() - missing);
}

TEST_F(Gltf, SurvivesDamagedGlb) {
  const std::string whole = squareModel().glb();
  std::uint32_t state = 12345;
  const auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  int opened = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string bytes = whole;
    // Digits find their way through the JSON parser more often than other bytes do.
    for (int k = 0; k < 2; ++k)
      bytes[random() % bytes.size()] = trial % 2 == 0 ? char(random()) : char('0' + random() % 10);
    try {
      load(bytes, "model.glb");
      ++opened;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("model.glb"), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }
  // Damage to vertices or names goes unnoticed; damage to structure must not.
  EXPECT_GT(opened, 0);
  EXPECT_LT(opened, kTrials / 2);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "fuzz/image_formats.h"
#include "render/cpu_frame.h"
#include "render/settings.h"
#include "scene/gltf_test_model.h"
#include "scene/scene.h"
#include "settings/apply.h"

#include <cstring>
#include <filesystem>
#include <fstream>

namespace isophote::fuzz {

inline void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A scene that opens must render. One in eight is: which, the bytes decide.
inline void useScene(const Scene& scene, const std::string& bytes) {
  if (hashOf(bytes) % 8 != 0) return;
  RenderSettings settings;
  settings.frame.width = 5;
  settings.frame.height = 4;
  settings.frame.bounces = 2;
  settings.photonTrace.photons = 50;
  Job job;
  job.memoryBudgetBytes = 16 * kBudgetBytes;
  Stats stats;
  renderCpu(scene, scene.cameras.at(0), settings, stats, job);
}

/// Reads the bytes as a file of that name, in a folder that may hold what it refers to.
inline void readScene(const std::filesystem::path& file, const std::string& bytes,
                      const std::filesystem::path& scene) {
  writeBytes(file, bytes);
  Job job;
  job.memoryBudgetBytes = kBudgetBytes;
  useScene(loadScene(scene.string(), {}, job), bytes);
}

/// Two triangles with what glTF files of today hold.
inline test::GltfModel richModel(const std::string& png) {
  test::GltfModel m = test::squareModel();
  const int instances = m.addVec3({0, 0, 0, 2, 0, 0});
  const int strip = m.add<std::uint8_t>({0, 1, 3, 2}, 5121, "SCALAR", 1);
  m.json["images"] = {{{"uri", "data:image/png;base64," + test::base64(png)}}};
  m.json["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  m.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  m.json["materials"] = nlohmann::json::parse(R"([
    {"name": "paint", "alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": true, "emissiveFactor": [1, 0, 0],
     "emissiveTexture": {"index": 0}, "normalTexture": {"index": 0, "scale": 1},
     "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {
       "KHR_texture_transform": {"offset": [0, 1], "rotation": 1, "scale": [2, 2]}}},
       "metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.3, "metallicFactor": 0.5}},
    {"name": "glass", "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
     "KHR_materials_ior": {"ior": 1.4}, "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2,
     "attenuationColor": [1, 0.5, 0.2]}, "KHR_materials_specular": {"specularFactor": 0.5},
     "KHR_materials_emissive_strength": {"emissiveStrength": 3}}}])");
  nlohmann::json second = m.primitive();
  second["mode"] = 5;
  second["indices"] = strip;
  second["material"] = 1;
  m.json["meshes"][0]["primitives"].push_back(second);
  m.json["accessors"][0]["sparse"] = nlohmann::json::parse(
      R"({"count": 1, "indices": {"bufferView": 5, "componentType": 5121}, "values": {"bufferView": 0}})");
  m.json["cameras"] = nlohmann::json::parse(
      R"([{"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1.5, "znear": 0.1}}])");
  m.json["extensionsUsed"] = {"KHR_lights_punctual", "EXT_mesh_gpu_instancing"};
  m.json["extensions"] = nlohmann::json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "spot",
    "color": [1, 1, 1], "intensity": 5, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
    {"type": "point"}, {"type": "directional"}]}})");
  m.json["nodes"] = nlohmann::json::parse(R"([
    {"mesh": 0, "children": [1, 2], "scale": [1, -1, 1], "rotation": [0, 0, 0, 1], "extensions": {
      "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 4}}}},
    {"camera": 0, "translation": [0.5, 0.5, 3]},
    {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}}])");
  m.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = instances;
  return m;
}

inline std::vector<std::string> gltfWords() {
  return {"\"accessors\":[",
          "\"bufferViews\":[",
          "\"nodes\":[0]",
          "\"mesh\":0",
          "\"children\":[0]",
          "\"sparse\":{",
          "\"count\":",
          "\"byteOffset\":",
          "\"byteStride\":",
          "\"byteLength\":",
          "\"componentType\":",
          "5120",
          "5121",
          "5122",
          "5123",
          "5125",
          "5126",
          "\"SCALAR\"",
          "\"VEC2\"",
          "\"VEC4\"",
          "\"MAT4\"",
          "\"normalized\":true",
          "\"COLOR_0\":0",
          "\"TANGENT\":0",
          "\"TEXCOORD_1\":2",
          "\"JOINTS_0\":0",
          "\"indices\":3",
          "\"mode\":6",
          "\"material\":0",
          "\"matrix\":[",
          "\"scale\":[0,0,0]",
          "\"uri\":\"",
          "data:;base64,",
          "\"extras\":",
          "\"scene\":0",
          "null",
          "true",
          "[]",
          "{}",
          "\"\"",
          "\\u0000",
          "\"type\":\"orthographic\",\"orthographic\":{\"xmag\":1,\"ymag\":1}",
          "\"bufferView\":0",
          "\"extensionsRequired\":[\"KHR_mesh_quantization\"]",
          "\"alphaMode\":\"BLEND\""};
}

/// Lets the lengths in the header and of the two chunks agree with the bytes that are there.
inline void repairGlb(std::string& bytes) {
  const auto put = [&](std::size_t at, std::size_t value) {
    const auto word = std::uint32_t(value);
    std::memcpy(bytes.data() + at, &word, 4);
  };
  const std::size_t binary = bytes.find(std::string("BIN\0", 4));
  if (bytes.size() < 20) return;
  put(8, bytes.size());
  if (binary == std::string::npos || binary < 24) return put(12, bytes.size() - 20);
  put(12, binary - 24);
  put(binary - 4, bytes.size() - binary - 4);
}

inline std::pair<std::size_t, std::size_t> wholeText(const std::string& bytes) { return {0, bytes.size()}; }

inline std::pair<std::size_t, std::size_t> jsonOfGlb(const std::string& bytes) {
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 12, 4);
  return {20, size};
}

inline Format gltfFormat(const std::filesystem::path& folder, bool binary) {
  const std::string png = pngFormat().seeds[0];
  const std::filesystem::path file = folder / (binary ? "input.glb" : "input.gltf");
  test::GltfModel square = test::squareModel(), rich = richModel(png);
  Format format{binary ? "glb" : "gltf",
                {},
                gltfWords(),
                [file](const std::string& bytes) { readScene(file, bytes, file); },
                {}};
  if (binary) {
    format.seeds = {square.glb(), rich.glb()};
    format.repair = repairGlb;
    format.jsonPart = jsonOfGlb;
  } else {
    format.seeds = {square.gltf(), rich.gltf()};
    format.jsonPart = wholeText;
  }
  return format;
}

inline constexpr const char* kObjSeed =
    "# a room\nmtllib input.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1 1 0 0\nvt 0 1\nvt 1 1 0\nvn "
    "0 0 1\n"
    "o wall\ng a b\ns 1\nusemtl paint\nf 1/1/1 2/2/1 3/1/1 4/2/1\nusemtl lamp\nf -1 -2 -3\nusemtl glass\n"
    "f 1//1 2//1 \\\n5//1\nl 1 2 3\n";
inline constexpr const char* kMtlSeed =
    "newmtl paint\nKd 0.5 0.4 0.3\nKs 0.1 0.1 0.1\nNs 100\nillum 2\nmap_Kd -s 1 1 -clamp on input.png\nmap_d "
    "input.png\n"
    "newmtl lamp\nKe 5 5 5\nKd 0\nnewmtl glass\nillum 7\nNi 1.5\nTf 1 1 1\nd 0.1\nTr 0.9\nmap_Bump -bm 2 "
    "input.png\n";

inline Format objFormat(const std::filesystem::path& folder, bool material) {
  writeBytes(folder / "input.obj", kObjSeed);
  writeBytes(folder / "input.mtl", kMtlSeed);
  writeBytes(folder / "input.png", pngFormat().seeds[0]);
  const std::filesystem::path scene = folder / "input.obj",
                              file = folder / (material ? "input.mtl" : "input.obj");
  Format format{
      material ? "mtl" : "obj",
      {material ? kMtlSeed : kObjSeed},
      {"v ",        "vt ",   "vn ",      "f ",          "usemtl ",  "mtllib ",      "newmtl ",  "g ",
       "o ",        "\\\n",  "//",       "1/2/3",       "-1/-1/-1", "map_Kd ",      "map_Ke ",  "map_d ",
       "map_Bump ", "norm ", "illum 3",  "illum 5",     "illum 9",  "Kd spectral ", "Kd xyz ",  "-mm 0 1 ",
       "-o 1 2 3 ", "-s 1 ", "-bm 0.5 ", "d -halo 0.5", "Ns 1e9",   "Ni 0",         "Tf 0 0 0", "Ke 1 1 1",
       "\r\n",      "\t",    "#",        "input.png"},
      [file, scene](const std::string& bytes) { readScene(file, bytes, scene); },
      {}};
  return format;
}

inline Format descriptionFormat(const std::filesystem::path& folder) {
  writeBytes(folder / "model.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl paint\nf 1 2 3\n");
  const std::filesystem::path file = folder / "input.json";
  return {
      "description",
      {R"({"isophote": 1, "models": [{"file": "model.obj", "name": "a", "translation": [0, 1, 0],
               "rotation": [0, 0, 0, 1], "scale": 2}, {"file": "model.obj", "scale": [1, 2, 3]}],
               "camera": {"eye": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "verticalFovDegrees": 45, "aspect": 1},
               "lights": [{"type": "point", "watts": 1, "position": [0, 1, 0], "radius": 0.1},
                 {"type": "spot", "watts": [1, 2, 3], "position": [0, 1, 0], "direction": [0, -1, 0],
                  "innerDegrees": 10, "outerDegrees": 20},
                 {"type": "directional", "irradiance": 1, "direction": [0, -1, 0]},
                 {"type": "environment", "radiance": 0.1}],
               "materials": {"paint": {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1],
                 "roughnessFactor": 0.2}, "emissiveFactor": [0, 0, 1]}},
               "settings": {"frame.bounces": 2}})"},
      {"\"type\":\"rectangle\"", "\"width\":1", "\"radiance\":1", "\"models\":[", "\"file\":\"model.obj\"",
       "\"file\":\"input.json\"", "\"rotation\":[0,0,0,1]", "\"scale\":0", "\"camera\":{", "\"settings\":{",
       "\"materials\":{", "\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1}}",
       "null", "true", "[]", "{}", "1e30", "\"direction\":[0,0,0]", "\"eye\":[0,0,0]"},
      [file](const std::string& bytes) { readScene(file, bytes, file); },
      {}};
}

inline Format settingsFormat() {
  return {"settings",
          {R"({"frame": {"width": 640, "aa": 4, "estimator": "kdtree"}, "photon_trace.photons": 1000,
               "direct": {"areaSamples": 4}, "frame.layers": false})"},
          {"\"frame\":{", "\"gbuffer\":{", "\"photon_volumes\":{", "\"width\":", "\"estimator\":\"volumes\"",
           "\"photons\":1e3", "null", "true", "[]", "{}", "\"\"", "1e30", "-1", "18446744073709551616"},
          [](const std::string& bytes) {
            RenderSettings settings;
            setFromJson(fieldsOfGroups(settings), bytes, {ErrorKind::kBadInput, "input"});
            setFromJson(fieldsOfGroups(settings), settingsJson(fieldsOfGroups(settings)),
                        {ErrorKind::kInternal, "written"});
          },
          {}};
}

/// All formats. `folder` is empty; inputs are written there while they are read, so that the one that ends a
/// process stays behind.
inline std::vector<Format> allFormats(const std::filesystem::path& folder) {
  return {gltfFormat(folder, false),
          gltfFormat(folder, true),
          objFormat(folder, false),
          objFormat(folder, true),
          descriptionFormat(folder),
          settingsFormat(),
          pngFormat(),
          jpegFormat(),
          exrFormat(folder),
          hdrFormat(),
          tgaFormat()};
}

}  // namespace isophote::fuzz

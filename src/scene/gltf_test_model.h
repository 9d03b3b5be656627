// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace isophote::test {

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = (bits << 8) | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[(bits >> (18 - 6 * k)) & 63];
  }
  return text;
}

/// A small glTF file under construction: JSON that a test edits at will, and one buffer.
struct GltfModel {
  nlohmann::json json;
  std::string buffer;

  GltfModel() {
    json["asset"]["version"] = "2.0";
    json["scene"] = 0;
    json["scenes"] = {{{"nodes", {0}}}};
    json["nodes"] = nlohmann::json::array({{{"mesh", 0}}});
    json["accessors"] = nlohmann::json::array();
    json["bufferViews"] = nlohmann::json::array();
  }

  /// Appends numbers with a view and an accessor of their own; returns the accessor's index.
  template <class T>
  int add(const std::vector<T>& numbers, int componentType, const std::string& type, int components) {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    const std::size_t offset = buffer.size();
    buffer.resize(offset + numbers.size() * sizeof(T));
    std::memcpy(buffer.data() + offset, numbers.data(), numbers.size() * sizeof(T));
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", numbers.size() * sizeof(T)}});
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", componentType},
                                 {"count", numbers.size() / std::size_t(components)},
                                 {"type", type}});
    return int(json["accessors"].size()) - 1;
  }
  int addVec3(const std::vector<float>& numbers) { return add(numbers, 5126, "VEC3", 3); }
  int addVec2(const std::vector<float>& numbers) { return add(numbers, 5126, "VEC2", 2); }

  nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }
  nlohmann::json& material() { return json["materials"][0]; }

  std::string gltf() {
    json["buffers"] = {
        {{"byteLength", buffer.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer)}}};
    return json.dump();
  }

  std::string glb() {
    json["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary = buffer;
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto word = [](std::size_t value) {
      const auto number = std::uint32_t(value);
      return std::string(reinterpret_cast<const char*>(&number), 4);
    };
    return "glTF" + word(2) + word(12 + 8 + text.size() + 8 + binary.size()) + word(text.size()) + "JSON" +
           text + word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

/// A unit square in the plane z = 0 of two triangles with uvs, normals and one material, named "square".
inline GltfModel squareModel() {
  GltfModel m;
  const int positions = m.addVec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  const int normals = m.addVec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int uvs = m.addVec2({0, 1, 1, 1, 1, 0, 0, 0});
  const int indices = m.add<std::uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 1);
  m.json["meshes"][0]["name"] = "square";
  m.primitive()["attributes"] = {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}};
  m.primitive()["indices"] = indices;
  m.primitive()["material"] = 0;
  m.material()["name"] = "paint";
  return m;
}

}  // namespace isophote::test

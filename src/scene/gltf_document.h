// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/json_value.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// What one glTF file holds: its JSON, whose top-level arrays are split into elements that know their place,
/// and its buffers. Everything handed out stays valid for the document's life.
class GltfDocument {
 public:
  /// Reads a .gltf or .glb file and its buffers.
  GltfDocument(const std::filesystem::path& path, std::uint64_t budgetBytes);
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  const std::string& file() const { return file_; }
  JsonValue root() const { return JsonValue(json_, file_); }
  /// Elements of the top-level array `name` ("accessors"); empty where there is none.
  const std::vector<JsonValue>& array(std::string_view name) const;

  /// Bytes of a buffer view; `view` is checked against its buffer.
  std::span<const std::byte> viewBytes(const JsonValue& view) const;
  /// Bytes behind an image's data: URI; kept by the document.
  std::span<const std::byte> dataUriBytes(const JsonValue& uri);
  /// The file that a relative URI names.
  std::filesystem::path fileOf(const JsonValue& uri) const;

 private:
  void splitContainer(std::uint64_t budgetBytes);
  void splitGlb(const std::string& bytes, std::string_view& json);
  void loadBuffer(const JsonValue& buffer, std::size_t index, std::uint64_t budgetBytes);

  std::filesystem::path path_;
  std::string file_;
  std::deque<std::string> blobs_;  ///< Owns what the spans show; a deque never moves its elements.
  std::optional<std::span<const std::byte>> binaryChunk_;
  nlohmann::json json_;
  std::vector<std::pair<std::string, std::vector<JsonValue>>> arrays_;
  std::vector<std::span<const std::byte>> buffers_;
};

/// A whole number from 0 to 2^53; `fallback` where the key is absent, an error where that is absent too.
std::uint64_t wholeNumber(const JsonValue& object, std::string_view key,
                          std::optional<std::uint64_t> fallback = {});

/// The element of the top-level array `array` that object[key] names; nothing where the key is absent.
std::optional<std::size_t> findIndex(const GltfDocument& document, const JsonValue& object,
                                     std::string_view key, std::string_view array);

/// The member "extensions"[name]; nothing where it is absent.
std::optional<JsonValue> findExtension(const JsonValue& object, std::string_view name);

/// The member "name" fit for a sentence, or `fallback`.
std::string nameOf(const JsonValue& object, std::string fallback);

/// A number within [least, most], or `fallback` where the key is absent.
float numberOr(const JsonValue& object, std::string_view key, float fallback, double least, double most);

bool isDataUri(std::string_view uri);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "math/shared.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isophote {

/// A value in a JSON file that knows its place there. Every read checks the type, and its error names the
/// file and the place: "scene.json: lights[2].watts: expected a number, but this is a string". Cheap to copy;
/// the document must outlive it.
class JsonValue {
 public:
  JsonValue(const nlohmann::json& value, const std::string& file) : value_(&value), file_(&file) {}

  /// Throws Error(kBadInput): "file: place: sentence".
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> sentence, Args&&... args) const {
    const std::string text = fmt::format(sentence, std::forward<Args>(args)...);
    if (place_.empty()) failInput(*file_, "{}", text);
    failInput(*file_, "{}: {}", place_, text);
  }

  /// Throws unless this is an object with no other keys than these; the error names the nearest of them.
  void expectKeys(std::initializer_list<std::string_view> known) const;
  bool has(std::string_view key) const;
  /// Member that must be there.
  JsonValue at(std::string_view key) const;
  std::optional<JsonValue> find(std::string_view key) const;
  std::vector<JsonValue> elements() const;
  std::vector<std::pair<std::string, JsonValue>> members() const;

  std::string string() const;
  bool boolean() const;
  /// A number that a float holds, within [least, most].
  float number(double least = std::numeric_limits<double>::lowest(),
               double most = std::numeric_limits<double>::max()) const;
  /// A number greater than zero.
  float positive() const;
  vec3 vector() const;
  /// A vector that is not zero, made unit.
  vec3 direction() const;
  /// [r, g, b], or one number for all three; not negative.
  vec3 colour(double most = std::numeric_limits<double>::max()) const;
  /// An array of `count` numbers.
  std::vector<float> numbers(std::size_t count, double least = std::numeric_limits<double>::lowest(),
                             double most = std::numeric_limits<double>::max()) const;

  const nlohmann::json& json() const { return *value_; }
  /// "lights[2].watts"; empty for the whole document.
  const std::string& place() const { return place_; }

 private:
  JsonValue child(const nlohmann::json& value, std::string_view key) const;
  void expectObject() const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string place_;
};

/// Parses a whole file. Throws Error(kBadInput) naming line and column of the first mistake.
nlohmann::json readJsonFile(const std::filesystem::path& file);

}  // namespace isophote

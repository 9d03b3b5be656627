// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/json_value.h"

#include "base/files.h"
#include "base/json_keys.h"
#include "settings/suggest.h"

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

/// Descriptions are written by hand; anything larger is another kind of file.
constexpr std::uint64_t kMostJsonBytes = std::uint64_t(16) << 20;

/// "a string", "an array", ...: what to call a value in a sentence.
std::string kindOf(const nlohmann::json& value) {
  if (value.is_null()) return "null";
  const std::string name = value.type_name();
  return (name == "array" || name == "object" ? "an " : "a ") + name;
}

}  // namespace

JsonValue JsonValue::child(const nlohmann::json& value, std::string_view key) const {
  JsonValue result(value, *file_);
  result.place_ = place_.empty() ? std::string(key) : fmt::format("{}.{}", place_, key);
  return result;
}

void JsonValue::expectObject() const {
  if (!value_->is_object()) fail("expected an object in {{}}, but this is {}", kindOf(*value_));
}

void JsonValue::expectKeys(std::initializer_list<std::string_view> known) const {
  expectObject();
  for (const auto& [key, value] : value_->items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string nearest =
        suggestion(key, std::span<const std::string_view>(known.begin(), known.size()));
    if (!nearest.empty()) fail("unknown key \"{}\"{}", key, nearest);
    fail("unknown key \"{}\"; known are {}", key, fmt::join(known, ", "));
  }
}

bool JsonValue::has(std::string_view key) const {
  expectObject();
  return value_->contains(key);
}

JsonValue JsonValue::at(std::string_view key) const {
  expectObject();
  const auto member = value_->find(key);
  if (member == value_->end()) fail("the key \"{}\" is missing", key);
  return child(*member, key);
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
  return has(key) ? std::optional(at(key)) : std::nullopt;
}

std::vector<JsonValue> JsonValue::elements() const {
  if (!value_->is_array()) fail("expected an array in [], but this is {}", kindOf(*value_));
  std::vector<JsonValue> result;
  for (std::size_t i = 0; i < value_->size(); ++i) {
    result.emplace_back((*value_)[i], *file_);
    result.back().place_ = fmt::format("{}[{}]", place_, i);
  }
  return result;
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
  expectObject();
  std::vector<std::pair<std::string, JsonValue>> result;
  for (const auto& [key, value] : value_->items()) result.emplace_back(key, child(value, key));
  return result;
}

std::string JsonValue::string() const {
  if (!value_->is_string()) fail("expected a string, but this is {}", kindOf(*value_));
  return value_->get<std::string>();
}

bool JsonValue::boolean() const {
  if (!value_->is_boolean()) fail("expected true or false, but this is {}", kindOf(*value_));
  return value_->get<bool>();
}

float JsonValue::number(double least, double most) const {
  if (!value_->is_number()) fail("expected a number, but this is {}", kindOf(*value_));
  const double value = value_->get<double>();
  if (!std::isfinite(float(value))) fail("{} is too large a number", value_->dump());
  if (value < least && most == std::numeric_limits<double>::max())
    fail("must be at least {}, but is {}", least, value);
  if (value < least || value > most) fail("must lie in [{}, {}], but is {}", least, most, value);
  return float(value);
}

float JsonValue::positive() const {
  const float value = number();
  if (!(value > 0.0f)) fail("must be greater than 0, but is {}", value);
  return value;
}

std::vector<float> JsonValue::numbers(std::size_t count, double least, double most) const {
  if (!value_->is_array() || value_->size() != count) {
    fail("expected an array of {} numbers, but this is {}", count,
         value_->is_array() ? fmt::format("one of {}", value_->size()) : kindOf(*value_));
  }
  std::vector<float> result;
  for (const JsonValue& element : elements()) result.push_back(element.number(least, most));
  return result;
}

vec3 JsonValue::vector() const {
  const std::vector<float> v = numbers(3);
  return vec3(v[0], v[1], v[2]);
}

vec3 JsonValue::direction() const {
  const glm::dvec3 v(vector());
  const double size = glm::length(v);
  if (!(size > 0)) fail("must not be [0, 0, 0]: it gives a direction");
  return vec3(v / size);
}

vec3 JsonValue::colour(double most) const {
  if (value_->is_number()) return vec3(number(0.0, most));
  if (!value_->is_array()) fail("expected a number or [r, g, b], but this is {}", kindOf(*value_));
  const std::vector<float> v = numbers(3, 0.0, most);
  return vec3(v[0], v[1], v[2]);
}

nlohmann::json readJsonFile(const std::filesystem::path& file) {
  const std::string text = readFile(file, kMostJsonBytes);
  try {
    nlohmann::json json = nlohmann::json::parse(text);
    requireUniqueKeys(text, file.string());
    return json;
  } catch (const nlohmann::json::parse_error& error) {
    const std::size_t at = std::min<std::size_t>(error.byte > 0 ? error.byte - 1 : 0, text.size());
    const std::string_view before = std::string_view(text).substr(0, at);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t lineStart = before.rfind('\n') + 1;  // npos + 1 is 0.
    failInput(file.string(), "line {}, column {}: is not valid JSON here{}", line, at - lineStart + 1,
              at == text.size() ? ": the file ends too early" : "");
  } catch (const nlohmann::json::exception&) {
    failInput(file.string(), "is not valid JSON: a number in it is out of range");
  }
}

}  // namespace isophote

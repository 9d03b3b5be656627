// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "settings/apply.h"

#include "base/json_keys.h"
#include "base/number.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

namespace isophote {
namespace {

using Json = nlohmann::ordered_json;

/// The pointee of a Field's alternative: bool, int, ..., std::string, or EnumRef itself.
template <class Ref>
using Value = std::remove_pointer_t<std::remove_cvref_t<Ref>>;

template <class T>
constexpr bool kIsInteger = std::is_integral_v<T> && !std::is_same_v<T, bool>;

struct Range {
  double min, max;
};

/// The range of a number field: what it declares, within what its type holds.
Range rangeOf(const Field& field) {
  return std::visit(
      [&](const auto& ref) -> Range {
        using T = Value<decltype(ref)>;
        Range range{field.info.min, field.info.max};
        if constexpr (kIsInteger<T>) range.min = std::max(range.min, double(std::numeric_limits<T>::min()));
        if constexpr (kIsInteger<T> && sizeof(T) < 8)
          range.max = std::min(range.max, double(std::numeric_limits<T>::max()));
        return range;
      },
      field.value);
}

/// Sets one field from a JSON value, or throws a sentence that says what the value should have been.
struct Setter {
  const Field& field;
  const Json& json;
  std::string_view text;  ///< The value as written.
  const SettingOrigin& origin;

  [[noreturn]] void refuse(std::string_view wanted) const {
    fail(origin.kind, origin.subject, "{} must be {}, not {}", field.key, wanted,
         text.empty() ? "empty" : text.substr(0, 40));
  }

  [[noreturn]] void refuseNumber(std::string_view wanted) const {
    const Range range = rangeOf(field);
    if (!std::isfinite(range.min) && !std::isfinite(range.max)) refuse(wanted);
    const bool both = std::isfinite(range.min) && std::isfinite(range.max);
    refuse(fmt::format("{} {} {}", wanted, both ? "from" : "of", rangeText(field)));
  }

  void operator()(bool* target) const {
    if (!json.is_boolean()) refuse("true or false");
    *target = json.get<bool>();
  }

  template <class T>
  requires kIsInteger<T>
  void operator()(T* target) const {
    const Range range = rangeOf(field);
    // Whole numbers may be written with an exponent, 2e5; every one up to 2^53 is exact as a double.
    const double given = json.is_number() ? json.get<double>() : std::nan("");
    if (!(given >= range.min && given <= range.max) || given != std::floor(given))
      refuseNumber("a whole number");
    if (json.is_number_float() && std::abs(given) > 9007199254740992.0) refuseNumber("a whole number");
    *target = json.is_number_float() ? T(given) : json.get<T>();
  }

  void operator()(float* target) const {
    const Range range = rangeOf(field);
    const double given = json.is_number() ? json.get<double>() : std::nan("");
    if (!(given >= range.min && given <= range.max) || !std::isfinite(float(given))) refuseNumber("a number");
    *target = float(given);
  }

  void operator()(std::string* target) const {
    *target = json.is_string() ? json.get<std::string>() : std::string(text);
  }

  void operator()(const EnumRef& target) const {
    const std::string name = json.is_string() ? json.get<std::string>() : std::string(text);
    const auto found = std::find(target.names.begin(), target.names.end(), name);
    if (found == target.names.end())
      fail(origin.kind, origin.subject, "{} has no value \"{}\"{}; there is {}", field.key, name,
           suggestion(name, target.names), fmt::join(target.names, ", "));
    target.set(std::size_t(found - target.names.begin()));
  }
};

const Field& findField(std::span<const Field> fields, std::string_view key, const SettingOrigin& origin) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.key == key; });
  if (found != fields.end()) return *found;
  // A name without its group, or with a wrong one, is most likely a field of that name.
  std::vector<std::string> keys;
  std::string_view name = key.substr(key.rfind('.') + 1);
  std::string sameName;
  for (const Field& field : fields) {
    keys.push_back(field.key);
    if (sameName.empty() && field.key.ends_with("." + std::string(name))) sameName = field.key;
  }
  std::string hint = suggestion(key, keys);
  if (hint.empty() && !sameName.empty()) hint = fmt::format(" (did you mean \"{}\"?)", sameName);
  if (hint.empty()) hint = "; `isophote info --settings` lists all";
  fail(origin.kind, origin.subject, "there is no setting \"{}\"{}", key, hint);
}

void setField(const Field& field, const Json& json, std::string_view text, const SettingOrigin& origin) {
  std::visit(Setter{field, json, text, origin}, field.value);
}

/// The value of a field as JSON.
Json valueJson(const Field& field) {
  return std::visit(
      [](const auto& ref) -> Json {
        using T = Value<decltype(ref)>;
        if constexpr (std::is_same_v<T, EnumRef>) {
          return ref.names.at(ref.get());
        } else if constexpr (std::is_same_v<T, float>) {
          // The shortest decimal that reads back as this float, not the double nearest to it
          // (0.05000000074505806).
          return std::stod(fmt::format("{}", *ref));
        } else {
          return *ref;
        }
      },
      field.value);
}

void setGroup(std::span<const Field> fields, const Json& object, const std::string& prefix,
              const SettingOrigin& origin) {
  for (const auto& [name, value] : object.items()) {
    const std::string key = prefix + name;
    const auto isGroup = [&](const Field& field) { return field.key.starts_with(key + "."); };
    if (value.is_object() && std::any_of(fields.begin(), fields.end(), isGroup))
      setGroup(fields, value, key + ".", origin);
    else
      setField(findField(fields, key, origin), value, value.dump(), origin);
  }
}

/// A number as people write it but JSON does not: with a leading plus, or a point at an end (.5, +2, 3.).
std::optional<double> plainNumber(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  return finiteNumber(text);
}

}  // namespace

void setSetting(std::span<const Field> fields, std::string_view key, std::string_view value,
                const SettingOrigin& origin) {
  const Field& field = findField(fields, key, origin);
  Json json = Json::parse(value, nullptr, false);
  if (json.is_discarded()) {
    if (const std::optional<double> number = plainNumber(value))
      json = *number;
    else
      json = std::string(value);
  }
  setField(field, json, value, origin);
}

void setFromAssignment(std::span<const Field> fields, std::string_view assignment,
                       const SettingOrigin& origin) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos)
    fail(origin.kind, origin.subject, "\"{}\" should read stage.name=value", assignment);
  setSetting(fields, assignment.substr(0, equals), assignment.substr(equals + 1), origin);
}

void setFromJson(std::span<const Field> fields, std::string_view text, const SettingOrigin& origin) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ...": the first words are not for
    // people.
    const std::string_view what = error.what();
    fail(origin.kind, origin.subject, "is not valid JSON: {}",
         what.substr(std::min(what.find("] ") + 2, what.size())));
  }
  requireUniqueKeys(text, origin.subject, origin.kind);
  if (!json.is_object())
    fail(origin.kind, origin.subject,
         "should hold a JSON object of settings, such as {{\"frame.width\": 640}}");
  setGroup(fields, json, "", origin);
}

std::string settingsJson(std::span<const Field> fields) {
  Json json = Json::object();
  for (const Field& field : fields) {
    const auto dot = field.key.find('.');
    if (dot == std::string::npos)
      json[field.key] = valueJson(field);
    else
      json[field.key.substr(0, dot)][field.key.substr(dot + 1)] = valueJson(field);
  }
  return json.dump(2) + "\n";
}

std::string valueText(const Field& field) {
  if (const auto* number = std::get_if<float*>(&field.value)) return fmt::format("{}", **number);
  const Json json = valueJson(field);
  return json.is_string() ? json.get<std::string>() : json.dump();
}

std::string rangeText(const Field& field) {
  if (const auto* names = std::get_if<EnumRef>(&field.value))
    return fmt::format("{}", fmt::join(names->names, ", "));
  if (std::holds_alternative<bool*>(field.value)) return "true, false";
  const Range range = rangeOf(field);
  const std::string unit = field.info.unit.empty() ? "" : fmt::format(" {}", field.info.unit);
  const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
  if (low && high) return fmt::format("{:.10g} to {:.10g}{}", range.min, range.max, unit);
  if (low) return fmt::format("at least {:.10g}{}", range.min, unit);
  if (high) return fmt::format("at most {:.10g}{}", range.max, unit);
  return "";
}

std::string settingsTable(std::span<const Field> fields) {
  std::string table = "| setting | default | range | meaning |\n|---|---|---|---|\n";
  for (const Field& field : fields)
    table += fmt::format("| `{}` | {} | {} | {} |\n", field.key, valueText(field), rangeText(field),
                         field.info.help);
  return table;
}

}  // namespace isophote

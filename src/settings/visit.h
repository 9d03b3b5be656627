// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

// A settings struct declares each of its fields once, in one member function:
//
//   struct DirectSettings {
//     float bias = 1e-4f;
//     void visit(auto&& v) { v("bias", bias, {.help = "Start of a shadow ray.", .unit = "m", .min = 0, .max =
//     1}); }
//   };
//
// The command line, the settings file, the help and the table in the docs all come from it
// (settings/apply.h).
namespace isophote {

/// What a person is told about a setting, and the range that is accepted.
struct FieldInfo {
  std::string_view help{};                                ///< One sentence.
  std::string_view unit{};                                ///< "m", "W", "px", ...; empty: a plain number.
  double min = -std::numeric_limits<double>::infinity();  ///< Smallest value accepted.
  double max = std::numeric_limits<double>::infinity();   ///< Largest value accepted.
};

/// Names of an enumeration's values 0, 1, ... in settings; specialise it beside the enumeration:
/// `template <> struct EnumNames<Estimator> { static constexpr std::array names{"volumes", "kdtree"}; };`
template <class E>
struct EnumNames;

/// A reference to a field of enumeration type, with its type erased.
struct EnumRef {
  std::vector<std::string_view> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// A reference to one field of a settings struct, which must outlive it.
struct Field {
  std::string key;  ///< "group.name", or "name" where the struct stands alone.
  FieldInfo info;
  std::variant<bool*, int*, std::uint32_t*, std::uint64_t*, float*, std::string*, EnumRef> value;
};

template <class E>
EnumRef enumRef(E& value) {
  EnumRef ref;
  for (const std::string_view name : EnumNames<E>::names) ref.names.push_back(name);
  ref.get = [&value] { return std::size_t(value); };
  ref.set = [&value](std::size_t index) { value = E(index); };
  return ref;
}

/// The visitor behind fieldsOf().
struct FieldCollector {
  std::string_view group;
  std::vector<Field>& fields;

  template <class T>
  void operator()(std::string_view name, T& value, const FieldInfo& info) {
    std::string key = group.empty() ? std::string(name) : std::string(group) + "." + std::string(name);
    if constexpr (std::is_enum_v<T>)
      fields.push_back({std::move(key), info, enumRef(value)});
    else
      fields.push_back({std::move(key), info, &value});
  }
};

/// The fields of one settings struct, in the order of its visit(); keys are "group.name".
template <class Settings>
std::vector<Field> fieldsOf(Settings& settings, std::string_view group = {}) {
  std::vector<Field> fields;
  settings.visit(FieldCollector{group, fields});
  return fields;
}

/// The fields of every group of a struct that declares its groups in `visitGroups(auto&& v)`:
/// `v("photon_trace", photonTrace);`.
template <class Groups>
std::vector<Field> fieldsOfGroups(Groups& groups) {
  std::vector<Field> fields;
  groups.visitGroups([&fields](std::string_view name, auto& settings) {
    for (Field& field : fieldsOf(settings, name)) fields.push_back(std::move(field));
  });
  return fields;
}

}  // namespace isophote

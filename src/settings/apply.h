// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "settings/visit.h"

#include <span>
#include <string>
#include <string_view>

namespace isophote {

/// Where a setting was written, for the sentence of an error: a file or an option.
struct SettingOrigin {
  ErrorKind kind = ErrorKind::kBadUsage;
  std::string subject;  ///< "--set", "room.json", ...
};

/// Sets the field of that key ("photon_trace.photons") from a JSON value; text that is no JSON is a bare
/// word. Throws where there is no such key (naming the nearest), the type does not fit or the value is out of
/// range; the field then keeps its value.
void setSetting(std::span<const Field> fields, std::string_view key, std::string_view value,
                const SettingOrigin& origin);

/// The same from "key=value".
void setFromAssignment(std::span<const Field> fields, std::string_view assignment,
                       const SettingOrigin& origin);

/// Sets every key of a JSON object, nested ({"photon_trace": {"photons": 1}}) or dotted
/// ({"photon_trace.photons": 1}).
void setFromJson(std::span<const Field> fields, std::string_view json, const SettingOrigin& origin);

/// All settings as a nested JSON object that setFromJson() accepts.
std::string settingsJson(std::span<const Field> fields);

/// A field's value as setSetting() reads it; strings and names without quotes.
std::string valueText(const Field& field);
/// The values that a field accepts, in words: "1 to 64 px", "at least 0", "volumes, kdtree", "true, false";
/// "" where every value of its type will do.
std::string rangeText(const Field& field);
/// A Markdown table of key, default (the current value), range and help.
std::string settingsTable(std::span<const Field> fields);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace isophote {

/// The number that all of a text is (-2, .5, 3., 1e6); nothing where it is none, or not a finite one.
inline std::optional<double> finiteNumber(std::string_view text) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [last, problem] = std::from_chars(text.data(), end, number);
  if (problem != std::errc() || last != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace isophote

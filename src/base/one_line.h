// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace isophote {

/// The text without control characters, which a file's name or content may hold: they would break the line or
/// steer a terminal.
inline std::string onOneLine(std::string_view text) {
  std::string line(text);
  for (char& c : line)
    if ((c >= 0 && c < ' ') || c == 0x7f) c = '?';
  return line;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// What keeps a text from being well-formed XML, as far as our SVG writer could get it wrong: elements that
/// are not closed, attributes without quotes, bare '<' or '&'. Empty: nothing.
inline std::string xmlProblem(std::string_view xml) {
  std::vector<std::string> open;
  bool rooted = false;
  for (std::size_t at = 0; at < xml.size(); ++at) {
    if (xml[at] == '&') {
      const std::size_t end = xml.find(';', at);
      if (end == std::string_view::npos || end - at > 6) return fmt::format("a bare & at byte {}", at);
    }
    if (open.empty() && rooted && xml[at] != '<' && xml[at] != '\n') return "text after the root";
    if (xml[at] != '<') continue;
    const std::size_t end = xml.find('>', at);
    if (end == std::string_view::npos) return fmt::format("an element that is not ended at byte {}", at);
    std::string_view element = xml.substr(at + 1, end - at - 1);
    at = end;
    if (element.empty() || element.find('<') != std::string_view::npos)
      return fmt::format("a bare < before byte {}", end);
    if (element.front() == '/') {
      if (open.empty() || open.back() != element.substr(1))
        return fmt::format("</{}> closes nothing", element.substr(1));
      open.pop_back();
      continue;
    }
    const bool closed = element.back() == '/';
    if (closed) element.remove_suffix(1);
    std::size_t quotes = 0, equals = 0;
    bool quoted = false;
    for (const char c : element) {
      if (c == '"') quoted = !quoted, ++quotes;
      if (c == '=' && !quoted) ++equals;
    }
    if (quotes != 2 * equals) return fmt::format("<{}> has an attribute without quotes", element);
    if (!closed) open.emplace_back(element.substr(0, element.find(' ')));
    rooted = true;
  }
  return open.empty() ? "" : fmt::format("<{}> is not closed", open.back());
}

}  // namespace isophote

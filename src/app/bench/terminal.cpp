// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/writers.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace isophote::bench {
namespace {

/// Columns that a text takes on a terminal: bytes but for those that continue a UTF-8 character.
std::size_t widthOf(std::string_view text) {
  return std::size_t(std::ranges::count_if(text, [](char c) { return (std::uint8_t(c) & 0xc0) != 0x80; }));
}

/// Words up to about `width` a line; one that is longer has a line of its own.
std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
  std::vector<std::string> lines{""};
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (!lines.back().empty() && widthOf(lines.back()) + 1 + widthOf(word) > width) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
    at = end + 1;
  }
  return lines;
}

std::string aligned(std::string_view text, std::size_t width, bool right) {
  const std::string gap(width - std::min(width, widthOf(text)), ' ');
  return right ? gap + std::string(text) : std::string(text) + gap;
}

/// The lines above a column of figures: its name in several, and its unit.
std::vector<std::string> headOf(const Column& column) {
  constexpr std::size_t kHeadWidth = 14;
  std::vector<std::string> lines = wrapped(columnName(column), kHeadWidth);
  if (!column.unit.empty()) lines.push_back("[" + column.unit + "]");
  return lines;
}

}  // namespace

std::string terminalTable(const Table& table) {
  constexpr std::size_t kTextWidth = 100;
  std::vector<std::vector<std::string>> heads;
  std::vector<std::size_t> widths;
  std::size_t lines = 0;
  for (std::size_t column = 0; column < table.columns.size(); ++column) {
    heads.push_back(headOf(table.columns[column]));
    lines = std::max(lines, heads.back().size());
    std::size_t width = 0;
    for (const std::string& line : heads.back()) width = std::max(width, widthOf(line));
    for (const auto& row : table.rows) width = std::max(width, widthOf(shownCell(row[column])));
    widths.push_back(width);
  }
  std::string text = table.title + "\n";
  const auto addLine = [&](auto&& cellOf) {
    std::string line;
    for (std::size_t column = 0; column < table.columns.size(); ++column)
      line += (column ? "  " : "") +
              aligned(cellOf(column), widths[column], table.columns[column].source != Source::kText);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  for (std::size_t i = 0; i < lines; ++i)
    addLine([&](std::size_t column) { return i < heads[column].size() ? heads[column][i] : std::string(); });
  std::size_t total = 2 * (widths.size() - std::min<std::size_t>(widths.size(), 1));
  for (const std::size_t width : widths) total += width;
  text += std::string(total, '-') + "\n";
  for (const auto& row : table.rows) addLine([&](std::size_t column) { return shownCell(row[column]); });
  if (!table.caption.empty())
    for (const std::string& line : wrapped(table.caption, kTextWidth)) text += line + "\n";
  return text;
}

}  // namespace isophote::bench

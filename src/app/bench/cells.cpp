// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/report.h"

#include <fmt/format.h>

#include <algorithm>

namespace isophote::bench {
namespace {

/// "13,688"
std::string withCommas(double whole) {
  const std::string digits = fmt::format("{:.0f}", std::abs(whole));
  std::string text = whole < 0 ? "-" : "";
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

}  // namespace

std::string columnName(const Column& column) {
  const bool told = column.name.find("paper") != std::string::npos;
  return column.source == Source::kPaper && !told ? column.name + ", paper" : column.name;
}

std::string shownNumber(const Cell& cell) {
  if (!cell.isNumber()) return cell.text;
  const double size = std::abs(cell.value);
  if (std::isinf(cell.value)) return cell.value > 0 ? "infinite" : "-infinite";
  if (size >= 9999.5) return withCommas(cell.value);
  if (size > 0 && size < 1e-4) return fmt::format("{:.1e}", cell.value);
  const int before = size >= 1 ? int(std::floor(std::log10(size))) + 1 : 0;  // Digits before the point.
  const bool whole = cell.value == std::round(cell.value) && cell.repeats == 0;
  const int after = whole ? 0 : std::clamp(cell.digits - std::max(before, 0), 0, 6);
  return fmt::format("{:.{}f}", cell.value, after);
}

std::string shownCell(const Cell& cell) {
  std::string number = shownNumber(cell);
  if (cell.repeats < 2 || !(cell.value > 0)) return number;
  return fmt::format("{} ± {:.0f} %", number, 50 * (cell.high - cell.low) / cell.value);
}

}  // namespace isophote::bench

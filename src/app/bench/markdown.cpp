// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/writers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace isophote::bench {
namespace {

/// Text in a table's cell.
std::string cellText(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : c == '\n' ? " " : std::string(1, c);
  return out;
}

std::string tableLine(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += cell.empty() ? " |" : " " + cell + " |";
  return line + "\n";
}

std::string headOf(const Column& column) {
  const std::string name = columnName(column);
  return cellText(column.unit.empty() ? name : fmt::format("{} [{}]", name, column.unit));
}

std::string markdownTable(const Table& table) {
  std::vector<std::string> heads, rules;
  for (const Column& column : table.columns) {
    heads.push_back(headOf(column));
    rules.emplace_back(column.source == Source::kText ? "---" : "---:");
  }
  std::string text = fmt::format("*{}.*", table.title);
  if (!table.caption.empty()) text += " " + table.caption;
  text += "\n\n" + tableLine(heads) + tableLine(rules);
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    cells.reserve(row.size());
    for (const Cell& cell : row) cells.push_back(cellText(shownCell(cell)));
    text += tableLine(cells);
  }
  return text + "\n";
}

/// The curves as a table: a row for each place on the x axis where any of them has a point. Long curves are
/// left to the report.
std::string markdownPlot(const Plot& plot) {
  constexpr std::size_t kMost = 16;
  std::map<double, std::vector<Cell>> rows;
  for (std::size_t i = 0; i < plot.series.size(); ++i)
    for (const auto& [x, y] : plot.series[i].points) {
      auto& row = rows[x];
      row.resize(plot.series.size());
      row[i] = Cell(y);
    }
  if (rows.size() > kMost) return "";
  Table table{.id = plot.id, .title = plot.title, .caption = plot.caption, .columns = {{plot.x.label}}};
  if (!plot.y.label.empty())
    table.caption += fmt::format("{}In the columns: {}.", plot.caption.empty() ? "" : " ", plot.y.label);
  for (const Series& series : plot.series) table.columns.push_back({series.name, Source::kHere});
  for (auto& [x, row] : rows) {
    const bool named = x >= 0 && std::size_t(x) < plot.categories.size();
    row.insert(row.begin(), named ? Cell(plot.categories[std::size_t(x)]) : Cell(shownNumber(Cell(x))));
    table.rows.push_back(std::move(row));
  }
  return markdownTable(table);
}

std::string markdownPictures(const PictureSet& set) {
  Table table{.id = set.id,
              .title = set.title,
              .caption = set.caption,
              .columns = {{"picture"},
                          {"PSNR", Source::kHere, "dB"},
                          {"FLIP", Source::kHere},
                          {"mean over the reference's", Source::kHere}}};
  for (const JudgedPicture& judged : set.pictures)
    table.rows.push_back({judged.picture.name, judged.psnr, judged.flip, Cell(judged.meanRatio, 4)});
  return markdownTable(table);
}

}  // namespace

std::string reportMarkdown(const Report& report) {
  const Machine& machine = report.machine;
  std::string text;
  for (const Section& section : report.sections) {
    text += fmt::format("### bench {}\n\n{}. {}, {} threads, {}; {:.0f} s{}.\n\n", section.suite,
                        section.description, machine.processor, machine.threads, machine.instructions,
                        section.seconds, report.quick ? "; quick, so that sizes are reduced" : "");
    text += fmt::format("    {}\n\n", machine.command);
    for (const Table& table : section.tables) text += markdownTable(table);
    // What a table holds already is not told twice.
    const auto told = [&](const std::string& id) {
      return std::ranges::any_of(section.tables, [&](const Table& table) { return table.id == id; });
    };
    for (const Plot& plot : section.plots)
      if (!told(plot.id)) text += markdownPlot(plot);
    for (const PictureSet& set : section.pictures)
      if (!told(set.id)) text += markdownPictures(set);
    for (const std::string& note : section.notes) text += fmt::format("- {}\n", note);
    if (!section.notes.empty()) text += "\n";
  }
  return text;
}

}  // namespace isophote::bench

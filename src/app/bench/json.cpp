// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/writers.h"

#include <nlohmann/json.hpp>

namespace isophote::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kSourceNames{"text", "paper", "here", "yardstick"};

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// A text, a number, a number with its quartiles, or null.
Json toJson(const Cell& cell) {
  if (!cell.isNumber()) return cell.text.empty() ? Json(nullptr) : Json(cell.text);
  if (cell.repeats == 0) return finite(cell.value);
  return {{"median", cell.value}, {"low", cell.low}, {"high", cell.high}, {"repeats", cell.repeats}};
}

Json toJson(const Table& table) {
  Json json{{"id", table.id}, {"title", table.title}, {"caption", table.caption}};
  json["columns"] = Json::array();
  for (const Column& column : table.columns)
    json["columns"].push_back(
        {{"name", column.name}, {"source", kSourceNames[std::size_t(column.source)]}, {"unit", column.unit}});
  json["rows"] = Json::array();
  for (const std::vector<Cell>& row : table.rows) {
    Json cells = Json::array();
    for (const Cell& cell : row) cells.push_back(toJson(cell));
    json["rows"].push_back(std::move(cells));
  }
  return json;
}

Json toJson(const Plot& plot) {
  Json json{{"id", plot.id},
            {"title", plot.title},
            {"caption", plot.caption},
            {"x", plot.x.label},
            {"y", plot.y.label}};
  if (!plot.categories.empty()) json["categories"] = plot.categories;
  json["series"] = Json::array();
  for (const Series& series : plot.series) {
    Json points = Json::array();
    for (const auto& [x, y] : series.points) points.push_back({finite(x), finite(y)});
    json["series"].push_back({{"name", series.name},
                              {"source", kSourceNames[std::size_t(series.source)]},
                              {"points", std::move(points)}});
  }
  return json;
}

Json toJson(const PictureSet& set) {
  Json json{{"id", set.id},
            {"title", set.title},
            {"caption", set.caption},
            {"reference", set.reference.name},
            {"width", set.reference.width},
            {"height", set.reference.height}};
  json["pictures"] = Json::array();
  for (const JudgedPicture& judged : set.pictures)
    json["pictures"].push_back({{"name", judged.picture.name},
                                {"psnr", finite(judged.psnr)},
                                {"flip", judged.flip},
                                {"meanRatio", finite(judged.meanRatio)}});
  return json;
}

template <class T>
Json toArray(const std::vector<T>& list) {
  Json array = Json::array();
  for (const T& element : list) array.push_back(toJson(element));
  return array;
}

/// Adds a suite's members to an object.
void addSection(Json& json, const Section& section) {
  json["suite"] = section.suite;
  json["seconds"] = section.seconds;
  json["notes"] = section.notes;
  json["tables"] = toArray(section.tables);
  json["plots"] = toArray(section.plots);
  json["pictures"] = toArray(section.pictures);
  json.update(section.data);
}

}  // namespace

std::string reportJson(const Report& report) {
  Json json{{"suite", report.suite},
            {"version", report.machine.version},
            {"processor", report.machine.processor},
            {"threads", report.machine.threads},
            {"instructions", report.machine.instructions},
            {"command", report.machine.command},
            {"quick", report.quick}};
  if (report.sections.size() == 1 && report.sections.front().suite == report.suite) {
    addSection(json, report.sections.front());
  } else {
    json["suites"] = Json::array();
    for (const Section& section : report.sections) addSection(json["suites"].emplace_back(), section);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isophote::bench

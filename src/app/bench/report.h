// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What a suite hands in: tables, plots, pictures and sentences. How they look on a terminal, in JSON,
// Markdown and HTML is told by the writers at the end; a suite knows nothing of it.
#pragma once

#include "app/bench/samples.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace isophote::bench {

/// Where the figures of a column or a curve come from; readers see them in different colours.
enum class Source {
  kText,       ///< No figures: names, sizes, settings.
  kPaper,      ///< Printed in the paper.
  kHere,       ///< Measured in this run.
  kYardstick,  ///< Measured in the same run: what ours is judged by, such as Embree alone on the primary
               ///< rays.
};

/// One entry of a table: nothing, a text, a number, or a number with its spread.
struct Cell {
  std::string text;
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();  ///< Quartiles, of repeated measurements.
  double high = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t repeats = 0;  ///< 0: a plain number.
  int digits = 3;             ///< Significant ones that people are shown; JSON has all.

  Cell() = default;  ///< Empty: "not measured", "not printed in the paper".
  Cell(const char* words) : text(words) {}
  Cell(std::string words) : text(std::move(words)) {}
  Cell(double number, int shownDigits = 3) : value(number), digits(shownDigits) {}
  Cell(const Samples& samples)
      : value(samples.median()),
        low(samples.low()),
        high(samples.high()),
        repeats(std::uint32_t(samples.size())) {}

  bool isNumber() const { return !std::isnan(value); }
};

struct Column {
  std::string name = {};  ///< Short: it heads a column on a terminal.
  Source source = Source::kText;
  std::string unit = {};  ///< "ms"; empty: none.
};

/// Rows of measurements. A row of a paper's table says which scene was really used (SceneChoice::name), what
/// the paper has, what was measured here, and the yardstick of the same run.
struct Table {
  std::string id = {};       ///< Within the suite, for scripts: "table2".
  std::string title = {};    ///< "Table 2: frames"
  std::string caption = {};  ///< Sentences: what a row is, on which hardware the paper's figures were taken.
  std::vector<Column> columns = {};
  std::vector<std::vector<Cell>> rows = {};  ///< Each as long as `columns`.
};

struct Series {
  std::string name = {};
  Source source = Source::kHere;                       ///< kPaper is dashed.
  std::vector<std::pair<double, double>> points = {};  ///< Of bars: x is the place of the category.
};

struct Axis {
  std::string label = {};  ///< With its unit: "photons", "time [ms]".
  bool logarithmic = false;
};

/// Curves, or bars where there are categories.
struct Plot {
  std::string id = {};
  std::string title = {};
  std::string caption = {};
  Axis x = {}, y = {};
  std::vector<Series> series = {};
  std::vector<std::string> categories = {};  ///< Not empty: bars, one group a category.
  bool stacked = false;                      ///< Bars of a category on top of each other.
};

/// A picture as it is shown, as a PNG file's bytes.
struct ShownPicture {
  std::string name = {};
  int width = 0, height = 0;
  std::vector<std::uint8_t> png = {};
};

/// A picture beside the one that it is judged by.
struct JudgedPicture {
  ShownPicture picture = {};
  double psnr = 0;                        ///< [dB]
  double flip = 0;                        ///< Mean, 0 to 1.
  double meanRatio = 1;                   ///< Mean of the linear values over the reference's.
  ShownPicture error = {};                ///< FLIP at every pixel.
  std::array<ShownPicture, 3> zoom = {};  ///< Reference, picture and error where the error is greatest.
};

/// Pictures of one view that readers compare under a slider.
struct PictureSet {
  std::string id = {};
  std::string title = {};
  std::string caption = {};
  ShownPicture reference = {};
  std::vector<JudgedPicture> pictures = {};
};

/// All that one suite came to.
struct Section {
  std::string suite = {};
  std::string description = {};
  std::vector<std::string> notes = {};  ///< Sentences: stand-ins for scenes, what was left out and why.
  std::vector<Table> tables = {};
  std::vector<Plot> plots = {};
  std::vector<PictureSet> pictures = {};
  /// More for scripts, beside these in the suite's JSON object: pass by pass, stage by stage.
  nlohmann::ordered_json data = nlohmann::ordered_json::object();
  double seconds = 0;  ///< How long the suite took.
};

/// What was measured on, and how.
struct Machine {
  std::string version, processor, instructions;
  int threads = 0;
  std::string command = {};  ///< As a person repeats it.
};

struct Report {
  Machine machine = {};
  std::string suite = {};  ///< As asked for: "ispm", "all".
  bool quick = false;
  std::vector<Section> sections = {};
};

/// What heads a column where there are no colours: "frame, paper", unless its name says so itself.
std::string columnName(const Column& column);
/// A cell's number as people read it: "0.0123", "12.3", "1230"; the text of other cells, "" of empty ones.
std::string shownNumber(const Cell& cell);
/// The same with the spread, half the distance between the quartiles as a part of the median: "12.3 ± 4 %".
std::string shownCell(const Cell& cell);

}  // namespace isophote::bench

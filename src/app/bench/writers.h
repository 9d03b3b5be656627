// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/report.h"

#include <string>

namespace isophote::bench {

/// A table for a terminal: its title, aligned columns (the unit below the name), its caption.
std::string terminalTable(const Table& table);

/// The whole report. Of one suite: an object with its tables, plots and data; of `all`: these under "suites".
std::string reportJson(const Report& report);

/// Tables and notes, and the points of the plots as tables.
std::string reportMarkdown(const Report& report);

/// One page without anything from outside: tables, plots as SVG, pictures under sliders. For tests, the
/// fragment "#cut=25" sets all sliders to 25 %.
std::string reportHtml(const Report& report);

/// A plot as an SVG image; text and axes have the colour of the text around it ("currentColor").
std::string plotSvg(const Plot& plot);

/// Text with &, <, >, " and ' as entities.
std::string escaped(std::string_view text);

}  // namespace isophote::bench

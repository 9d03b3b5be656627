// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/svg_scale.h"
#include "app/bench/writers.h"

#include <fmt/format.h>

#include <algorithm>

namespace isophote::bench {
namespace {

constexpr double kWidth = 720, kLeft = 72, kRight = 700, kTop = 20, kBottom = 330;
constexpr double kLegendTop = 392, kLegendLine = 22;

/// Told apart by people who see colours differently, and on light and dark paper.
constexpr std::array kColours{"#2f7fd6", "#e0782b", "#2a9d6e", "#c64b8c",
                              "#8a6fd1", "#b59a1f", "#5aa9c9", "#9a5b3b"};

std::string colourOf(std::size_t series) { return kColours[series % kColours.size()]; }

/// Where values lie in the picture.
struct Frame {
  Scale x, y;
  double right(double value) const { return kLeft + x.place(value) * (kRight - kLeft); }
  double down(double value) const { return kBottom - y.place(value) * (kBottom - kTop); }
};

std::string text(double x, double y, std::string_view anchor, std::string_view words,
                 std::string_view more = "") {
  return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}"{}>{}</text>)"
                     "\n",
                     x, y, anchor, more, escaped(words));
}

std::string line(double x0, double y0, double x1, double y1, std::string_view more) {
  return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" {}/>)"
                     "\n",
                     x0, y0, x1, y1, more);
}

std::string axes(const Plot& plot, const Frame& frame) {
  constexpr std::string_view kGrid = R"(stroke="currentColor" stroke-opacity="0.14")";
  constexpr std::string_view kAxis = R"(stroke="currentColor" stroke-opacity="0.6")";
  std::string svg;
  for (const Tick& tick : frame.y.ticks()) {
    const double y = frame.down(tick.value);
    svg += line(kLeft, y, kRight, y, kGrid);
    svg += text(kLeft - 8, y + 4, "end", tick.label);
  }
  if (plot.categories.empty())
    for (const Tick& tick : frame.x.ticks()) {
      const double x = frame.right(tick.value);
      svg += line(x, kTop, x, kBottom, kGrid);
      svg += text(x, kBottom + 18, "middle", tick.label);
    }
  svg += line(kLeft, kBottom, kRight, kBottom, kAxis);
  svg += line(kLeft, kTop, kLeft, kBottom, kAxis);
  svg += text((kLeft + kRight) / 2, kBottom + 42, "middle", plot.x.label);
  svg += text(0, 0, "middle", plot.y.label,
              fmt::format(R"~( transform="translate(18 {:.1f}) rotate(-90)")~", (kTop + kBottom) / 2));
  return svg;
}

std::string curve(const Series& series, std::size_t index, const Frame& frame) {
  std::string path, marks;
  for (const auto& [x, y] : series.points) {
    if (!frame.x.holds(x) || !frame.y.holds(y)) continue;
    const double right = frame.right(x), down = frame.down(y);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", right, down);
    if (series.points.size() <= 40)
      marks += fmt::format(
          R"(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="{}"><title>{}: {}, {}</title></circle>)"
          "\n",
          right, down, colourOf(index), escaped(series.name), shownNumber(Cell(x)), shownNumber(Cell(y)));
  }
  if (path.empty()) return "";
  return fmt::format(R"(<path d="{}" fill="none" stroke="{}" stroke-width="2"{}/>)"
                     "\n{}",
                     path, colourOf(index),
                     series.source == Source::kPaper ? R"( stroke-dasharray="6 4")" : "", marks);
}

std::string bars(const Plot& plot, const Frame& frame) {
  const double group = (kRight - kLeft) / double(plot.categories.size());
  const double wide = 0.8 * group / (plot.stacked ? 1.0 : double(plot.series.size()));
  std::vector<double> heights(plot.categories.size(), 0.0);
  std::string svg;
  for (std::size_t i = 0; i < plot.series.size(); ++i)
    for (const auto& [category, value] : plot.series[i].points) {
      const auto at = std::size_t(category);
      if (at >= plot.categories.size() || !frame.y.holds(value)) continue;
      const double from = plot.stacked ? heights[at] : frame.y.low();
      heights[at] += value;
      const double top = frame.down(plot.stacked ? heights[at] : value);
      svg += fmt::format(
          R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"{}><title>{}, {}: {}</title></rect>)"
          "\n",
          kLeft + (double(at) + 0.1) * group + (plot.stacked ? 0.0 : double(i) * wide), top, wide,
          std::max(frame.down(from) - top, 0.0), colourOf(i),
          plot.series[i].source == Source::kPaper ? R"( fill-opacity="0.55")" : "",
          escaped(plot.categories[at]), escaped(plot.series[i].name), shownNumber(Cell(value)));
    }
  for (std::size_t at = 0; at < plot.categories.size(); ++at)
    svg += text(kLeft + (double(at) + 0.5) * group, kBottom + 18, "middle", plot.categories[at]);
  return svg;
}

/// Rows of names; the height that they end at is in `bottom`.
std::string legend(const Plot& plot, double& bottom) {
  constexpr double kMark = 26, kLetter = 7.2;
  double x = kLeft, y = kLegendTop;
  std::string svg;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const double wide = kMark + 14 + kLetter * double(plot.series[i].name.size());
    if (x > kLeft && x + wide > kRight) {
      x = kLeft;
      y += kLegendLine;
    }
    const bool paper = plot.series[i].source == Source::kPaper;
    svg +=
        line(x, y - 4, x + kMark - 6, y - 4,
             fmt::format(
                 R"(stroke="{}" stroke-width="{}"{})", colourOf(i), plot.categories.empty() ? 3 : 10,
                 paper ? plot.categories.empty() ? R"( stroke-dasharray="6 4")" : R"( stroke-opacity="0.55")"
                       : ""));
    svg += text(x + kMark, y, "start", plot.series[i].name);
    x += wide;
  }
  bottom = y + 12;
  return svg;
}

Frame frameOf(const Plot& plot) {
  std::vector<double> xs, ys;
  std::vector<double> heights(plot.categories.size(), 0.0);
  for (const Series& series : plot.series)
    for (const auto& [x, y] : series.points) {
      xs.push_back(x);
      const auto at = std::size_t(std::max(x, 0.0));
      ys.push_back(plot.stacked && at < heights.size() ? heights[at] += y : y);
    }
  const bool fromZero = !plot.categories.empty();
  return {Scale(xs, plot.x.logarithmic, false), Scale(ys, plot.y.logarithmic, fromZero)};
}

}  // namespace

std::string plotSvg(const Plot& plot) {
  const Frame frame = frameOf(plot);
  double bottom = 0;
  std::string body = axes(plot, frame);
  if (plot.categories.empty())
    for (std::size_t i = 0; i < plot.series.size(); ++i) body += curve(plot.series[i], i, frame);
  else
    body += bars(plot, frame);
  body += legend(plot, bottom);
  return fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {:.0f} {:.0f}" role="img" font-family="system-ui, sans-serif" font-size="13" fill="currentColor">
<title>{}</title>
{}</svg>
)",
      kWidth, bottom, escaped(plot.title), body);
}

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/html_page.h"
#include "app/bench/writers.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace isophote::bench {
namespace {

constexpr std::array<std::string_view, 4> kClasses{"text", "paper", "here", "yardstick"};

std::string_view classOf(const Column& column) { return kClasses[std::size_t(column.source)]; }

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(bytes.size() - i, 3);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (j < count ? bytes[i + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += j <= count ? kDigits[group >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

std::string image(const ShownPicture& picture, std::string_view more = "") {
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\"{}>", escaped(picture.name),
                     base64(picture.png), more);
}

std::string paragraph(std::string_view words) {
  return words.empty() ? "" : fmt::format("<p class=\"soft\">{}</p>\n", escaped(words));
}

std::string cellHtml(const Cell& cell) {
  const std::string all = shownCell(cell), number = shownNumber(cell);
  if (all == number) return escaped(number);
  return escaped(number) + " <small>" + escaped(all.substr(number.size() + 1)) + "</small>";
}

std::string tableHtml(const Table& table) {
  std::string html = fmt::format("<h3>{}</h3>\n{}<div class=\"wide\"><table>\n<thead><tr>",
                                 escaped(table.title), paragraph(table.caption));
  for (const Column& column : table.columns)
    html += fmt::format("<th class=\"{}\">{}{}</th>", classOf(column), escaped(column.name),
                        column.unit.empty() ? "" : fmt::format("<i>{}</i>", escaped(column.unit)));
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      html += fmt::format("<td class=\"{}\">{}</td>", classOf(table.columns[i]), cellHtml(row[i]));
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string plotsHtml(const std::vector<Plot>& plots) {
  if (plots.empty()) return "";
  std::string html = "<h3>Curves</h3>\n<div class=\"plots\">\n";
  for (const Plot& plot : plots)
    html += fmt::format("<figure class=\"plot\"><h3>{}</h3>\n{}{}</figure>\n", escaped(plot.title),
                        paragraph(plot.caption), plotSvg(plot));
  return html + "</div>\n";
}

/// Its measures, and where it errs most.
std::string judgedHtml(const JudgedPicture& judged, std::size_t index) {
  constexpr std::array<std::string_view, 3> kTitles{"reference, magnified", "picture, magnified",
                                                    "error there"};
  std::string html = fmt::format(
      "<div class=\"judged\" data-index=\"{}\"{}>\n<p class=\"measures\">PSNR <b>{} dB</b> FLIP "
      "<b>{:.4f}</b> mean "
      "over the reference's <b>{:.4f}</b></p>\n<div class=\"zooms\">",
      index, index ? " hidden" : "", shownNumber(Cell(judged.psnr)), judged.flip, judged.meanRatio);
  for (std::size_t i = 0; i < judged.zoom.size(); ++i)
    html += fmt::format("<div>{}{}</div>", image(judged.zoom[i]), kTitles[i]);
  return html + fmt::format("<div>{}error (FLIP)</div></div></div>\n", image(judged.error));
}

std::string picturesHtml(const PictureSet& set) {
  const ShownPicture& reference = set.reference;
  // Neither wider nor higher than a window has room for.
  const double width = std::min(960.0, 640.0 * reference.width / std::max(reference.height, 1));
  std::string html = fmt::format("<figure class=\"compare\" style=\"max-width: {:.0f}px\"><h3>{}</h3>\n{}",
                                 width, escaped(set.title), paragraph(set.caption));
  if (set.pictures.size() > 1) {
    html += "<div class=\"tabs\" role=\"tablist\">";
    for (std::size_t i = 0; i < set.pictures.size(); ++i)
      html += fmt::format("<button role=\"tab\" data-index=\"{}\" aria-selected=\"{}\">{}</button>", i,
                          i == 0, escaped(set.pictures[i].picture.name));
    html += "</div>\n";
  }
  html += fmt::format("<div class=\"stage\" style=\"aspect-ratio: {} / {}\">{}", reference.width,
                      reference.height, image(reference));
  std::string judged;
  for (std::size_t i = 0; i < set.pictures.size(); ++i) {
    const JudgedPicture& picture = set.pictures[i];
    const std::string_view hidden = i ? " hidden" : "";
    html += image(picture.picture, fmt::format(" class=\"above\" data-index=\"{}\"{}", i, hidden));
    html +=
        fmt::format("<b class=\"left\" data-index=\"{}\"{}>{}</b>", i, hidden, escaped(picture.picture.name));
    judged += judgedHtml(picture, i);
  }
  html += fmt::format("<b class=\"right\">{}</b><span class=\"bar\"></span>", escaped(reference.name));
  html += fmt::format(
      "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" step=\"0.1\" aria-label=\"{}\"></div>\n",
      escaped("How much of the picture is shown over the " + reference.name));
  return html + judged + "</figure>\n";
}

std::string sectionHtml(const Section& section) {
  std::string html = fmt::format(
      "<section id=\"{0}\"><h2>{0}</h2>\n<p>{1}. <span class=\"soft\">{2:.1f} "
      "s</span></p>\n",
      escaped(section.suite), escaped(section.description), section.seconds);
  if (!section.notes.empty()) {
    html += "<ul class=\"notes\">\n";
    for (const std::string& note : section.notes) html += fmt::format("<li>{}</li>\n", escaped(note));
    html += "</ul>\n";
  }
  for (const Table& table : section.tables) html += tableHtml(table);
  html += plotsHtml(section.plots);
  for (const PictureSet& set : section.pictures) html += picturesHtml(set);
  return html + "</section>\n";
}

std::string headerHtml(const Report& report) {
  const Machine& machine = report.machine;
  std::string html = fmt::format(
      "<header><h1>Isophote <span>bench {}</span></h1>\n<p class=\"soft\">Isophote {} on {}, {} threads, "
      "{}{}. "
      "<code>{}</code></p>\n<p class=\"soft key\"><span class=\"paper\">the paper's figure</span><span "
      "class=\"here\">measured here: median ± half the distance of the quartiles</span><span "
      "class=\"yardstick\">yardstick of the same run</span></p>\n",
      escaped(report.suite), escaped(machine.version), escaped(machine.processor), machine.threads,
      escaped(machine.instructions), report.quick ? ", quick: sizes and photons are reduced" : "",
      escaped(machine.command));
  if (report.sections.size() > 1) {
    html += "<nav>";
    for (const Section& section : report.sections)
      html += fmt::format("<a href=\"#{0}\">{0}</a>", escaped(section.suite));
    html += "</nav>\n";
  }
  return html + "</header>\n";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += c;
  }
  return out;
}

std::string reportHtml(const Report& report) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><title>Isophote bench "
      "{}</title>\n<style>{}</style></head>\n"
      "<body>\n{}<main>\n",
      escaped(report.suite), kStyle, headerHtml(report));
  for (const Section& section : report.sections) html += sectionHtml(section);
  return html + fmt::format(
                    "<footer class=\"soft\">Written by isophote bench.</footer></main>\n<script>{}</script>\n"
                    "</body></html>\n",
                    kScript);
}

}  // namespace isophote::bench

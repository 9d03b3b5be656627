// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/writers.h"
#include "app/bench/suite.h"
#include "app/bench/svg_scale.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace isophote::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

Samples samplesOf(std::initializer_list<double> values) {
  Samples samples;
  for (const double value : values) samples.add(value);
  return samples;
}

Table frames() {
  return {
      .id = "table2",
      .title = "Table 2: frames",
      .caption = "On a <GPU> & eight cores.",
      .columns = {{"scene"}, {"frame", Source::kPaper, "ms"}, {"here", Source::kHere, "ms"}},
      .rows = {{"ring | room", 84.0, Cell(samplesOf({9, 10, 10, 11, 40}))}, {"Šibenik", Cell(), 13'688.0}}};
}

Plot curves(bool logarithmic) {
  return {.id = "curve",
          .title = "Time < area",
          .caption = "",
          .x = {"photons", logarithmic},
          .y = {"time [ms]", logarithmic},
          .series = {{"here", Source::kHere, {{1000, 2.5}, {100'000, 80}}},
                     {"paper", Source::kPaper, {{1000, 5}, {100'000, std::nan("")}, {0, 0}}}}};
}

Report report() {
  Report report;
  report.suite = "ispm";
  report.machine = {.version = "1", .processor = "P", .instructions = "avx2", .threads = 2, .command = "c"};
  Section& section = report.sections.emplace_back();
  section.suite = "ispm";
  section.description = "Frames";
  section.notes = {"atrium stands in."};
  section.tables = {frames()};
  section.plots = {curves(true)};
  const Image grey(20, 10, vec3(0.25f)), white(20, 10, vec3(1.0f));
  section.pictures = {{.id = "view",
                       .title = "A view",
                       .caption = "",
                       .reference = shownPicture("path-traced", grey),
                       .pictures = {judgedPicture("tiles", white, grey)}}};
  return report;
}

TEST(BenchSamples, TellMedianAndQuartiles) {
  const Samples samples = samplesOf({40, 9, 11, 10, 10});
  EXPECT_EQ(samples.median(), 10);
  EXPECT_EQ(samples.low(), 10);
  EXPECT_EQ(samples.high(), 11);
  EXPECT_EQ(samplesOf({1, 2}).median(), 1.5);
  EXPECT_TRUE(std::isnan(Samples().median()));
}

TEST(BenchCells, ShowAsManyDigitsAsSaySomething) {
  EXPECT_EQ(shownCell(Cell(84.0)), "84");
  EXPECT_EQ(shownCell(Cell(0.01234)), "0.012");
  EXPECT_EQ(shownCell(Cell(12.345)), "12.3");
  EXPECT_EQ(shownCell(Cell(123.6)), "124");
  EXPECT_EQ(shownCell(Cell(1234567.0)), "1,234,567");
  EXPECT_EQ(shownCell(Cell(0.00001)), "1.0e-05");
  EXPECT_EQ(shownCell(Cell()), "");
  EXPECT_EQ(shownCell(Cell(samplesOf({9, 10, 10, 11, 40}))), "10.0 ± 5 %");
}

TEST(BenchWriters, TellWhichColumnsAreThePapers) {
  EXPECT_EQ(columnName({"frame", Source::kPaper}), "frame, paper");
  EXPECT_EQ(columnName({"the paper's frame", Source::kPaper}), "the paper's frame");
  EXPECT_EQ(columnName({"frame", Source::kHere}), "frame");
}

TEST(BenchWriters, AlignTheTerminalTable) {
  const std::string text = terminalTable(frames());
  EXPECT_THAT(text, HasSubstr("scene        frame, paper        here\n"
                              "                     [ms]        [ms]\n"));
  EXPECT_THAT(text, HasSubstr("ring | room            84  10.0 ± 5 %\n"
                              "Šibenik                        13,688\n"));
}

TEST(BenchWriters, GiveScriptsTheWholeNumbers) {
  const nlohmann::json json = nlohmann::json::parse(reportJson(report()));
  const nlohmann::json& rows = json["tables"][0]["rows"];
  EXPECT_EQ(rows[0][1], 84.0);
  EXPECT_EQ(rows[0][2], nlohmann::json({{"median", 10.0}, {"low", 10.0}, {"high", 11.0}, {"repeats", 5}}));
  EXPECT_TRUE(rows[1][1].is_null());
  EXPECT_TRUE(json["plots"][0]["series"][1]["points"][1][1].is_null());
  EXPECT_LT(json["pictures"][0]["pictures"][0]["psnr"], 20);
}

TEST(BenchWriters, KeepMarkdownTablesWhole) {
  const std::string text = reportMarkdown(report());
  EXPECT_THAT(text, HasSubstr("| ring \\| room | 84 | 10.0 ± 5 % |\n| Šibenik | | 13,688 |\n"));
  EXPECT_THAT(text, HasSubstr("| scene | frame, paper [ms] | here [ms] |\n"));
  EXPECT_THAT(text, HasSubstr("| 1000 | 2.50 | 5 |\n"));
}

TEST(BenchWriters, WriteSvgThatIsWellFormed) {
  for (const bool logarithmic : {false, true}) {
    const std::string svg = plotSvg(curves(logarithmic));
    EXPECT_EQ(xmlProblem(svg), "");
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, HasSubstr("Time &lt; area"));
  }
  Plot bars = curves(false);
  bars.categories = {"Sponza", "ring"};
  bars.stacked = true;
  for (Series& series : bars.series) series.points = {{0, 3}, {1, 4}};
  const std::string svg = plotSvg(bars);
  EXPECT_EQ(xmlProblem(svg), "");
  EXPECT_THAT(svg, HasSubstr("<rect"));
  Plot empty = curves(true);
  empty.series.clear();
  EXPECT_EQ(xmlProblem(plotSvg(empty)), "");
}

TEST(BenchWriters, PutThePageIntoOneFile) {
  const std::string html = reportHtml(report());
  EXPECT_THAT(html, HasSubstr("On a &lt;GPU&gt; &amp; eight cores."));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
  // Nothing is fetched: the only addresses are those of the page itself and the namespace of SVG.
  for (std::size_t at = html.find("http"); at != std::string::npos; at = html.find("http", at + 1))
    EXPECT_EQ(html.substr(at, 26), "http://www.w3.org/2000/svg");
}

TEST(BenchScale, HasRoundTicksThatCoverTheValues) {
  const std::vector<double> values{0.07, 0.93};
  const Scale scale(values, false, false);
  const std::vector<Tick> ticks = scale.ticks();
  EXPECT_EQ(ticks.front().label, "0");
  EXPECT_EQ(ticks[1].label, "0.2");
  EXPECT_EQ(ticks.back().label, "1");
  EXPECT_EQ(scale.place(scale.high()), 1.0);
  const std::vector<double> wide{10, 1e6};
  std::vector<std::string> labels;
  for (const Tick& tick : Scale(wide, true, false).ticks()) labels.push_back(tick.label);
  EXPECT_THAT(labels, testing::ElementsAre("10", "100", "1000", "10k", "100k", "1M"));
}

TEST(BenchSuites, TakeAMinuteTogetherWhereTimeIsShort) {
  double seconds = 0;
  for (const Suite* suite : suites()) {
    EXPECT_GT(suite->quickSeconds, 0) << suite->name;
    EXPECT_EQ(findSuite(suite->name), suite);
    seconds += suite->quickSeconds;
  }
  EXPECT_LE(seconds, 60);
  EXPECT_EQ(findSuite("all"), nullptr);
}

TEST(BenchContext, ScalesKeepsTimeAndTellsEachNoteOnce) {
  Options options{.quick = true, .scale = 0.25, .repeats = 3, .budgetSeconds = 1e-9};
  Section section;
  Context context(options, 10, {}, section);
  FrameSettings frame;
  context.setSize(frame, 1920, 1080);
  EXPECT_EQ(frame.width, 960u);
  EXPECT_EQ(frame.height, 540u);
  EXPECT_EQ(context.photons(100'000), 25'000u);
  EXPECT_TRUE(context.hasTimeFor("the first"));
  EXPECT_FALSE(context.hasTimeFor("the second"));
  int rounds = 0;
  Samples samples;
  context.repeat({&samples}, [&] { samples.add(++rounds); });
  EXPECT_EQ(rounds, 3);  // One to warm up, and two at least.
  EXPECT_EQ(samples.median(), 2.5);
  EXPECT_TRUE(context.scene(PublicScene::kSibenik).standsIn);
  context.scene(PublicScene::kSibenik);
  EXPECT_EQ(section.notes.size(), 2u);
  EXPECT_THAT(section.notes.back(), HasSubstr("atrium, for Sibenik"));
}

}  // namespace
}  // namespace isophote::bench

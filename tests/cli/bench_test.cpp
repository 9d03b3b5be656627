// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
// `isophote bench` as a person or a script meets it.
#include "base/files.h"
#include "support/browser.h"
#include "support/program.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

namespace isophote {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class Bench : public testing::Test {
 protected:
  TestFolder folder_;
  ProgramRun run(const std::string& arguments) {
    return runIsophote(folder_.path(), "bench quality --width 32 --height 32 --spp 64 " + arguments);
  }
  nlohmann::json json(const std::string& file) const {
    return nlohmann::json::parse(readFile(folder_.path() / file));
  }
};

TEST_F(Bench, QualityTellsHowPicturesConverge) {
  const ProgramRun result = run("--scene cornell-box --scene colour-bleed --time 0.2 --json b.json");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("cornell-box, 32 x 32 pixels, beside 64 paths a pixel"));
  const nlohmann::json bench = json("b.json");
  EXPECT_EQ(bench["suite"], "quality");
  ASSERT_EQ(bench["scenes"].size(), 2u);
  for (const nlohmann::json& scene : bench["scenes"]) {
    EXPECT_GE(scene["ways"].size(), 4u);
    for (const nlohmann::json& way : scene["ways"]) {
      EXPECT_THAT(result.output, HasSubstr(way["name"].get<std::string>()));
      const nlohmann::json& passes = way["passes"];
      EXPECT_GT(passes.front()["psnr"], 15.0) << way["name"];
      EXPECT_GE(passes.back()["seconds"], 0.2) << way["name"];
      for (std::size_t i = 0; i < passes.size(); ++i) EXPECT_EQ(passes[i]["passes"], i + 1);
    }
  }
}

TEST_F(Bench, QualityTakesSettingsAndKeepsReferences) {
  const std::string command =
      "--scene cornell-box --time 0.01 --references . --set photon_trace.photons=1000 --json b.json";
  ASSERT_EQ(run(command).code, 0);
  const std::filesystem::path kept = folder_.path() / "cornell-box-32x32-3bounces-64spp.exr";
  const std::string reference = readFile(kept);
  const nlohmann::json first = json("b.json")["scenes"][0]["ways"];
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0]["settings"], nlohmann::json({"photon_trace.photons=1000"}));
  ASSERT_EQ(run(command).code, 0);
  EXPECT_EQ(readFile(kept), reference);
  EXPECT_EQ(json("b.json")["scenes"][0]["ways"][0]["passes"][0]["psnr"], first[0]["passes"][0]["psnr"]);
  writeFileAtomically(kept, std::string_view("no picture"));
  const ProgramRun damaged = run(command);
  EXPECT_EQ(damaged.code, 1);
  EXPECT_THAT(damaged.errors, HasSubstr(kept.filename().string()));
}

/// What every suite says of its tables.
void expectSoundTables(const nlohmann::json& suite, const std::string& markdown) {
  SCOPED_TRACE(suite["suite"]);
  ASSERT_FALSE(suite["tables"].empty());
  for (const nlohmann::json& table : suite["tables"]) {
    SCOPED_TRACE(table["title"]);
    EXPECT_THAT(markdown, HasSubstr(table["title"].get<std::string>()));
    EXPECT_FALSE(table["rows"].empty());
    for (const nlohmann::json& row : table["rows"]) {
      ASSERT_EQ(row.size(), table["columns"].size());
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (!row[i].is_object()) continue;
        EXPECT_GE(row[i]["median"], 0.0) << table["columns"][i];
      }
    }
  }
}

bool hasYardstick(const nlohmann::json& suite) {
  const auto judges = [](const nlohmann::json& column) { return column["source"] == "yardstick"; };
  return std::ranges::any_of(suite["tables"], [&](const nlohmann::json& table) {
    return std::ranges::any_of(table["columns"], judges);
  });
}

/// Every plot of a page, as far as it is text.
void expectSoundPlots(const std::string& html, std::size_t count) {
  std::size_t found = 0;
  for (std::size_t at = html.find("<svg"); at != std::string::npos; at = html.find("<svg", at + 1)) {
    ++found;
    EXPECT_EQ(xmlProblem(html.substr(at, html.find("</svg>", at) + 6 - at)), "");
  }
  EXPECT_EQ(found, count);
}

TEST_F(Bench, AllSuitesRunWithoutPublicScenesAndSaySo) {
  const ProgramRun result = runIsophote(
      folder_.path(),
      "bench all --quick --scale 0.0002 --repeats 1 --budget 30 --width 24 --height 24 --spp 4 --time 0.01 "
      "--json all.json --markdown all.md --html all.html",
      "env -u ISOPHOTE_ASSETS");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("A public scene is not at hand"));
  const nlohmann::json all = json("all.json");
  const std::string markdown = readFile(folder_.path() / "all.md");
  EXPECT_THAT(markdown, HasSubstr("atrium, for Sponza (Dabrovic's)"));
  std::vector<std::string> names;
  std::size_t plots = 0;
  for (const nlohmann::json& suite : all["suites"]) {
    names.push_back(suite["suite"]);
    expectSoundTables(suite, markdown);
    EXPECT_TRUE(names.back() == "quality" || hasYardstick(suite)) << names.back();
    for (const nlohmann::json& plot : suite["plots"]) EXPECT_FALSE(plot["series"].empty()) << plot["title"];
    plots += suite["plots"].size();
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"ispm", "igpm", "vsch", "sspm", "estimators", "quality"}));
  expectSoundPlots(readFile(folder_.path() / "all.html"), plots);
  if (!hasBrowser()) GTEST_SKIP() << kNoBrowser;
  const std::string dom =
      runBrowser(folder_.path(), fmt::format("--dump-dom 'file://{}/all.html'", folder_.path().string()));
  const std::size_t at = dom.find("data-pictures=\"");
  ASSERT_NE(at, std::string::npos) << dom.substr(0, 1000);
  int shown = 0, pictures = 0;
  ASSERT_EQ(std::sscanf(dom.c_str() + at, "data-pictures=\"%d of %d", &shown, &pictures), 2);
  EXPECT_EQ(shown, pictures);
  EXPECT_GT(pictures, 50);
}

TEST_F(Bench, SspmHasTheRowsOfTheThesis) {
  const ProgramRun result = runIsophote(folder_.path(), "bench sspm --scale 0.0005 --repeats 1 --json s.json",
                                        "env -u ISOPHOTE_ASSETS");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("a built-in scene is measured: glass-sphere, for Glass bunny"));
  const nlohmann::json suite = json("s.json");
  ASSERT_EQ(suite["tables"].size(), 3u);
  EXPECT_EQ(suite["plots"].size(), 1u);
  const auto table = [&](const char* id) {
    return *std::ranges::find_if(suite["tables"], [&](const nlohmann::json& t) { return t["id"] == id; });
  };
  const auto scenes = [&](const char* id) {
    std::vector<std::string> names;
    const nlohmann::json rows = table(id)["rows"];
    for (const nlohmann::json& row : rows) names.push_back(row[0]);
    return names;
  };
  EXPECT_THAT(scenes("shadows"), testing::ElementsAre("gathered", "pcss", "hard"));
  EXPECT_THAT(scenes("table1"),
              testing::ElementsAre("Cornell box", "Cornell box", "Happy buddha", "Chinese dragon",
                                   "Glass sphere", "Glass bunny", "Sibenik", "Sponza Atrium"));
  EXPECT_THAT(scenes("table2"),
              testing::ElementsAre("Cornell box", "Cornell box", "Happy buddha", "Chinese dragon",
                                   "Glass bunny", "Sibenik", "Sponza Atrium"));
}

TEST_F(Bench, VschHasEveryTableAndFigureAndSaysWhatIsLeftOut) {
  const ProgramRun result =
      runIsophote(folder_.path(), "bench vsch --quick --scale 0.0002 --repeats 1 --budget 60 --json v.json",
                  "env -u ISOPHOTE_ASSETS");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("San Miguel"));
  const nlohmann::json suite = json("v.json");
  std::vector<std::string> tables;
  for (const nlohmann::json& table : suite["tables"]) tables.push_back(table["id"]);
  EXPECT_THAT(tables, testing::UnorderedElementsAre("table1", "figure7", "figure6", "figure8", "figure9",
                                                    "octants", "table2", "figure12"));
  // Of figure 7, by rows: tiles read the most, and cones and trivial accept spare the more.
  for (const nlohmann::json& table : suite["tables"]) {
    if (table["id"] != "figure7") continue;
    const auto read = [&](int row) { return table["rows"][std::size_t(row)][1].get<double>(); };
    EXPECT_GE(read(0), read(1));
    EXPECT_GE(read(1), read(2));
    EXPECT_GT(read(2), read(3));
  }
}

/// A table of a suite, read by names.
struct NamedTable {
  nlohmann::json table;

  NamedTable(const nlohmann::json& suite, const std::string& id) {
    for (const nlohmann::json& candidate : suite["tables"])
      if (candidate["id"] == id) table = candidate;
    if (table.is_null()) ADD_FAILURE() << "no table " << id;
  }
  std::vector<std::string> firstCells() const {
    std::vector<std::string> names;
    for (const nlohmann::json& row : table["rows"]) names.push_back(row[0]);
    return names;
  }
  /// NaN where there is no such column, or no number.
  std::vector<double> column(const std::string& name) const {
    std::vector<double> values(table["rows"].size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < table["columns"].size(); ++i)
      for (std::size_t row = 0; table["columns"][i]["name"] == name && row < values.size(); ++row) {
        const nlohmann::json& cell = table["rows"][row][i];
        if (cell.is_number()) values[row] = cell;
        if (cell.is_object()) values[row] = cell["median"];
      }
    return values;
  }
};

TEST_F(Bench, EstimatorsAreJudgedBesideThePathTracer) {
  using testing::AllOf, testing::Each, testing::Ge, testing::Gt, testing::Lt;
  const ProgramRun result = runIsophote(
      folder_.path(), "bench estimators --quick --scale 0.02 --repeats 1 --budget 600 --json e.json",
      "env -u ISOPHOTE_ASSETS");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("public scenes that are not at hand are left out"));
  EXPECT_THAT(result.output, HasSubstr("The quality final is left out"));
  const nlohmann::json suite = json("e.json");
  ASSERT_EQ(suite["tables"].size(), 4u);

  const NamedTable beside(suite, "path-tracer");
  const std::vector<std::string> estimators = beside.firstCells();
  EXPECT_THAT(estimators,
              testing::ElementsAre("volumes", "kdtree", "tiles", "clusters", "bvh", "quads", "directional"));
  for (const std::string scene : {"cornell-box", "atrium"}) {
    EXPECT_THAT(beside.column(scene + ", mean"), Each(AllOf(Gt(0.7), Lt(1.3)))) << scene;
    EXPECT_THAT(beside.column(scene + ", PSNR"), Each(AllOf(Gt(18.0), Lt(50.0)))) << scene;
    EXPECT_THAT(beside.column(scene + ", radius"), Each(Gt(0.05))) << scene;
  }
  const std::string memory = beside.table["columns"].back()["name"];
  EXPECT_THAT(memory, testing::StartsWith("memory"));
  EXPECT_THAT(beside.column(memory), Each(Gt(0.0)));
  EXPECT_THAT(result.output, testing::Not(HasSubstr("Dabrovic")));

  const NamedTable radii(suite, "automatic-radius");
  EXPECT_THAT(radii.firstCells(),
              testing::ElementsAre("cornell-box", "cornell-objects", "colour-bleed", "atrium"));
  // The same picture as that of volumes beside the path tracer.
  EXPECT_EQ(radii.column("x 1")[0], beside.column("cornell-box, PSNR")[0]);
  EXPECT_EQ(radii.column("mean")[3], beside.column("atrium, mean")[0]);
  EXPECT_THAT(radii.column("x 0.5"), Each(Gt(15.0)));
  EXPECT_THAT(radii.column("best over x 1"), Each(Ge(0.0)));

  EXPECT_THAT(NamedTable(suite, "qualities").firstCells(),
              testing::ElementsAre("draft", "draft", "preview", "preview"));
  EXPECT_THAT(NamedTable(suite, "qualities").column("processor"), Each(Gt(0.0)));
  const NamedTable cost(suite, "cost");
  EXPECT_EQ(cost.firstCells(), estimators);
  for (const nlohmann::json& row : cost.table["rows"])
    for (std::size_t i = 1; i < row.size(); ++i) EXPECT_GT(row[i], 0.0) << row[0] << i;
}

/// Else nobody could put new figures where the old ones stand.
TEST_F(Bench, DocumentsHoldTheTablesOfTheSuiteEstimators) {
  const ProgramRun result = runIsophote(
      folder_.path(), "bench estimators --quick --scale 0.0002 --repeats 1 --budget 600 --json e.json",
      "env -u ISOPHOTE_ASSETS");
  ASSERT_EQ(result.code, 0) << result.errors;
  const std::filesystem::path docs = std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "docs";
  const std::string estimators = readFile(docs / "estimators.md"), all = readFile(docs / "measurements.md");
  const nlohmann::json suite = json("e.json");
  for (const nlohmann::json& table : suite["tables"])
    EXPECT_THAT(table["id"] == "automatic-radius" ? all : estimators,
                HasSubstr(fmt::format("*{}.*", table["title"].get<std::string>())));
  for (const nlohmann::json& plot : suite["plots"])
    EXPECT_THAT(estimators, HasSubstr(fmt::format("estimators-{}.svg", plot["id"].get<std::string>())));
}

TEST_F(Bench, ShellsCompleteItsSuites) {
  EXPECT_THAT(runIsophote(folder_.path(), "info --completion bash").output, HasSubstr("igpm"));
  EXPECT_THAT(runIsophote(folder_.path(), "info --completion zsh").output, HasSubstr("'1:suite:(ispm igpm "));
}

TEST_F(Bench, RefusesWhatCannotBeMeasuredBeforeTheWork) {
  const ProgramRun suite = runIsophote(folder_.path(), "bench qualty");
  EXPECT_EQ(suite.code, 2);
  EXPECT_THAT(suite.errors, HasSubstr("did you mean \"quality\"?"));
  const ProgramRun setting = run("--set photon_trace.photns=3");
  EXPECT_EQ(setting.code, 2);
  EXPECT_THAT(setting.errors, HasSubstr("did you mean \"photon_trace.photons\"?"));
  const ProgramRun foreign = runIsophote(folder_.path(), "bench ispm --spp 3");
  EXPECT_EQ(foreign.code, 2);
  EXPECT_THAT(foreign.errors, HasSubstr("--spp: is for the suite quality"));
  const ProgramRun page = run("--html nowhere/page.html");
  EXPECT_EQ(page.code, 1);
  EXPECT_THAT(page.errors, HasSubstr("nowhere"));
  const ProgramRun references = run("--references nowhere");
  EXPECT_EQ(references.code, 1);
  EXPECT_THAT(references.errors, HasSubstr("nowhere"));
  EXPECT_EQ(run("--scene nowhere.glb").code, 1);
  EXPECT_THAT(setting.output + references.output, IsEmpty());
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace isophote

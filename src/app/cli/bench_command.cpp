// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/suite.h"
#include "app/bench/writers.h"
#include "app/cli/command.h"
#include "app/cli/picture.h"
#include "app/cli/setting_options.h"
#include "base/error.h"
#include "base/files.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/apply.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>
#include <tbb/task_arena.h>

#include <cstdio>
#include <memory>

namespace isophote::cli {
namespace {

struct BenchOptions {
  std::string suite;
  bool quick = false;
  std::vector<std::string> scenes;
  std::vector<std::filesystem::path> assets;
  std::filesystem::path references;
  std::vector<std::string> assignments;
  std::vector<GivenSetting> given;
  std::filesystem::path json, markdown, html, plots;  ///< Empty: none.
};

/// Numbers that options take, where 0 means that none was given.
struct BenchSettings {
  float scale = 1;
  std::uint32_t repeats = 7;
  float budget = 0;
  std::uint32_t width = 512;
  std::uint32_t height = 512;
  std::uint32_t spp = 1024;
  float seconds = 5;

  void visit(auto&& v) {
    v("scale", scale,
      {.help = "Measure with this part of a paper's pixels and photons [with --quick 0.25].",
       .min = 0.0001,
       .max = 1});
    v("repeats", repeats,
      {.help = "Measurements of which the median is told, after one to warm up [with --quick 3].",
       .min = 1,
       .max = 1000});
    v("budget", budget,
      {.help = "Begin no measurement of a suite after so long; 0: measure all [with --quick its share of a "
               "minute].",
       .unit = "s",
       .min = 0,
       .max = 1e6});
    v("width", width,
      {.help = "quality: width of the pictures [with --quick 128].", .unit = "px", .min = 1, .max = 16384});
    v("height", height,
      {.help = "quality: height of the pictures [with --quick 128].", .unit = "px", .min = 1, .max = 16384});
    v("spp", spp,
      {.help = "quality: paths a pixel of the picture that is compared with [with --quick 128].",
       .min = 1,
       .max = 16777216});
    v("seconds", seconds,
      {.help = "quality: rendering of each way [with --quick 0.4].", .unit = "s", .min = 0.01, .max = 1e6});
  }
};

const std::vector<SettingOption>& settingOptions() {
  static const std::vector<SettingOption> options{
      {"--scale", "PART", {"scale"}},      {"--repeats", "N", {"repeats"}},
      {"--budget", "SECONDS", {"budget"}}, {"--width", "N", {"width"}},
      {"--height", "N", {"height"}},       {"--spp", "N", {"spp"}},
      {"--time", "SECONDS", {"seconds"}},
  };
  return options;
}

constexpr std::string_view kAll = "all";

std::vector<const bench::Suite*> chosenSuites(const std::string& name) {
  const auto all = bench::suites();
  if (name == kAll) return {all.begin(), all.end()};
  if (const bench::Suite* suite = bench::findSuite(name)) return {suite};
  const std::vector<std::string> names = suiteNames();
  failUsage("SUITE", "there is no suite \"{}\"{}; there is {}", name, suggestion(name, names),
            fmt::join(names, ", "));
}

/// Whether a number was given; those that were not are left to the suite.
bool given(const BenchOptions& options, std::string_view option) {
  return std::ranges::find(options.given, option, &GivenSetting::option) != options.given.end();
}

bench::Options suiteOptions(const BenchOptions& options) {
  BenchSettings settings;
  applyGiven(fieldsOf(settings), options.given);
  const auto number = [&](const char* option, auto value) {
    return given(options, option) ? value : decltype(value)(0);
  };
  PictureOptions picture;
  picture.assets = options.assets;
  return {.quick = options.quick,
          .scale = double(number("--scale", settings.scale)),
          .repeats = number("--repeats", settings.repeats),
          .budgetSeconds = double(number("--budget", settings.budget)),
          .assetFolders = picture.sceneOptions().assetFolders,
          .quality = {.scenes = options.scenes,
                      .width = number("--width", settings.width),
                      .height = number("--height", settings.height),
                      .spp = number("--spp", settings.spp),
                      .seconds = double(number("--time", settings.seconds)),
                      .references = options.references,
                      .assignments = options.assignments}};
}

/// Options of the suite `quality` would have no effect on another.
void refuseForeignOptions(const BenchOptions& options) {
  if (options.suite == "quality" || options.suite == kAll) return;
  std::vector<std::string> foreign;
  for (const char* const option : {"--width", "--height", "--spp", "--time"})
    if (given(options, option)) foreign.emplace_back(option);
  if (!options.scenes.empty()) foreign.emplace_back("--scene");
  if (!options.references.empty()) foreign.emplace_back("--references");
  if (!options.assignments.empty()) foreign.emplace_back("--set");
  if (!foreign.empty())
    failUsage(foreign.front(),
              "is for the suite quality; {} measures as its paper did (--scale makes it smaller)",
              options.suite);
}

/// What a person would type to have the same again.
std::string commandOf(const BenchOptions& options) {
  std::string command = "isophote bench " + options.suite;
  if (options.quick) command += " --quick";
  for (const std::string& scene : options.scenes) command += " --scene " + scene;
  for (const GivenSetting& setting : options.given)
    command += fmt::format(" {} {}", setting.option, setting.value);
  for (const std::string& assignment : options.assignments) command += " --set " + assignment;
  return command;
}

/// Writes what there is so far; the page, which holds pictures, after each suite only.
void writeReport(const BenchOptions& options, const bench::Report& report, bool suiteDone) {
  if (!options.json.empty()) writeFileAtomically(options.json, bench::reportJson(report));
  if (!suiteDone) return;
  if (!options.markdown.empty()) writeFileAtomically(options.markdown, bench::reportMarkdown(report));
  if (!options.html.empty()) writeFileAtomically(options.html, bench::reportHtml(report));
  if (!options.plots.empty())
    for (const bench::Section& section : report.sections)
      for (const bench::Plot& plot : section.plots)
        writeFileAtomically(options.plots / fmt::format("{}-{}.svg", section.suite, plot.id),
                            bench::plotSvg(plot));
}

/// What a person at a terminal sees after a suite: its tables are printed already.
void printRest(const bench::Section& section) {
  for (const std::string& note : section.notes) fmt::print("Note: {}\n", note);
  if (!section.plots.empty() || !section.pictures.empty())
    fmt::print("Plots: {}, views with pictures: {}; the report shows them (--html).\n", section.plots.size(),
               section.pictures.size());
  fmt::print("\n");
}

void bench(const BenchOptions& options, Host& host) {
  const std::vector<const bench::Suite*> chosen = chosenSuites(options.suite);
  refuseForeignOptions(options);
  const bench::Options suiteOptionsGiven = suiteOptions(options);
  for (const auto* file : {&options.json, &options.markdown, &options.html})
    if (!file->empty()) requireWritable(*file);
  if (!options.plots.empty()) requireWritable(options.plots / "plot.svg");

  bench::Report report;
  report.suite = options.suite;
  report.machine = {.version = ISOPHOTE_VERSION,
                    .processor = processorName(),
                    .instructions = std::string(name(bestSimdLevel())),
                    .threads = tbb::this_task_arena::max_concurrency(),
                    .command = commandOf(options)};
  bench::runSuites(chosen, suiteOptionsGiven, report, host.job, [&](const bench::Table* table) {
    host.console.clear();
    if (table)
      fmt::print("{}\n", bench::terminalTable(*table));
    else
      printRest(report.sections.back());
    std::fflush(stdout);
    writeReport(options, report, !table);
  });
}

std::string suiteHelp() {
  std::string help;
  for (const bench::Suite* suite : bench::suites())
    help += fmt::format("{}: {}; ", suite->name, suite->description);
  return help + "all: one after the other";
}

}  // namespace

std::vector<std::string> suiteNames() {
  std::vector<std::string> names;
  for (const bench::Suite* suite : bench::suites()) names.emplace_back(suite->name);
  names.emplace_back(kAll);
  return names;
}

Command addBench(CLI::App& program, WorkOptions& work) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App& parser = *program.add_subcommand(
      "bench", "Measure what the papers measured, and how soon pictures are how good");
  parser.add_option("SUITE", options->suite, suiteHelp())->required();
  parser.add_flag("--quick", options->quick, "Smaller and fewer measurements: all suites in about a minute");
  parser
      .add_option("--assets", options->assets,
                  "Folder of public scenes, before those in ISOPHOTE_ASSETS; may be given several times. "
                  "Built-in scenes stand in for what is not there")
      ->type_name("FOLDER")
      ->allow_extra_args(false);
  BenchSettings defaults;
  addSettingOptions(parser, settingOptions(), fieldsOf(defaults), options->given);
  parser
      .add_option(
          "--scene", options->scenes,
          "quality: scene to measure with, as `render` takes it; may be given several times [cornell-box, "
          "glass-sphere, atrium; with --quick cornell-box]")
      ->type_name("SCENE")
      ->allow_extra_args(false);
  parser
      .add_option("--references", options->references,
                  "quality: folder that keeps the path-traced pictures, so that they are made once")
      ->type_name("FOLDER");
  parser
      .add_option("--set", options->assignments,
                  "quality: measure these settings instead of the usual ones; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  parser.add_option("--json", options->json, "Write what was measured as JSON too")->type_name("FILE");
  parser.add_option("--markdown", options->markdown, "Write the tables as Markdown too")->type_name("FILE");
  parser
      .add_option("--html", options->html,
                  "Write one page with the tables, plots, and pictures side by side under a slider")
      ->type_name("FILE");
  parser.add_option("--plots", options->plots, "Write each plot into this folder too, as SUITE-NAME.svg")
      ->type_name("FOLDER");
  addWorkOptions(parser, work);
  parser.footer(
      "\nA figure is the median of repeated measurements, with half the distance of the quartiles; the first "
      "measurement is\ndropped. A picture's time is that of rendering alone, photons included; loading and "
      "comparing do not count.\n"
      "\nExamples:\n"
      "  isophote bench all --quick --html report.html\n"
      "  isophote bench quality --scene cornell-box --references .\n"
      "  isophote bench quality --scene room.glb --set frame.aa=4 --set photon_trace.photons=50000 --time "
      "20");
  return {&parser, [options](Host& host) { bench(*options, host); }};
}

}  // namespace isophote::cli

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/bench_quality.h"
#include "app/cli/picture.h"
#include "app/cli/setting_options.h"
#include "base/error.h"
#include "base/files.h"
#include "base/stats.h"
#include "math/simd.h"
#include "render/cpu_frame.h"
#include "settings/apply.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>
#include <tbb/task_arena.h>
#include <nlohmann/json.hpp>

#include <array>
#include <memory>

namespace isophote::cli {
namespace {

constexpr std::array<double, 5> kSeconds{0.25, 0.5, 1.0, 1.5, 5.0};
constexpr std::array<double, 4> kPsnr{30, 34, 35, 40};

struct BenchOptions {
  std::string suite;
  std::vector<std::string> scenes;
  std::vector<std::filesystem::path> assets;
  std::filesystem::path json;  ///< Empty: none.
  std::filesystem::path references;
  std::vector<std::string> assignments;
  std::vector<GivenSetting> given;
};

struct BenchSettings {
  std::uint32_t width = 512;
  std::uint32_t height = 512;
  std::uint32_t spp = 1024;
  float seconds = 5;

  void visit(auto&& v) {
    v("width", width, {.help = "Width of the pictures.", .unit = "px", .min = 1, .max = 16384});
    v("height", height, {.help = "Height of the pictures.", .unit = "px", .min = 1, .max = 16384});
    v("spp", spp, {.help = "Paths a pixel of the picture that is compared with.", .min = 1, .max = 16777216});
    v("seconds", seconds, {.help = "Rendering of each way.", .unit = "s", .min = 0.01, .max = 1e6});
  }
};

const std::vector<SettingOption>& settingOptions() {
  static const std::vector<SettingOption> options{
      {"--width", "N", {"width"}},
      {"--height", "N", {"height"}},
      {"--spp", "N", {"spp"}},
      {"--time", "SECONDS", {"seconds"}},
  };
  return options;
}

/// A scene's own settings, then the way's.
RenderSettings settingsOf(const QualityWay& way, const Scene* scene, const QualityBench& bench) {
  RenderSettings settings;
  settings.frame.layers = false;
  const std::vector<Field> fields = fieldsOfGroups(settings);
  if (scene)
    for (const auto& [key, value] : scene->settings)
      setSetting(fields, key, value, {ErrorKind::kBadInput, "the scene's settings"});
  for (const std::string& assignment : way.assignments)
    setFromAssignment(fields, assignment, {ErrorKind::kBadUsage, "--set"});
  settings.frame.width = bench.width;
  settings.frame.height = bench.height;
  return settings;
}

std::string cell(const std::optional<double>& value, std::string_view unit) {
  return value ? fmt::format("{:.4g} {}", *value, unit) : "-";
}

void printHead(const std::string& scene, const QualityBench& bench) {
  fmt::print("{}, {} x {} pixels, beside {} paths a pixel\n{:<12}{:>16}", scene, bench.width, bench.height,
             bench.spp, "", "first picture");
  for (const double seconds : kSeconds) fmt::print("{:>10}", fmt::format("{} s", seconds));
  for (const double psnr : kPsnr) fmt::print("{:>10}", fmt::format("to {} dB", psnr));
  fmt::print("{:>8}\n", "passes");
}

void printRow(const QualityWay& way, const std::vector<QualityPoint>& points) {
  const QualityPoint& first = points.front();
  fmt::print("{:<12}{:>16}", way.name, fmt::format("{:.1f} dB {:.2f} s", first.psnr, first.seconds));
  for (const double seconds : kSeconds) fmt::print("{:>10}", cell(psnrAt(points, seconds), "dB"));
  for (const double psnr : kPsnr) fmt::print("{:>10}", cell(secondsTo(points, psnr), "s"));
  fmt::print("{:>8}\n", points.back().passes);
  std::fflush(stdout);
}

nlohmann::ordered_json toJson(const QualityWay& way, const std::vector<QualityPoint>& points) {
  nlohmann::ordered_json curve{{"name", way.name}, {"settings", way.assignments}};
  for (const QualityPoint& point : points)
    curve["passes"].push_back({{"passes", point.passes},
                               {"seconds", point.seconds},
                               {"processorSeconds", point.processorSeconds},
                               {"psnr", point.psnr}});
  return curve;
}

nlohmann::ordered_json benchScene(const std::string& name, const BenchOptions& options,
                                  const std::vector<QualityWay>& ways, const QualityBench& bench,
                                  Host& host) {
  PictureOptions picture;
  picture.assets = options.assets;
  const Scene scene = loadScene(name, picture.sceneOptions(), host.job);
  const Camera& camera = findCamera(scene, "");
  Stats stats;
  const std::unique_ptr<TraceScene> trace = buildTrace(scene, stats, host.job);
  nlohmann::ordered_json json{
      {"scene", name}, {"width", bench.width}, {"height", bench.height}, {"spp", bench.spp}};
  std::optional<Image> reference;
  std::uint32_t bounces = 0;
  for (const QualityWay& way : ways) {
    const RenderSettings settings = settingsOf(way, &scene, bench);
    if (!reference || settings.frame.bounces != bounces) {
      bounces = settings.frame.bounces;
      reference = convergedPicture(scene, name, camera, bench, bounces, host);
    }
    const std::vector<QualityPoint> points =
        convergence(*trace, camera, settings, bench.seconds, *reference, host.job);
    host.console.clear();
    if (&way == &ways.front()) printHead(name, bench);
    printRow(way, points);
    json["ways"].push_back(toJson(way, points));
  }
  fmt::print("\n");
  return json;
}

void bench(const BenchOptions& options, Host& host) {
  constexpr std::array<std::string_view, 1> kSuites{"quality"};
  if (options.suite != kSuites[0])
    failUsage("SUITE", "there is no suite \"{}\"{}; there is {}", options.suite,
              suggestion(options.suite, kSuites), fmt::join(kSuites, ", "));
  BenchSettings settings;
  applyGiven(fieldsOf(settings), options.given);
  const QualityBench bench{settings.width, settings.height, settings.spp, double(settings.seconds),
                           options.references};
  std::vector<QualityWay> ways = qualityWays();
  if (!options.assignments.empty()) ways = {{"as set", options.assignments}};
  for (const QualityWay& way : ways) settingsOf(way, nullptr, bench);  // Refuses what is mistyped.
  if (!options.json.empty()) requireWritable(options.json);
  if (!options.references.empty()) requireWritable(options.references / "reference.exr");

  nlohmann::ordered_json json{{"suite", options.suite},
                              {"processor", processorName()},
                              {"threads", tbb::this_task_arena::max_concurrency()},
                              {"instructions", name(bestSimdLevel())}};
  for (const std::string& scene : options.scenes) {
    json["scenes"].push_back(benchScene(scene, options, ways, bench, host));
    if (!options.json.empty()) writeFileAtomically(options.json, json.dump(2) + "\n");
  }
}

}  // namespace

Command addBench(CLI::App& program, WorkOptions& work) {
  auto options = std::make_shared<BenchOptions>();
  options->scenes = {"cornell-box", "glass-sphere", "atrium"};
  CLI::App& parser = *program.add_subcommand("bench", "Measure how soon pictures are how good");
  parser.add_option("SUITE", options->suite, "quality: PSNR over time, beside a path-traced picture")
      ->required();
  parser
      .add_option("--scene", options->scenes,
                  "Scene to measure with, as `render` takes it; may be given several times [cornell-box, "
                  "glass-sphere, atrium]")
      ->type_name("SCENE")
      ->allow_extra_args(false);
  parser
      .add_option("--assets", options->assets,
                  "Folder to search for models, before those in ISOPHOTE_ASSETS; may be given several times")
      ->type_name("FOLDER")
      ->allow_extra_args(false);
  BenchSettings defaults;
  addSettingOptions(parser, settingOptions(), fieldsOf(defaults), options->given);
  parser
      .add_option("--references", options->references,
                  "Folder that keeps the path-traced pictures, so that they are made once")
      ->type_name("FOLDER");
  parser
      .add_option("--set", options->assignments,
                  "Measure these settings instead of the usual ones; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  parser.add_option("--json", options->json, "Write what was measured as JSON too")->type_name("FILE");
  addWorkOptions(parser, work);
  parser.footer(
      "\nA picture's time is that of rendering alone, photons included; loading and comparing do not count.\n"
      "\nExamples:\n"
      "  isophote bench quality --scene cornell-box --references .\n"
      "  isophote bench quality --scene room.glb --set frame.aa=4 --set photon_trace.photons=50000 --time "
      "20");
  return {&parser, [options](Host& host) { bench(*options, host); }};
}

}  // namespace isophote::cli

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// How soon pictures are how good: PSNR and FLIP over time of every estimator, beside a path-traced picture.
#include "app/bench/quality.h"
#include "app/bench/suite.h"
#include "base/files.h"
#include "render/cpu_frame.h"
#include "settings/apply.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace isophote::bench {
namespace {

constexpr std::array<double, 5> kSeconds{0.25, 0.5, 1.0, 1.5, 5.0};
constexpr std::array<double, 4> kPsnr{30, 34, 35, 40};
constexpr std::array<double, 2> kFlip{0.1, 0.05};

QualityBench benchOf(const Options& options) {
  const QualityOptions& given = options.quality;
  QualityBench bench;
  const std::uint32_t side = options.quick ? 128 : 512;
  bench.width = given.width ? given.width : side;
  bench.height = given.height ? given.height : side;
  bench.spp = given.spp ? given.spp : options.quick ? 128 : 1024;
  bench.seconds = given.seconds > 0 ? given.seconds : options.quick ? 0.4 : 5.0;
  bench.references = given.references;
  return bench;
}

std::vector<std::string> scenesOf(const Options& options) {
  if (!options.quality.scenes.empty()) return options.quality.scenes;
  if (options.quick) return {"cornell-box"};
  return {"cornell-box", "glass-sphere", "atrium"};
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

Cell cell(const std::optional<double>& value) { return value ? Cell(*value) : Cell(); }

Table emptyTable(const std::string& scene, const QualityBench& bench) {
  Table table{
      .id = scene,
      .title = fmt::format("{}, {} x {} pixels, beside {} paths a pixel", scene, bench.width, bench.height,
                           bench.spp),
      .caption =
          "Seconds of rendering alone, photons included; each estimator at the better of 200 k "
          "and 50 k photons a pass. \"at\": PSNR of what was done by then; \"to\": when the "
          "picture first was so good; an empty cell was not reached.",
      .columns = {
          {"way"}, {"settings"}, {"first picture", Source::kHere, "s"}, {"its PSNR", Source::kHere, "dB"}}};
  for (const double seconds : kSeconds)
    if (seconds <= bench.seconds)
      table.columns.push_back({fmt::format("at {} s", seconds), Source::kHere, "dB"});
  for (const double psnr : kPsnr)
    table.columns.push_back({fmt::format("to {} dB", psnr), Source::kHere, "s"});
  for (const double flip : kFlip)
    table.columns.push_back({fmt::format("to FLIP {}", flip), Source::kHere, "s"});
  table.columns.push_back({"FLIP at the end", Source::kHere});
  table.columns.push_back({"passes", Source::kHere});
  return table;
}

std::vector<Cell> rowOf(const QualityWay& way, const std::vector<QualityPoint>& points, double lastSeconds) {
  const QualityPoint& first = points.front();
  std::vector<Cell> row{way.name, fmt::format("{}", fmt::join(way.assignments, " ")), first.seconds,
                        first.psnr};
  for (const double seconds : kSeconds)
    if (seconds <= lastSeconds) row.push_back(cell(psnrAt(points, seconds)));
  for (const double psnr : kPsnr) row.push_back(cell(secondsTo(points, psnr)));
  for (const double flip : kFlip) row.push_back(cell(secondsToFlip(points, flip)));
  row.push_back(cell(points.back().flip));
  row.emplace_back(double(points.back().passes));
  return row;
}

nlohmann::ordered_json toJson(const QualityWay& way, const std::vector<QualityPoint>& points) {
  nlohmann::ordered_json curve{{"name", way.name}, {"settings", way.assignments}};
  for (const QualityPoint& point : points) {
    nlohmann::ordered_json pass{{"passes", point.passes},
                                {"seconds", point.seconds},
                                {"processorSeconds", point.processorSeconds},
                                {"psnr", point.psnr}};
    if (point.flip) pass["flip"] = *point.flip;
    curve["passes"].push_back(std::move(pass));
  }
  return curve;
}

/// All that is said of one scene.
struct SceneResult {
  double seconds;  ///< Of rendering.
  Table table;
  Plot psnr, flip;
  PictureSet pictures;
  nlohmann::ordered_json json;

  SceneResult(const std::string& name, const QualityBench& bench)
      : seconds(bench.seconds),
        table(emptyTable(name, bench)),
        psnr{.id = name + "-psnr",
             .title = name + ": PSNR over time",
             .caption = "",
             .x = {"rendering [s]", true},
             .y = {"PSNR [dB]"}},
        flip{.id = name + "-flip",
             .title = name + ": FLIP over time",
             .caption = "",
             .x = {"rendering [s]", true},
             .y = {"FLIP", true}},
        pictures{.id = name,
                 .title = fmt::format("{} after {} s of rendering", name, bench.seconds),
                 .caption = "",
                 .reference = {}},
        json{{"scene", name}, {"width", bench.width}, {"height", bench.height}, {"spp", bench.spp}} {}

  void add(const QualityWay& way, const std::vector<QualityPoint>& points) {
    table.rows.push_back(rowOf(way, points, seconds));
    Series decibels{.name = way.name}, flips{.name = way.name};
    for (const QualityPoint& point : points) {
      if (!point.flip) continue;
      decibels.points.emplace_back(point.seconds, point.psnr);
      flips.points.emplace_back(point.seconds, *point.flip);
    }
    psnr.series.push_back(std::move(decibels));
    flip.series.push_back(std::move(flips));
    json["ways"].push_back(toJson(way, points));
  }
};

/// The variant of a way whose picture is best at the end.
struct BestOf {
  QualityWay way;
  std::vector<QualityPoint> points = {};
  Image last = {};

  explicit BestOf(const QualityWay& first) : way(first) {}

  void offer(const QualityWay& variant, const RenderSettings& settings, const TraceScene& trace,
             const Camera& camera, double seconds, const Image& reference, const Job& job) {
    Image picture;
    std::vector<QualityPoint> found = convergence(trace, camera, settings, seconds, reference, picture, job);
    if (!points.empty() && found.back().psnr <= points.back().psnr) return;
    way = variant;
    points = std::move(found);
    last = std::move(picture);
  }
};

void benchScene(Context& context, const std::string& name, const std::vector<QualityWay>& ways,
                const QualityBench& bench) {
  const Scene scene = context.scene(name).scene;
  const Camera& camera = findCamera(scene, "");
  Stats stats;
  const std::unique_ptr<TraceScene> trace = buildTrace(scene, stats, context.job());
  SceneResult result(name, bench);
  std::optional<Image> reference;
  std::uint32_t bounces = 0;
  for (const QualityWay& way : ways) {
    if (!context.hasTimeFor(fmt::format("{} of {}", way.name, name),
                            double(1 + way.variants.size()) * bench.seconds))
      continue;
    const RenderSettings settings = settingsOf(way, &scene, bench);
    if (!reference || settings.frame.bounces != bounces) {
      bounces = settings.frame.bounces;
      reference = convergedPicture(scene, name, camera, bench, bounces, context.job());
      result.pictures.reference = shownPicture("path-traced", *reference);
    }
    BestOf best(way);
    best.offer(way, settings, *trace, camera, bench.seconds, *reference, context.job());
    for (const std::string& variant : way.variants) {
      QualityWay varied = way;
      varied.assignments.push_back(variant);
      best.offer(varied, settingsOf(varied, &scene, bench), *trace, camera, bench.seconds, *reference,
                 context.job());
    }
    result.add(best.way, best.points);
    result.pictures.pictures.push_back(judgedPicture(way.name, best.last, *reference));
  }
  if (result.table.rows.empty()) return;
  context.data()["scenes"].push_back(result.json);
  context.add(std::move(result.table));
  context.add(std::move(result.psnr));
  context.add(std::move(result.flip));
  context.add(std::move(result.pictures));
}

std::vector<QualityWay> waysOf(const Options& options) {
  if (!options.quality.assignments.empty()) return {{"as set", options.quality.assignments}};
  return qualityWays();
}

void checkQuality(const Options& options) {
  const QualityBench bench = benchOf(options);
  for (const QualityWay& way : waysOf(options)) settingsOf(way, nullptr, bench);  // Refuses what is mistyped.
  if (!bench.references.empty()) requireWritable(bench.references / "reference.exr");
}

void runQuality(Context& context) {
  const Options& options = context.options();
  for (const std::string& scene : scenesOf(options))
    benchScene(context, scene, waysOf(options), benchOf(options));
}

}  // namespace

const Suite kQualitySuite{"quality", "How soon pictures are how good, beside a path-traced picture", 10,
                          runQuality, checkQuality};

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What every estimator costs as photons, their radius and the picture grow, one at a time.
#include "app/bench/frames.h"
#include "app/bench/suite.h"
#include "render/cpu_frame.h"
#include "settings/apply.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>

namespace isophote::bench {
namespace {

constexpr std::uint32_t kWidth = 640, kHeight = 360, kPhotons = 100'000;
constexpr double kRadius = 0.5;  ///< [m]

/// A frame that is measured: one of the three differs from the usual.
struct Case {
  double photons = kPhotons;
  double radius = kRadius;
  double scale = 1;  ///< Of both sides of the picture.
};

/// One of the curves' axes.
struct Sweep {
  const char* id;
  const char* what;
  Axis axis;
  std::array<double, 4> values;
  Case (*at)(double value);
};

const std::array<Sweep, 3>& sweeps() {
  static const std::array<Sweep, 3> all{{
      {"photons",
       "photons emitted",
       {"photons emitted", true},
       {25'000, 50'000, 100'000, 200'000},
       [](double value) { return Case{.photons = value}; }},
      {"radius",
       "radius",
       {"radius [m]", true},
       {0.125, 0.25, 0.5, 1.0},
       [](double value) { return Case{.radius = value}; }},
      {"pixels",
       "width",
       {"width of the picture [px], 16:9", true},
       {320, 640, 960, 1280},
       [](double value) { return Case{.scale = value / kWidth}; }},
  }};
  return all;
}

/// What the estimate of a frame takes and keeps.
struct Cost {
  double milliseconds = 0;  ///< Of processor time.
  double megabytes = 0;
  double primaryRaysMs = 0;
};

/// Stages and buffers of the estimate, and nothing else, begin so.
bool isOfEstimate(std::string_view name) {
  return (name.starts_with("photon_") && !name.starts_with("photon_trace")) || name == "irradiance_blur";
}

Cost costOf(Context& context, const TraceScene& trace, const Camera& camera, const std::string& estimator,
            const Case& c) {
  RenderSettings settings;
  const std::vector<Field> fields = fieldsOfGroups(settings);
  const SettingOrigin origin{ErrorKind::kBadUsage, "estimators"};
  setSetting(fields, "frame.estimator", estimator, origin);
  setSetting(fields, fmt::format("photon_{}.radius", estimator), fmt::format("{}", c.radius), origin);
  settings.direct.areaSamples = 1;
  settings.photonTrace.photons = context.photons(std::uint32_t(c.photons));
  context.setSize(settings.frame, std::uint32_t(kWidth * c.scale), std::uint32_t(kHeight * c.scale));
  const FrameTimes times = measureFrames(context, trace, camera, settings);
  Cost cost{.primaryRaysMs = times.primaryRaysMs.median()};
  double share = 0;
  for (const auto& [stage, samples] : times.stagesMs)
    if (isOfEstimate(stage)) share += samples.median() / times.clockMs.median();
  cost.milliseconds = times.processorMs.median() * share;
  const nlohmann::json stats = nlohmann::json::parse(times.last.toJson());
  for (const auto& [buffer, bytes] : stats["bytes"].items())
    if (isOfEstimate(buffer)) cost.megabytes += bytes.get<double>() / 1e6;
  return cost;
}

void runSweep(Context& context, const TraceScene& trace, const Camera& camera, const Sweep& sweep) {
  Table table{.id = sweep.id,
              .title = fmt::format("Estimates by {}, atrium", sweep.what),
              .caption = fmt::format(
                  "Processor time of the estimate alone, all threads together: that of the frame times the "
                  "part that the estimate's stages have of its time. {} x {} pixels, {} photons, radius "
                  "{} m, but for what varies.",
                  kWidth, kHeight, kPhotons, kRadius),
              .columns = {{"estimator"}}};
  Plot plot{.id = sweep.id,
            .title = fmt::format("Processor time of the estimate by {}", sweep.what),
            .caption = "",
            .x = sweep.axis,
            .y = {"processor time [ms]", true}};
  for (const double value : sweep.values)
    table.columns.push_back({fmt::format("{}", value), Source::kHere, "ms"});
  table.columns.push_back({"memory, last column", Source::kHere, "MB"});
  table.columns.push_back({"primary rays there", Source::kYardstick, "ms"});
  for (const std::string_view estimator : EnumNames<Estimator>::names) {
    if (!context.hasTimeFor(fmt::format("{} by {}", estimator, sweep.what))) continue;
    std::vector<Cell> row{std::string(estimator)};
    Series series{.name = std::string(estimator)};
    Cost cost;
    for (const double value : sweep.values) {
      cost = costOf(context, trace, camera, std::string(estimator), sweep.at(value));
      row.emplace_back(cost.milliseconds);
      series.points.emplace_back(value, cost.milliseconds);
    }
    row.emplace_back(cost.megabytes);
    row.emplace_back(cost.primaryRaysMs);
    table.rows.push_back(std::move(row));
    plot.series.push_back(std::move(series));
  }
  if (table.rows.empty()) return;
  context.add(std::move(table));
  context.add(std::move(plot));
}

void runEstimators(Context& context) {
  const SceneChoice choice = context.scene("atrium");
  Stats stats;
  const std::unique_ptr<TraceScene> trace = buildTrace(choice.scene, stats, context.job());
  for (const Sweep& sweep : sweeps()) runSweep(context, *trace, choice.scene.cameras.front(), sweep);
}

}  // namespace

const Suite kEstimatorsSuite{"estimators", "What estimators cost as photons, radius and picture grow", 4,
                             runEstimators};

}  // namespace isophote::bench

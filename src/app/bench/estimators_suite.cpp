// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What every estimator costs as photons, their radius and the picture grow, one at a time, and what whole
// pictures of a quality do. How good they are: estimators_quality.cpp.
#include "app/bench/estimators_parts.h"
#include "app/bench/frames.h"
#include "render/cpu_frame.h"
#include "render/quality.h"
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
  /// What --quick and --scale leave of a value, and how a column is headed by it.
  double (*measured)(const Context& context, double value);
  std::string (*label)(double measured);
};

const std::array<Sweep, 3>& sweeps() {
  static const std::array<Sweep, 3> all{{
      {"photons",
       "photons emitted",
       {"photons emitted", true},
       {25'000, 50'000, 100'000, 200'000},
       [](double value) { return Case{.photons = value}; },
       [](const Context& context, double value) { return double(context.photons(std::uint32_t(value))); },
       [](double measured) { return fmt::format("{:.3g} k photons", measured / 1000); }},
      {"radius",
       "radius",
       {"radius [m]", true},
       {0.125, 0.25, 0.5, 1.0},
       [](double value) { return Case{.radius = value}; },
       [](const Context&, double value) { return value; },
       [](double measured) { return fmt::format("radius {} m", measured); }},
      {"pixels",
       "width",
       {"width of the picture [px], 16:9", true},
       {320, 640, 960, 1280},
       [](double value) { return Case{.scale = value / kWidth}; },
       [](const Context& context, double value) { return double(context.side(std::uint32_t(value))); },
       [](double measured) { return fmt::format("width {}", measured); }},
  }};
  return all;
}

/// What the estimate of a frame takes.
struct Cost {
  double milliseconds = 0;  ///< Of processor time.
  double primaryRaysMs = 0;
};

Cost costOf(Context& context, const EstimatorScene& scene, Estimator estimator, const Case& c) {
  RenderSettings settings;
  settings.frame.estimator = estimator;
  setRadius(settings, estimator, c.radius);
  settings.direct.areaSamples = 1;
  settings.photonTrace.photons = context.photons(std::uint32_t(c.photons));
  context.setSize(settings.frame, std::uint32_t(kWidth * c.scale), std::uint32_t(kHeight * c.scale));
  const FrameTimes times =
      measureFrames(context, scene.trace(), scene.camera(), settings, context.quick() ? 1 : 1000);
  Cost cost{.primaryRaysMs = times.primaryRaysMs.median()};
  double share = 0;
  for (const auto& [stage, samples] : times.stagesMs)
    if (isOfEstimate(stage)) share += samples.median() / times.clockMs.median();
  cost.milliseconds = times.processorMs.median() * share;
  return cost;
}

/// Both ends of every sweep, a row an estimator; the plots have what is between.
class CostTable {
 public:
  explicit CostTable(const Context& context)
      : table_{.id = "cost",
               .title = "Cost of an estimate, atrium",
               .caption = fmt::format(
                   "Processor time of the estimate alone, all threads together: that of the frame times the "
                   "part that the estimate's stages have of its time. Width {}, {:.3g} k photons, radius {} "
                   "m, but for what varies.",
                   context.side(kWidth), context.photons(kPhotons) / 1000.0, kRadius),
               .columns = {{"estimator"}}} {
    for (const Sweep& sweep : sweeps())
      for (const double end : {sweep.values.front(), sweep.values.back()})
        table_.columns.push_back({sweep.label(sweep.measured(context, end)), Source::kHere, "ms"});
    table_.columns.push_back(
        {fmt::format("primary rays, width {}", context.side(kWidth)), Source::kYardstick, "ms"});
    for (const std::string_view name : EnumNames<Estimator>::names) {
      table_.rows.push_back({std::string(name)});
      table_.rows.back().resize(table_.columns.size());
    }
  }

  void set(std::size_t estimator, std::size_t sweep, double first, double last) {
    std::vector<Cell>& row = table_.rows[estimator];
    row[1 + 2 * sweep] = first;
    row[2 + 2 * sweep] = last;
  }
  void setYardstick(std::size_t estimator, double milliseconds) {
    table_.rows[estimator].back() = milliseconds;
  }
  Table take() { return std::move(table_); }

 private:
  Table table_;
};

/// Returns the curves of all estimators that there was time for.
Plot runSweep(Context& context, const EstimatorScene& scene, std::size_t which, CostTable& table) {
  const Sweep& sweep = sweeps()[which];
  Plot plot{.id = sweep.id,
            .title = fmt::format("Processor time of the estimate by {}", sweep.what),
            .caption = "",
            .x = sweep.axis,
            .y = {"processor time [ms]", true}};
  for (std::size_t i = 0; i < EnumNames<Estimator>::names.size(); ++i) {
    Series series{.name = EnumNames<Estimator>::names[i]};
    if (!context.hasTimeFor(fmt::format("{} by {}", series.name, sweep.what))) continue;
    for (const double value : sweep.values) {
      const Case c = sweep.at(value);
      const Cost cost = costOf(context, scene, Estimator(i), c);
      series.points.emplace_back(sweep.measured(context, value), cost.milliseconds);
      if (c.scale == 1) table.setYardstick(i, cost.primaryRaysMs);
    }
    table.set(i, which, series.points.front().second, series.points.back().second);
    plot.series.push_back(std::move(series));
  }
  return plot;
}

void benchCost(Context& context, EstimatorScenes& scenes) {
  if (!context.hasTimeFor("cost of estimates", 0.5)) return;
  const EstimatorScene& atrium = *scenes.find({"atrium"});
  CostTable table(context);
  std::vector<Plot> plots;
  for (std::size_t which = 0; which < sweeps().size(); ++which)
    plots.push_back(runSweep(context, atrium, which, table));
  std::erase_if(plots, [](const Plot& plot) { return plot.series.empty(); });
  if (plots.empty()) return;
  context.add(table.take());
  for (Plot& plot : plots) context.add(std::move(plot));
}

/// A row of the qualities: whole pictures of all their passes.
std::vector<Cell> qualityRow(Context& context, const Quality& quality, const std::string& name,
                             const EstimatorScene& scene, const RenderSettings& settings) {
  const std::uint32_t most = context.quick() ? 1 : 5;
  Samples processor, clock, primaryRays;
  context.repeat(
      {&processor, &clock, &primaryRays},
      [&] {
        Stats stats;
        const double before = processorMilliseconds();
        clock.add(millisecondsOf(
                      [&] { renderCpu(scene.trace(), scene.camera(), settings, stats, context.job()); }) /
                  1000);
        processor.add((processorMilliseconds() - before) / 1000);
        primaryRays.add(
            primaryRaysMs(scene.trace(), scene.camera(), settings.frame.width, settings.frame.height));
      },
      most);
  return {std::string(quality.name),
          name,
          double(settings.photonTrace.photons),
          double(settings.frame.passes),
          processor,
          clock,
          primaryRays};
}

void runEstimators(Context& context) {
  EstimatorScenes scenes(context);
  benchBesidePathTracer(context, scenes);
  benchQualities(context, scenes);
  benchAutomaticRadius(context, scenes);
  benchCost(context, scenes);
}

}  // namespace

void setRadius(RenderSettings& settings, Estimator estimator, double metres) {
  setSetting(fieldsOfGroups(settings),
             fmt::format("photon_{}.radius", EnumNames<Estimator>::names[std::size_t(estimator)]),
             fmt::format("{}", metres), {ErrorKind::kBadUsage, "estimators"});
}

bool isOfEstimate(std::string_view name) {
  return (name.starts_with("photon_") && !name.starts_with("photon_trace")) ||
         name.starts_with("irradiance_blur");
}

double estimateMegabytes(const Stats& stats) {
  double bytes = 0;
  const nlohmann::json all = nlohmann::json::parse(stats.toJson())["bytes"];
  for (const auto& [buffer, count] : all.items())
    if (isOfEstimate(buffer)) bytes += count.get<double>();
  return bytes / 1e6;
}

void benchQualities(Context& context, EstimatorScenes& scenes) {
  constexpr std::uint32_t kMostPasses = 16;
  RenderSettings sized;
  context.setSize(sized.frame, 1280, 720);
  Table table{
      .id = "qualities",
      .title = "Qualities",
      .caption = fmt::format("Rendering a whole picture of {} x {} pixels, all passes, without loading "
                             "the scene and building its hierarchy. Processor: all threads together.",
                             sized.frame.width, sized.frame.height),
      .columns = {{"--quality"},
                  {"scene"},
                  {"photons a pass", Source::kHere},
                  {"passes", Source::kHere},
                  {"processor", Source::kHere, "s"},
                  {"clock", Source::kHere, "s"},
                  {"primary rays", Source::kYardstick, "ms"}}};
  for (const Quality& quality : qualities()) {
    RenderSettings settings = sized;
    for (const std::string_view assignment : quality.assignments)
      setFromAssignment(fieldsOfGroups(settings), assignment, {ErrorKind::kBadUsage, "--quality"});
    settings.photonTrace.photons = context.photons(settings.photonTrace.photons);
    if (settings.frame.passes > kMostPasses) {
      context.note(fmt::format("The quality {} is left out: its {} passes take minutes.", quality.name,
                               settings.frame.passes));
      continue;
    }
    for (const WantedScene& wanted : kEstimatorScenes) {
      if (!context.hasTimeFor(fmt::format("quality {}, {}", quality.name, wanted.name), 0.5)) continue;
      if (const EstimatorScene* const scene = scenes.find(wanted))
        table.rows.push_back(qualityRow(context, quality, wanted.name, *scene, settings));
    }
  }
  if (!table.rows.empty()) context.add(std::move(table));
}

const Suite kEstimatorsSuite{"estimators", "How good estimators are, and what they and qualities cost", 9,
                             runEstimators};

}  // namespace isophote::bench

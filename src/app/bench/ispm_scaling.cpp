// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// ISPM: the two proportions that the paper states: tracing is as much faster as there are threads, and the
// estimate takes time in proportion to the area that photons cover.
#include "app/bench/frames.h"
#include "app/bench/ispm_parts.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <array>

namespace isophote::bench {
namespace {

/// 1, 2, 4, ... and all.
std::vector<int> threadCounts() {
  const int most = tbb::this_task_arena::max_concurrency();
  std::vector<int> counts;
  for (int count = 1; count < most; count *= 2) counts.push_back(count);
  counts.push_back(most);
  return counts;
}

/// More photons than the paper has, so that tracing takes longer than waking a thread up.
RenderSettings threadSettings(const Context& context) {
  return ispmSettings(context, {1920, 1080, 100'000, 3, 4});
}

void benchThreads(Context& context, const SceneChoice& scene, const TraceScene& trace) {
  if (!context.hasTimeFor("scaling with threads", 1)) return;
  const RenderSettings settings = threadSettings(context);
  Table table{
      .id = "threads",
      .title = "Scaling with threads",
      .caption = fmt::format(
          "{}, {} x {}, {} photons, three bounces. Paper: a perfectly linear speedup of tracing in the "
          "number of cores. Embree alone on the primary rays says what this machine's threads give.",
          scene.name, settings.frame.width, settings.frame.height, settings.photonTrace.photons),
      .columns = {{"threads"},
                  {"photons", Source::kHere, "ms"},
                  {"frame", Source::kHere, "ms"},
                  {"primary rays", Source::kYardstick, "ms"},
                  {"photons, times faster", Source::kPaper},
                  {"photons, times faster", Source::kHere},
                  {"frame, times faster", Source::kHere},
                  {"primary rays, times faster", Source::kYardstick}}};
  Plot plot{
      .id = "threads",
      .title = table.title,
      .caption = "Times as fast as one thread.",
      .x = {"threads", true},
      .y = {"times faster", true},
      .series = {
          {"paper: linear", Source::kPaper}, {"photons"}, {"frame"}, {"primary rays", Source::kYardstick}}};
  double photonsOne = 0, frameOne = 0, raysOne = 0;
  for (const int threads : threadCounts()) {
    FrameTimes times;
    tbb::task_arena arena(threads);
    arena.execute([&] { times = measureFrames(context, trace, scene.scene.cameras.front(), settings); });
    const double photons = times.stagesMedian({"light_gbuffer", "bounce_map", "photon_trace"}),
                 frame = times.clockMs.median(), rays = times.primaryRaysMs.median();
    if (table.rows.empty()) {
      photonsOne = photons;
      frameOne = frame;
      raysOne = rays;
    }
    const std::array faster{double(threads), photonsOne / photons, frameOne / frame, raysOne / rays};
    table.rows.push_back({std::to_string(threads), photons, times.clockMs, times.primaryRaysMs, faster[0],
                          faster[1], faster[2], faster[3]});
    for (std::size_t i = 0; i < faster.size(); ++i) plot.series[i].points.emplace_back(threads, faster[i]);
  }
  context.add(std::move(table));
  context.add(std::move(plot));
}

void benchArea(Context& context, const SceneChoice& scene, const TraceScene& trace) {
  if (!context.hasTimeFor("scaling with the area of footprints", 1)) return;
  constexpr std::array kAreas{0.25, 0.5, 1.0, 2.0, 4.0};
  const Camera& camera = scene.scene.cameras.front();
  RenderSettings settings = ispmSettings(context, {1920, 1080, 25'000, 1, 4});
  const FrameTimes automatic = measureFrames(context, trace, camera, settings, 1);
  const double radius = automatic.last.counter("radiusMetres");
  Table table{
      .id = "area",
      .title = "Scaling with the area of footprints",
      .caption = fmt::format("{}, {} x {}, 4 x 4 cells; the area of the automatic radius, {:.2f} m, is 1. "
                             "Paper: linear in the area of the volumes on visible surfaces.",
                             scene.name, settings.frame.width, settings.frame.height, radius),
      .columns = {{"area"},
                  {"radius", Source::kHere, "m"},
                  {"photon_volumes", Source::kHere, "ms"},
                  {"pairs contributing", Source::kHere, "M"},
                  {"time for a pair", Source::kHere, "ns"},
                  {"primary rays", Source::kYardstick, "ms"}}};
  Plot plot{.id = "area",
            .title = table.title,
            .caption = "The paper's straight line goes through ours at the automatic radius.",
            .x = {"area of footprints", false},
            .y = {"photon_volumes [ms]", false},
            .series = {{"paper: linear", Source::kPaper}, {"photon_volumes"}}};
  for (const double area : kAreas) {
    settings.photonVolumes.radius = float(radius * std::sqrt(area));
    const FrameTimes times = measureFrames(context, trace, camera, settings);
    const Samples& estimate = times.stage("photon_volumes");
    const double pairs = times.last.counter("photon_volumes.pairsContributing");
    table.rows.push_back({fmt::format("{:g}", area), double(settings.photonVolumes.radius), estimate,
                          1e-6 * pairs, 1e6 * estimate.median() / std::max(pairs, 1.0), times.primaryRaysMs});
    plot.series[1].points.emplace_back(area, estimate.median());
  }
  const double one = plot.series[1].points[2].second;
  plot.series[0].points = {{kAreas.front(), one * kAreas.front()}, {kAreas.back(), one * kAreas.back()}};
  context.add(std::move(table));
  context.add(std::move(plot));
}

}  // namespace

void benchIspmScaling(Context& context) {
  const SceneChoice scene = context.scene(PublicScene::kSponzaDabrovic);
  const TraceScene trace(scene.scene);
  benchThreads(context, scene, trace);
  benchArea(context, scene, trace);
}

}  // namespace isophote::bench

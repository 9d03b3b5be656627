// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the paper on interactive global photon mapping measured (Fabianowski and Dingliana 2009): frames
// (table 2, figure 5). The rest is in igpm_tables.cpp. The smoothing of each scene is found first, such that
// as many photons count at a view sample as in the paper.
#include "app/bench/frames.h"
#include "app/bench/igpm_parts.h"
#include "render/cpu_renderer.h"
#include "scene/surface_area.h"
#include "stages/gbuffer/gbuffer.h"
#include "stages/photon_kdtree/photon_kdtree.h"
#include "stages/photon_trace/photon_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isophote::bench {
namespace {

/// Where the k nearest are looked for [m]: far enough that there are as many nearly everywhere.
constexpr float kNearestWithin = 2.0f;

RenderSettings settingsOf(const Context& context, const IgpmColumn& column) {
  RenderSettings settings = presetSettings("igpm");
  context.setSize(settings.frame, 512, 512);
  settings.frame.layers = false;
  settings.gbuffer.mirrorDepth = 1;
  settings.photonTrace.photons = context.photons(column.emitted);
  settings.photonBvh.smoothing = column.smoothing;
  return settings;
}

/// What part of the paper's photons is asked for.
double partOf(const Context& context, const IgpmColumn& column) {
  return double(context.photons(column.stored)) / double(column.stored);
}

double photonsAtSample(const Stats& stats) {
  return stats.counter("photon_bvh.pairsContributing") / std::max(stats.counter("gbuffer.viewSamples"), 1.0);
}

Stats statsOfFrame(Context& context, const IgpmScene& scene) {
  CpuRenderer renderer(*scene.trace, scene.settings);
  Film film;
  Stats stats;
  renderer.render(scene.camera(), film, stats, context.job());
  return stats;
}

/// Photons to emit, and the smoothing at which as many photons count at a view sample as in the paper: within
/// a hundredth, or near it where time is short. Of fewer photons, fewer count at a sample, so that footprints
/// stay as large.
void fit(Context& context, IgpmScene& scene) {
  const IgpmColumn& column = *scene.column;
  const double part = partOf(context, column);
  const double stored = std::max(statsOfFrame(context, scene).counter("photonsStored"), 1.0);
  const double emitted = double(scene.settings.photonTrace.photons) * part * column.stored / stored;
  scene.settings.photonTrace.photons = std::uint32_t(std::clamp(emitted, 10.0, 1e8));
  const int most = context.quick() ? 3 : 12;
  const double enough = context.quick() ? 0.05 : 0.01;
  for (int i = 0; i < most; ++i) {
    const double found = photonsAtSample(statsOfFrame(context, scene));
    const double ratio = part * double(column.photonsAtSample) / std::max(found, 0.1);
    if (std::abs(ratio - 1.0) < enough) break;
    scene.settings.photonBvh.smoothing *= float(std::clamp(std::sqrt(ratio), 0.25, 4.0));
  }
}

IgpmScene prepare(Context& context, const IgpmColumn& column) {
  IgpmScene scene{.column = &column,
                  .choice = std::make_unique<SceneChoice>(context.scene(column.scene)),
                  .trace = nullptr,
                  .settings = settingsOf(context, column)};
  scene.trace = std::make_unique<TraceScene>(scene.choice->scene);
  fit(context, scene);
  return scene;
}

Table framesTable() {
  return {.id = "table2",
          .title = "Table 2: frames of --preset igpm",
          .caption =
              "Two bounces, semi-axes up to 0.7 m, constant kernel, one level of mirrors; photons and "
              "smoothing are "
              "fitted so that as many are stored and count at a view sample as in the paper. Paper: "
              "Fabianowski and "
              "Dingliana 2009, GeForce GTX 280, means over animations; its scenes Scene 6 and Wall are not "
              "at hand, "
              "and its ring is another. \"nearest\" is the estimate by the k nearest in place of footprints, "
              "k being "
              "the photons at a sample.",
          .columns = {{"scene"},
                      {"size"},
                      {"stored", Source::kPaper},
                      {"stored", Source::kHere},
                      {"smoothing", Source::kPaper},
                      {"smoothing", Source::kHere},
                      {"at a sample", Source::kPaper},
                      {"at a sample", Source::kHere},
                      {"frame", Source::kPaper, "ms"},
                      {"frame", Source::kHere, "ms"},
                      {"processor", Source::kHere, "ms"},
                      {"primary rays", Source::kYardstick, "ms"},
                      {"frame over them", Source::kYardstick},
                      {"estimate", Source::kHere, "ms"},
                      {"nearest", Source::kYardstick, "ms"},
                      {"faster than nearest, frame", Source::kPaper},
                      {"faster than nearest, estimate", Source::kHere}}};
}

/// The estimate by the k nearest of the same photons, clock [ms].
Samples nearestMs(Context& context, const IgpmScene& scene) {
  const IgpmEstimate estimate = igpmEstimate(scene);
  const double part = partOf(context, *scene.column);
  const double k = std::max(part * double(scene.column->photonsAtSample), 4.0);
  PhotonKdtree kdtree({.nearest = std::uint32_t(k)});
  Samples samples;
  Radiance out;
  const auto round = [&] {
    Stats stats;
    samples.add(millisecondsOf([&] {
      kdtree.run(PhotonKdtree::In{estimate.view, estimate.map, kNearestWithin}, out, stats, context.job());
    }));
  };
  context.repeat({&samples}, round, 2);
  return samples;
}

void addPictures(Context& context, const IgpmScene& scene, const Image& picture) {
  const Image converged = convergedByPhotons(context, *scene.trace, scene.camera(), scene.settings,
                                             context.photons(400'000), context.quick() ? 2 : 16);
  context.add(PictureSet{.id = fmt::format("figure3-{}", scene.column->name),
                         .title = fmt::format("Figure 3: {}", scene.choice->name),
                         .caption = "A frame of table 2 beside many passes of photons.",
                         .reference = shownPicture("many passes", converged),
                         .pictures = {judgedPicture("IGPM", picture, converged)}});
}

void runIgpm(Context& context) {
  std::vector<IgpmScene> scenes;
  Table table = framesTable();
  Plot breakdown{
      .id = "figure5",
      .title = "Figure 5: where the time of a frame goes",
      .caption = "The paper shows bars without figures; in them, rendering clearly dominates.",
      .x = {""},
      .y = {"time [ms]"},
      .series = {{"photon tracing"}, {"hierarchy"}, {"first surfaces and direct light"}, {"estimate"}},
      .stacked = true};
  for (const IgpmColumn& column : igpmColumns()) {
    if (!context.hasTimeFor(fmt::format("table 2, {}", column.name), 1)) continue;
    scenes.push_back(prepare(context, column));
    benchIgpmFrames(context, scenes.back(), table, breakdown);
  }
  context.add(std::move(table));
  context.add(std::move(breakdown));
  benchIgpmRadii(context, scenes);
  for (const IgpmScene& scene : scenes)
    if (scene.column->scene == PublicScene::kRing) benchIgpmKernels(context, scene);
  benchIgpmLeaves(context, scenes);
}

}  // namespace

IgpmEstimate igpmEstimate(const IgpmScene& scene) {
  IgpmEstimate e;
  const RenderSettings& settings = scene.settings;
  const int width = int(settings.frame.width), height = int(settings.frame.height);
  Stats stats;
  Gbuffer(settings.gbuffer)
      .run({*scene.trace, cameraRays(scene.camera(), width, height), width, height}, e.view, stats);
  PhotonTrace(settings.photonTrace)
      .run({.trace = *scene.trace, .bounces = settings.frame.bounces, .footprints = true}, e.map, stats);
  e.radius = middleRadius(e.map, settings.photonBvh, settings.photonBvh.smoothing);
  e.surfaceArea = surfaceArea(scene.choice->scene);
  return e;
}

void benchIgpmFrames(Context& context, const IgpmScene& scene, Table& table, Plot& breakdown) {
  const IgpmColumn& column = *scene.column;
  const RenderSettings& settings = scene.settings;
  const FrameTimes times = measureFrames(context, *scene.trace, scene.camera(), settings);
  const double estimate = times.stagesMedian({"photon_bvh.build", "photon_bvh"});
  const Samples nearest = nearestMs(context, scene);
  table.rows.push_back({scene.choice->name,
                        fmt::format("{} x {}", settings.frame.width, settings.frame.height),
                        double(column.stored), times.last.counter("photonsStored"), double(column.smoothing),
                        double(settings.photonBvh.smoothing), double(column.photonsAtSample),
                        photonsAtSample(times.last), 1000 / column.framesPerSecond, times.clockMs,
                        times.processorMs, times.primaryRaysMs, times.overPrimaryRays(), estimate, nearest,
                        column.framesPerSecond / column.nearestFramesPerSecond, nearest.median() / estimate});
  const double at = double(breakdown.categories.size());
  breakdown.categories.push_back(scene.choice->standsIn ? scene.choice->scene.name : column.name);
  const std::array parts{
      times.stagesMedian({"photon_trace", "photon_trace.radius"}), times.stagesMedian({"photon_bvh.build"}),
      times.stagesMedian({"gbuffer", "direct", "composite"}), times.stagesMedian({"photon_bvh"})};
  for (std::size_t i = 0; i < parts.size(); ++i) breakdown.series[i].points.emplace_back(at, parts[i]);
  addPictures(context, scene, times.film.colour);
}

const Suite kIgpmSuite{"igpm", "Interactive global photon mapping: frames, leaves, footprints, kernels", 11,
                       runIgpm};

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the paper on splatting by a hierarchy over clusters of view samples measured (Moreau et al. 2016):
// times along a flight (figure 6), by stages (figure 8) and by optimisation (figure 9). The rest is in
// vsch_counts.cpp and vsch_quality.cpp.
#include "app/bench/vsch_parts.h"
#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace isophote::bench {
namespace {

/// From view samples and photons to indirect light.
const std::initializer_list<std::string_view> kSplatStages{"photon_tiles.build",
                                                           "photon_tiles",
                                                           "photon_clusters.build",
                                                           "photon_clusters.shallow",
                                                           "photon_clusters",
                                                           "photon_directional.build",
                                                           "photon_directional.shallow",
                                                           "photon_directional",
                                                           "photon_directional.shade",
                                                           "irradiance_blur"};

struct Flight {
  PublicScene scene;
  VschSetUp setUp;
};
constexpr std::array kFlights{Flight{PublicScene::kSponzaCrytek, kVschUsual},
                              Flight{PublicScene::kSponzaCrytek, kVschFew},
                              Flight{PublicScene::kSibenik, {200'000, 1.5f}}};

/// Along a short flight: forward by half the way to what the camera looks at, which swings to both sides.
Camera cameraAt(const Camera& camera, float part) {
  Camera moved = camera;
  const vec3 along = camera.target - camera.eye;
  const vec3 side = cross(normalize(along), vec3(0, 1, 0));
  moved.eye = camera.eye + along * (0.5f * part);
  moved.target = camera.target + side * (0.3f * length(along) * std::sin(2.0f * kPi * part));
  return moved;
}

std::uint32_t mostRepeats(const Context& context) { return context.quick() ? 1 : 3; }

constexpr std::array kFlightMethods{VschMethod::kTiled, VschMethod::kClusterTrivial,
                                    VschMethod::kDirectional};

/// Adds a row to the table, and the plot of its flight.
void fly(Context& context, const VschScene& scene, const Flight& flight, Table& table) {
  const int frames = context.quick() ? 2 : 6;
  Plot plot{.id = fmt::format("figure6-{}", table.rows.size()),
            .title = fmt::format("Figure 6: {}, {} photons of radius {}", scene.choice.name,
                                 context.photons(flight.setUp.photons), flight.setUp.radius),
            .caption = "Splatting along a short flight, forward and looking to both sides.",
            .x = {"part of the flight"},
            .y = {"splatting [ms]"}};
  std::array<double, kFlightMethods.size()> sums{};
  Samples rays;
  for (std::size_t m = 0; m < kFlightMethods.size(); ++m) {
    Series series{.name = nameOf(kFlightMethods[m])};
    const RenderSettings settings = vschSettings(context, kFlightMethods[m], flight.setUp);
    for (int i = 0; i < frames; ++i) {
      const float part = float(i) / float(frames - 1);
      const FrameTimes times = measureFrames(context, *scene.trace, cameraAt(scene.camera(), part), settings,
                                             mostRepeats(context));
      const double splat = splatMs(times);
      series.points.emplace_back(double(part), splat);
      sums[m] += splat / frames;
      rays.add(times.primaryRaysMs.median());
    }
    plot.series.push_back(std::move(series));
  }
  const RenderSettings shown = vschSettings(context, VschMethod::kTiled, flight.setUp);
  table.rows.push_back({scene.choice.name, fmt::format("{} x {}", shown.frame.width, shown.frame.height),
                        double(shown.photonTrace.photonsStored), double(shown.photonTiles.radius), sums[0],
                        sums[1], sums[2], 2.0, sums[0] / sums[1], 2.5, sums[1] / sums[2], rays});
  context.add(std::move(plot));
}

Table flightTable() {
  return {
      .id = "figure6",
      .title = "Figure 6: splatting along flights",
      .caption =
          "Means over a short flight. Paper: Moreau et al. 2016, Titan X; curves without figures, of which "
          "the text says that cluster-trivial is on average about two times as fast as tiles, and "
          "directional another two to three times. Splatting is all from view samples and photons to "
          "indirect light.",
      .columns = {{"measured"},
                  {"size"},
                  {"photons", Source::kHere},
                  {"radius", Source::kHere, "m"},
                  {"tiled", Source::kHere, "ms"},
                  {"cluster-trivial", Source::kHere, "ms"},
                  {"directional", Source::kHere, "ms"},
                  {"tiled over trivial", Source::kPaper},
                  {"tiled over trivial", Source::kHere},
                  {"trivial over directional", Source::kPaper},
                  {"trivial over directional", Source::kHere},
                  {"primary rays", Source::kYardstick, "ms"}}};
}

/// Parts of a frame, and the stages that they are.
struct FramePart {
  const char* name;
  std::initializer_list<std::string_view> stages;
};
const std::array<FramePart, 5>& frameParts() {
  static const std::array<FramePart, 5> parts{
      {{"photon tracing", {"photon_trace", "photon_trace.radius"}},
       {"first surfaces, direct light", {"gbuffer", "direct", "direct.shadow_maps", "composite"}},
       {"hierarchy", {"photon_clusters.build", "photon_directional.build", "photon_tiles.build"}},
       {"photons into it", {"photon_clusters.shallow", "photon_directional.shallow", "photon_directional"}},
       {"light at samples",
        {"photon_clusters", "photon_tiles", "photon_directional.shade", "irradiance_blur"}}}};
  return parts;
}

Table breakdownTable() {
  Table table{
      .id = "figure8",
      .title = "Figure 8: where the time of a frame goes",
      .caption =
          "Medians. The paper shows bars without figures; in them tiles are dominated by the "
          "final shading, and all frames by photon tracing.",
      .columns = {{"measured"}, {"method"}, {"photons", Source::kHere}, {"radius", Source::kHere, "m"}}};
  for (const FramePart& part : frameParts()) table.columns.push_back({part.name, Source::kHere, "ms"});
  table.columns.push_back({"frame", Source::kHere, "ms"});
  table.columns.push_back({"processor", Source::kHere, "ms"});
  table.columns.push_back({"primary rays", Source::kYardstick, "ms"});
  return table;
}

void addBreakdown(Context& context, const VschScene& scene, VschMethod method, VschSetUp setUp, Table& table,
                  Plot& plot) {
  const RenderSettings settings = vschSettings(context, method, setUp);
  const FrameTimes times =
      measureFrames(context, *scene.trace, scene.camera(), settings, mostRepeats(context));
  std::vector<Cell> row{scene.choice.name, nameOf(method), double(settings.photonTrace.photonsStored),
                        double(settings.photonTiles.radius)};
  const double at = double(plot.categories.size());
  plot.categories.push_back(fmt::format("{}, {}", nameOf(method), settings.photonTrace.photonsStored));
  for (std::size_t i = 0; i < frameParts().size(); ++i) {
    const double milliseconds = times.stagesMedian(frameParts()[i].stages);
    row.emplace_back(milliseconds);
    plot.series[i].points.emplace_back(at, milliseconds);
  }
  row.insert(row.end(), {times.clockMs, times.processorMs, times.primaryRaysMs});
  table.rows.push_back(std::move(row));
}

void addOptimisations(Context& context, const VschScene& scene) {
  Table table{.id = "figure9",
              .title = "Figure 9: what each optimisation is worth",
              .caption = fmt::format("{}, {} photons of radius {} in the paper. Its bars have no figures.",
                                     scene.choice.name, kVschUsual.photons, kVschUsual.radius),
              .columns = {{"method"},
                          {"splatting", Source::kHere, "ms"},
                          {"over the first", Source::kHere},
                          {"frame", Source::kHere, "ms"},
                          {"processor", Source::kHere, "ms"},
                          {"primary rays", Source::kYardstick, "ms"}}};
  Plot plot{.id = "figure9", .title = table.title, .caption = "", .x = {""}, .y = {"splatting [ms]"}};
  plot.series.push_back({.name = "splatting"});
  double first = 0;
  for (const VschMethod method : {VschMethod::kCluster, VschMethod::kClusterCone, VschMethod::kClusterTrivial,
                                  VschMethod::kDirectional, VschMethod::kTiled}) {
    if (!context.hasTimeFor(fmt::format("figure 9, {}", nameOf(method)))) continue;
    const FrameTimes times = measureFrames(context, *scene.trace, scene.camera(),
                                           vschSettings(context, method, kVschUsual), mostRepeats(context));
    const double splat = splatMs(times);
    if (first == 0) first = splat;
    table.rows.push_back(
        {nameOf(method), splat, splat / first, times.clockMs, times.processorMs, times.primaryRaysMs});
    plot.series[0].points.emplace_back(double(plot.categories.size()), splat);
    plot.categories.emplace_back(nameOf(method));
  }
  if (table.rows.empty()) return;
  context.add(std::move(table));
  context.add(std::move(plot));
}

void runVsch(Context& context) {
  context.note(
      "San Miguel, the third scene of the paper, is left out: it is not at hand, and nothing built in "
      "is like it.");
  context.note("The paper's unit of length is not printed: its radii are taken for metres.");
  VschScenes scenes(context);
  benchVschCounts(context, scenes);
  benchVschBreakdown(context, scenes);
  benchVschFlights(context, scenes);
  benchVschGlossy(context);
  benchVschQuality(context, scenes);  // Last, since pictures to compare with take the longest.
}

}  // namespace

const char* nameOf(VschMethod method) {
  constexpr std::array kNames{"tiled",           "cluster",     "cluster-cone",
                              "cluster-trivial", "directional", "directional, published weights"};
  return kNames[std::size_t(method)];
}

const VschScene& VschScenes::operator[](PublicScene wanted) {
  std::unique_ptr<VschScene>& scene = scenes_[wanted];
  if (scene) return *scene;
  scene = std::make_unique<VschScene>(VschScene{context_.scene(wanted), nullptr});
  for (NamedMaterial& material : scene->choice.scene.materials) {
    material.metallic = 0;
    material.specular = 0;
    material.transmission = 0;
  }
  scene->trace = std::make_unique<TraceScene>(scene->choice.scene);
  return *scene;
}

RenderSettings vschSettings(const Context& context, VschMethod method, VschSetUp setUp, std::uint32_t width,
                            std::uint32_t height) {
  const bool directional = method == VschMethod::kDirectional || method == VschMethod::kDirectionalPublished;
  RenderSettings settings = presetSettings(method == VschMethod::kTiled ? "tiled"
                                           : directional                ? "directional"
                                                                        : "clusters");
  context.setSize(settings.frame, width, height);
  settings.direct.shadowResolution = context.side(settings.direct.shadowResolution);
  settings.photonTrace.photonsStored = context.photons(setUp.photons);
  constexpr float kMost = 4;
  const float wider =
      std::sqrt(float(setUp.photons) / float(std::max(settings.photonTrace.photonsStored, 1u)));
  const float radius = setUp.radius * std::min(wider, kMost);
  settings.photonTiles.radius = settings.photonClusters.radius = settings.photonDirectional.radius = radius;
  settings.photonClusters.cone = method != VschMethod::kCluster;
  settings.photonClusters.trivial =
      method == VschMethod::kClusterTrivial ? TrivialAccept::kAll : TrivialAccept::kOff;
  if (method == VschMethod::kDirectionalPublished)
    settings.photonDirectional.weights = OctantWeights::kPublished;
  return settings;
}

double splatMs(const FrameTimes& times) { return times.stagesMedian(kSplatStages); }

double splatMs(const Stats& stats) {
  double sum = 0;
  for (const std::string_view stage : kSplatStages) sum += stats.stageMilliseconds(stage);
  return sum;
}

void benchVschFlights(Context& context, VschScenes& scenes) {
  Table table = flightTable();
  for (const Flight& flight : kFlights) {
    if (!context.hasTimeFor(fmt::format("figure 6, {} photons", flight.setUp.photons), 3)) continue;
    fly(context, scenes[flight.scene], flight, table);
  }
  if (!table.rows.empty()) context.add(std::move(table));
}

void benchVschBreakdown(Context& context, VschScenes& scenes) {
  if (!context.hasTimeFor("figures 8 and 9", 3)) return;
  const VschScene& scene = scenes[PublicScene::kSponzaCrytek];
  addOptimisations(context, scene);
  Table table = breakdownTable();
  Plot plot{.id = "figure8",
            .title = table.title,
            .caption = table.caption,
            .x = {""},
            .y = {"time [ms]"},
            .stacked = true};
  for (const FramePart& part : frameParts()) plot.series.push_back({.name = part.name});
  for (const VschSetUp setUp : {kVschUsual, kVschFew, VschSetUp{50'000, 2.0f}, VschSetUp{1'000'000, 0.7f}}) {
    if (context.quick() && setUp.photons != kVschUsual.photons) continue;
    for (const VschMethod method :
         {VschMethod::kTiled, VschMethod::kClusterTrivial, VschMethod::kDirectional})
      if (context.hasTimeFor(fmt::format("figure 8, {} with {} photons", nameOf(method), setUp.photons), 2))
        addBreakdown(context, scene, method, setUp, table, plot);
  }
  if (!table.rows.empty()) {
    context.add(std::move(table));
    context.add(std::move(plot));
  }
}

const Suite kVschSuite{"vsch", "Splatting by a hierarchy over clusters: times, reads, memory, quality", 10,
                       runVsch};

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The measurements of the paper on interactive global photon mapping (IGPM): frames with the settings of its
// table 2, the leaf thresholds of its table 1, and the same photons by the k nearest. The smoothing of each
// scene is found first, such that as many photons count at a view sample as in the paper. The yardstick is
// what Embree alone takes for the frame's primary rays.
#include "render/bench_support.h"
#include "scene/builtin/shapes.h"
#include "scene/surface_area.h"

#include <time.h>

#include <algorithm>
#include <cmath>

namespace isophote {
namespace {

/// A column of the table. Our models return other parts of the light than the paper's, so that another number
/// of photons has to be emitted for as many to be stored.
struct Column {
  const char* scene;
  std::uint32_t emitted, stored;
  float photonsAtSample;
  float framesPerSecond;  ///< Of the paper, on its GPU.
};
constexpr Column kColumns[] = {{"sponza", 256 * 1024, 299'000, 175, 3.98f},
                               {"conference", 128 * 1024, 83'000, 234, 4.50f},
                               {"sibenik", 512 * 1024, 418'000, 224, 3.43f},
                               {"ring", 128 * 1024, 76'000, 182, 6.22f}};

/// As many triangles as the paper's: a mirror of 128 in a room of five walls.
Scene ring() {
  Scene scene;
  Mesh room, cylinder;
  addQuad(room, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
  addQuad(room, {-2, 3, -2}, {4, 0, 0}, {0, 0, 4});
  addQuad(room, {-2, 0, -2}, {4, 0, 0}, {0, 3, 0});
  addQuad(room, {-2, 0, 2}, {0, 0, -4}, {0, 3, 0});
  addQuad(room, {2, 0, -2}, {0, 0, 4}, {0, 3, 0});
  const std::array profile{ProfilePoint{0.7f, 0.0f}, ProfilePoint{0.7f, 0.3f}};
  addLathe(cylinder, profile, 64);
  NamedMaterial mirror{makeMaterial(), "mirror"};
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  mirror.baseColour = vec3(0.9f);
  addObject(scene, "room", addMaterial(scene, lambert("room", vec3(0.6f))), room);
  addObject(scene, "ring", addMaterial(scene, mirror), cylinder);
  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = {-1.4f, 1.5f, 0};
  lamp.colour = vec3(8.0f);
  scene.lights = {lamp};
  scene.cameras = {{.name = "", .eye = {0, 1.9f, 1.9f}, .target = {0, 0, -0.2f}, .verticalFovDegrees = 60}};
  finishScene(scene, "ring");
  return scene;
}

std::optional<Scene> sceneOf(std::string_view name) {
  if (name == "sponza")
    return assetScene("sponza-dabrovic/sponza.obj", {0, 7, 0}, 1500,
                      {.name = "", .eye = {13.5f, 2.2f, 0}, .target = {-4, 4, 0}, .verticalFovDegrees = 60});
  if (name == "conference")
    return assetScene(
        "conference/conference.obj", {1.4f, 2.2f, -0.8f}, 150,
        {.name = "", .eye = {5.8f, 1.7f, 1.9f}, .target = {0, 0.8f, -1.2f}, .verticalFovDegrees = 55});
  if (name == "sibenik")
    return assetScene("sibenik/sibenik.obj", {0, -4, 0}, 2000,
                      {.name = "", .eye = {-15, -11, 0}, .target = {10, -8, 0}, .verticalFovDegrees = 60});
  return ring();
}

RenderSettings settingsOf(const Column& column) {
  RenderSettings settings = presetSettings("igpm");
  settings.frame.width = settings.frame.height = 512;
  settings.frame.layers = false;
  settings.gbuffer.mirrorDepth = 1;
  settings.photonTrace.photons = column.emitted;
  settings.photonBvh.smoothing = 20;
  return settings;
}

struct Frame {
  double processorMs;  ///< Of all threads.
  double clockMs;
  Stats stats;
  double photonsAtSample() const {
    return stats.counter("photon_bvh.pairsContributing") / stats.counter("gbuffer.viewSamples");
  }
};

/// Processor time of all threads so far.
double processorMs() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

Frame frameOf(CpuRenderer& renderer, const Camera& camera, Film& film) {
  Frame frame;
  const double before = processorMs();
  const auto start = std::chrono::steady_clock::now();
  renderer.render(camera, film, frame.stats);
  frame.clockMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  frame.processorMs = processorMs() - before;
  return frame;
}

/// Photons to emit, and the smoothing at which as many photons count at a view sample as in the paper, within
/// a hundredth.
void fit(const TraceScene& trace, const Column& column, RenderSettings& settings) {
  Film film;
  {
    CpuRenderer renderer(trace, settings);
    const double stored =
        frameOf(renderer, trace.scene().cameras.front(), film).stats.counter("photonsStored");
    settings.photonTrace.photons = std::uint32_t(double(column.emitted) * double(column.stored) / stored);
  }
  for (int i = 0; i < 12; ++i) {
    CpuRenderer renderer(trace, settings);
    const double found = frameOf(renderer, trace.scene().cameras.front(), film).photonsAtSample();
    const double ratio = double(column.photonsAtSample) / std::max(found, 1.0);
    if (std::abs(ratio - 1.0) < 0.01) break;
    settings.photonBvh.smoothing *= float(std::clamp(std::sqrt(ratio), 0.25, 4.0));
  }
}

double medianOf(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + std::ssize(values) / 2);
  return values[values.size() / 2];
}

void table2(benchmark::State& state, Column column) {
  const std::optional<Scene> scene = sceneOf(column.scene);
  if (!scene) {
    state.SkipWithError("set ISOPHOTE_ASSETS to the folder of the public scenes");
    return;
  }
  const TraceScene trace(*scene);
  const Camera& camera = scene->cameras.front();
  RenderSettings settings = settingsOf(column);
  fit(trace, column, settings);
  CpuRenderer renderer(trace, settings);
  Film film;
  Frame frame = frameOf(renderer, camera, film);
  std::vector<double> processor, clock, rays;
  Stats sum;
  for (auto _ : state) {
    for (int i = 0; i < 7; ++i) {
      frame = frameOf(renderer, camera, film);
      processor.push_back(frame.processorMs);
      clock.push_back(frame.clockMs);
      for (const auto& [name, ms] : frame.stats.stages()) sum.addStage(name, ms / 7);
      rays.push_back(primaryRaysMs(trace, cameraRays(camera, 512, 512), 512, 512));
    }
  }
  for (const auto& [name, ms] : sum.stages()) state.counters[name + "Ms"] = ms;
  state.counters["framesPerSecond"] = 2000.0 / medianOf(processor);  // Of two cores, if both were free.
  state.counters["framesPerSecondByClock"] = 1000.0 / medianOf(clock);
  state.counters["ofPaper"] = 2000.0 / medianOf(processor) / double(column.framesPerSecond);
  state.counters["primaryRaysMs"] = medianOf(rays);
  state.counters["photonsEmitted"] = frame.stats.counter("photonsEmitted");
  state.counters["photonsStored"] = frame.stats.counter("photonsStored");
  state.counters["photonsAtSample"] = frame.photonsAtSample();
  state.counters["smoothing"] = double(settings.photonBvh.smoothing);
  state.counters["leafPhotons"] = frame.stats.counter("photon_bvh.leafPhotons");
  state.counters["footprintsOverSurfaces"] = frame.stats.counter("photon_bvh.footprintsOverSurfaces");
  state.counters["pairsTested"] = frame.stats.counter("photon_bvh.pairsTested");
  state.counters["pairsContributing"] = frame.stats.counter("photon_bvh.pairsContributing");
}

/// What a scene hands to its estimate, and the settings that fit the column.
struct Estimated {
  RenderSettings settings;
  ViewSamples view;
  PhotonMap map;
  float radius;        ///< PhotonBvh::In::radius
  double surfaceArea;  ///< PhotonBvh::In::surfaceArea

  PhotonBvh::In in() const { return {view, map, radius, 1.0f, surfaceArea}; }
};

/// Nothing, and the benchmark skipped, without the public scenes.
std::optional<Estimated> estimated(benchmark::State& state, const Column& column) {
  const std::optional<Scene> scene = sceneOf(column.scene);
  if (!scene) {
    state.SkipWithError("set ISOPHOTE_ASSETS to the folder of the public scenes");
    return std::nullopt;
  }
  const TraceScene trace(*scene);
  Estimated e;
  RenderSettings& settings = e.settings;
  settings = settingsOf(column);
  fit(trace, column, settings);
  Stats stats;
  Gbuffer(settings.gbuffer)
      .run({trace, cameraRays(trace.scene().cameras.front(), 512, 512), 512, 512}, e.view, stats);
  PhotonTrace(settings.photonTrace).run({.trace = trace, .bounces = 2, .footprints = true}, e.map, stats);
  e.radius = middleRadius(e.map, settings.photonBvh, settings.photonBvh.smoothing);
  e.surfaceArea = surfaceArea(*scene);
  return e;
}

/// Processor time of one run of an estimator, of all threads: what it builds first is in it.
template <class Stage, class In>
double estimateMs(Stage& stage, const In& in) {
  Radiance out;
  Stats stats;
  const double before = processorMs();
  stage.run(in, out, stats);
  return processorMs() - before;
}

/// The estimate with every leaf threshold, in turns, and with the automatic one.
void table1(benchmark::State& state, Column column, PhotonSplit split) {
  const std::optional<Estimated> e = estimated(state, column);
  if (!e) return;
  PhotonBvhSettings settings = e->settings.photonBvh;
  settings.split = split;
  constexpr std::array<std::uint32_t, 10> kLeaves{0, 2, 4, 8, 16, 32, 64, 128, 256, 512};
  std::array<std::vector<double>, kLeaves.size()> times;
  std::vector<PhotonBvh> stages;
  for (const std::uint32_t leaf : kLeaves) {
    settings.leafPhotons = leaf;
    stages.emplace_back(settings);
  }
  for (auto _ : state)
    for (int turn = 0; turn < 15; ++turn)
      for (std::size_t i = 0; i < stages.size(); ++i) {
        times[i].push_back(estimateMs(stages[i], e->in()));
      }
  double best = 1e300;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const double ms = medianOf(times[i]);
    if (i > 0) best = std::min(best, ms);
    state.counters[i == 0 ? "automaticMs" : "leaf" + std::to_string(kLeaves[i]) + "Ms"] = ms;
  }
  state.counters["automaticOfBest"] = best / medianOf(times[0]);
}

/// Where the k nearest are looked for [m]: far enough that there are as many nearly everywhere.
constexpr float kNearestWithin = 2.0f;

/// Photons that count at a view sample and the processor time of asking for them, by footprints and by the k
/// nearest.
void againstNearest(benchmark::State& state, Column column) {
  const std::optional<Estimated> e = estimated(state, column);
  if (!e) return;
  PhotonBvh bvh(e->settings.photonBvh);
  PhotonKdtree kdtree({.nearest = std::uint32_t(column.photonsAtSample)});
  double nearestMs = 0;
  std::vector<double> bvhMs;
  for (auto _ : state) {
    nearestMs = estimateMs(kdtree, PhotonKdtree::In{e->view, e->map, kNearestWithin});
    for (int turn = 0; turn < 7; ++turn) bvhMs.push_back(estimateMs(bvh, e->in()));
  }
  state.counters["bvhMs"] = medianOf(bvhMs);
  state.counters["kdtreeMs"] = nearestMs;
  state.counters["timesFaster"] = nearestMs / medianOf(bvhMs);
}

[[maybe_unused]] const bool registered = [] {
  const auto add = [](const std::string& name, auto function, auto... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), function, arguments...)
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1)
        ->UseRealTime();
  };
  for (const Column& column : kColumns) {
    add(std::string("igpm/frames/") + column.scene, table2, column);
    add(std::string("igpm/leaves/morton/") + column.scene, table1, column, PhotonSplit::kMorton);
    add(std::string("igpm/leaves/volume/") + column.scene, table1, column, PhotonSplit::kVolume);
    add(std::string("igpm/nearest/") + column.scene, againstNearest, column);
  }
  return true;
}();

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole frame, stage by stage: atrium at 1920 x 1080 with 20 k photons emitted, and scenes with the
// settings of table 2 of the paper on image space photon mapping. Each benchmark is one frame; its counters
// are the milliseconds of the stages. The yardstick is the ray tracer: `primaryRaysMs` is what Embree alone
// takes for the frame's primary rays in the same packets.
#include "render/bench_support.h"
#include "render/cpu_renderer.h"
#include "render/test_ring.h"

#include <benchmark/benchmark.h>

#include <optional>

namespace isophote {
namespace {

struct FrameCase {
  Estimator estimator = Estimator::kVolumes;
  std::uint32_t subsample = 1;
  Shadows shadows = Shadows::kTraced;
  const char* preset = nullptr;  ///< In place of all of these.
};

/// One frame after the other, as a program shows them: no layers, and the memory of the frame before.
void frames(benchmark::State& state, const Scene& scene, RenderSettings settings) {
  const TraceScene trace(scene);
  settings.frame.layers = false;
  const Camera& camera = scene.cameras.front();
  const int width = int(settings.frame.width), height = int(settings.frame.height);
  CpuRenderer renderer(trace, settings);
  Film film;
  Stats first;
  renderer.render(camera, film, first);
  Stats sum;  // Its stages add up; its counters are those of the last frame.
  double rays = 0;
  for (auto _ : state) {
    renderer.render(camera, film, sum);
    benchmark::DoNotOptimize(film.colour.pixels.data());
    state.PauseTiming();
    rays += primaryRaysMs(trace, cameraRays(camera, width, height), width, height);
    state.ResumeTiming();
  }
  const auto average = benchmark::Counter::kAvgIterations;
  for (const auto& [name, milliseconds] : sum.stages()) state.counters[name + "Ms"] = {milliseconds, average};
  state.counters["primaryRaysMs"] = {rays, average};
  state.counters["photonsStored"] = sum.counter("photonsStored");
  if (settings.frame.estimator == Estimator::kVolumes) {
    state.counters["pairsTested"] = sum.counter("photon_volumes.pairsTested");
    state.counters["pairsContributing"] = sum.counter("photon_volumes.pairsContributing");
  }
}

void frame(benchmark::State& state, FrameCase c) {
  RenderSettings settings;
  if (c.preset) {
    settings = presetSettings(c.preset);
  } else {
    settings.frame.estimator = c.estimator;
    settings.frame.subsample = c.subsample;
    settings.direct.shadows = c.shadows;
  }
  settings.frame.width = 1920;
  settings.frame.height = 1080;
  settings.photonTrace.photons = 20'000;
  frames(state, loadScene("atrium"), settings);
}

/// A row of the table: --preset ispm, photons emitted, bounces, the size and the cells of subsampling.
struct TableRow {
  const char* scene;
  std::uint32_t width, height;
  std::uint32_t photons;
  std::uint32_t bounces;
  std::uint32_t subsample;
};

/// The paper's Sponza: Dabrovic's, from the folder that ISOPHOTE_ASSETS names, under one lamp.
std::optional<Scene> sponza() {
  return assetScene("sponza-dabrovic/sponza.obj", {0, 7, 0}, 1500.0f,
                    {.name = "", .eye = {13.5f, 2.2f, 0}, .target = {-4, 4, 0}, .verticalFovDegrees = 60});
}

void tableRow(benchmark::State& state, TableRow row) {
  const std::optional<Scene> scene = std::string_view(row.scene) == "sponza" ? sponza() : spottedRing();
  if (!scene) {
    state.SkipWithError("set ISOPHOTE_ASSETS to the folder of the public scenes");
    return;
  }
  RenderSettings settings = presetSettings("ispm");
  settings.frame.width = row.width;
  settings.frame.height = row.height;
  settings.frame.bounces = row.bounces;
  settings.frame.subsample = row.subsample;
  settings.photonTrace.photons = row.photons;
  frames(state, *scene, settings);
}

template <class Function, class Case>
void registerFrame(const char* name, Function function, Case c) {
  benchmark::RegisterBenchmark(name, function, c)
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()  // Both cores' time: its half is what an idle machine takes, at best.
      ->UseRealTime();
}

[[maybe_unused]] const bool registered = [] {
  registerFrame("frame/atrium1080p20kVolumes", frame, FrameCase{});
  registerFrame("frame/atrium1080p20kVolumesSubsample4", frame, FrameCase{.subsample = 4});
  registerFrame("frame/atrium1080p20kVolumesSubsample4ShadowMaps", frame,
                FrameCase{.subsample = 4, .shadows = Shadows::kMap});
  registerFrame("frame/atrium1080p20kIspm", frame, FrameCase{.preset = "ispm"});
  registerFrame("frame/atrium1080p20kKdtree", frame, FrameCase{.estimator = Estimator::kKdtree});
  registerFrame("table2/assetSponza1600p14k", tableRow, TableRow{"sponza", 1920, 1600, 13'688, 1, 4});
  registerFrame("table2/assetSponza1080p6k", tableRow, TableRow{"sponza", 1920, 1080, 6'240, 1, 4});
  registerFrame("table2/ring384p101kSubsample1", tableRow, TableRow{"ring", 512, 384, 101'124, 1, 1});
  registerFrame("table2/ring384p325kSubsample1", tableRow, TableRow{"ring", 512, 384, 324'900, 1, 1});
  registerFrame("table2/ring1080p101kSubsample1", tableRow, TableRow{"ring", 1920, 1080, 101'124, 1, 1});
  return true;
}();

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole frame, stage by stage: atrium at 1920 x 1080 with 20 k photons emitted (`isophote bench` has the
// frames of the papers). Each benchmark is one frame; its counters are the milliseconds of the stages. The
// yardstick is the ray tracer: `primaryRaysMs` is what Embree alone takes for the frame's primary rays in the
// same packets.
#include "render/cpu_renderer.h"
#include "render/yardstick.h"

#include <benchmark/benchmark.h>

#include <chrono>

namespace isophote {
namespace {

/// What Embree alone takes for a frame's primary rays, in packets of 16, on all threads [ms].
double primaryRaysMs(const TraceScene& trace, const CameraRays& camera, int width, int height) {
  const auto start = std::chrono::steady_clock::now();
  benchmark::DoNotOptimize(tracePrimaryRays(trace, camera, width, height));
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

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
  return true;
}();

}  // namespace
}  // namespace isophote

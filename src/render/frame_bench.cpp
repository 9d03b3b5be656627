// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole frame, stage by stage: atrium at 1920 x 1080 with 20 k photons emitted. Each benchmark is one
// frame; its counters are the milliseconds of the stages. The yardstick is the ray tracer: `primaryRaysMs` is
// what Embree alone takes for the frame's primary rays in the same packets.
#include "render/cpu_renderer.h"

#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include <array>
#include <chrono>

namespace isophote {
namespace {

double primaryRaysMs(const TraceScene& trace, const CameraRays& camera, int width, int height) {
  const auto start = std::chrono::steady_clock::now();
  const vec2 size{float(width), float(height)};
  tbb::parallel_for(0, height / 4, [&](int row) {
    for (int column = 0; column < width / 4; ++column) {
      std::array<Ray, 16> rays;
      std::array<Hit, 16> hits;
      for (int i = 0; i < 16; ++i) {
        const vec2 pixel(float(4 * column + i % 4) + 0.5f, float(4 * row + i / 4) + 0.5f);
        const vec2 p = imagePlaneFromPixel(pixel, size);
        rays[std::size_t(i)] = {cameraRayOrigin(camera, p), 0.0f, cameraRayDirection(camera, p), 1e30f};
      }
      trace.closestHits(rays, hits, true);
      benchmark::DoNotOptimize(hits);
    }
  });
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

struct FrameCase {
  Estimator estimator = Estimator::kVolumes;
  std::uint32_t subsample = 1;
  Shadows shadows = Shadows::kTraced;
};

/// One frame after the other, as a program shows them: no layers, and the memory of the frame before.
void frame(benchmark::State& state, FrameCase c) {
  const Scene scene = loadScene("atrium");
  const TraceScene trace(scene);
  RenderSettings settings;
  settings.frame.width = 1920;
  settings.frame.height = 1080;
  settings.frame.estimator = c.estimator;
  settings.frame.subsample = c.subsample;
  settings.frame.layers = false;
  settings.direct.shadows = c.shadows;
  settings.photonTrace.photons = 20'000;
  CpuRenderer renderer(trace, settings);
  Film film;
  Stats first;
  renderer.render(scene.cameras.front(), film, first);
  Stats sum;  // Its stages add up; its counters are those of the last frame.
  double rays = 0;
  for (auto _ : state) {
    renderer.render(scene.cameras.front(), film, sum);
    benchmark::DoNotOptimize(film.colour.pixels.data());
    state.PauseTiming();
    rays += primaryRaysMs(trace, cameraRays(scene.cameras.front(), 1920, 1080), 1920, 1080);
    state.ResumeTiming();
  }
  const auto average = benchmark::Counter::kAvgIterations;
  for (const auto& [name, milliseconds] : sum.stages()) state.counters[name + "Ms"] = {milliseconds, average};
  state.counters["primaryRaysMs"] = {rays, average};
  if (c.estimator == Estimator::kVolumes) {
    state.counters["pairsTested"] = sum.counter("photon_volumes.pairsTested");
    state.counters["pairsContributing"] = sum.counter("photon_volumes.pairsContributing");
  }
}

void registerFrame(const char* name, FrameCase c) {
  benchmark::RegisterBenchmark(name, frame, c)
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()  // Both cores' time: its half is what an idle machine takes, at best.
      ->UseRealTime();
}

[[maybe_unused]] const bool registered = [] {
  registerFrame("frame/atrium1080p20kVolumes", {});
  registerFrame("frame/atrium1080p20kVolumesSubsample4", {.subsample = 4});
  registerFrame("frame/atrium1080p20kVolumesSubsample4ShadowMaps",
                {.subsample = 4, .shadows = Shadows::kMap});
  registerFrame("frame/atrium1080p20kKdtree", {.estimator = Estimator::kKdtree});
  return true;
}();

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole frame, stage by stage: atrium at 1920 x 1080 with 20 k photons emitted. Each benchmark is one
// frame; its counters are the milliseconds of the stages. The yardstick is the ray tracer: `primaryRaysMs` is
// what Embree alone takes for the frame's primary rays in the same packets.
#include "render/cpu_frame.h"

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

void frame(benchmark::State& state, Estimator estimator) {
  const Scene scene = loadScene("atrium");
  const TraceScene trace(scene);
  RenderSettings settings;
  settings.frame.width = 1920;
  settings.frame.height = 1080;
  settings.frame.estimator = estimator;
  settings.photonTrace.photons = 20'000;
  constexpr std::array kStages{"photon_trace",   "gbuffer",       "direct",
                               "photon_volumes", "photon_kdtree", "composite"};
  std::array<double, kStages.size()> milliseconds{};
  double rays = 0;
  double tested = 0;
  double contributing = 0;
  for (auto _ : state) {
    Stats stats;
    benchmark::DoNotOptimize(renderCpu(trace, scene.cameras.front(), settings, stats));
    for (std::size_t i = 0; i < kStages.size(); ++i) milliseconds[i] += stats.stageMilliseconds(kStages[i]);
    state.PauseTiming();
    rays += primaryRaysMs(trace, cameraRays(scene.cameras.front(), 1920, 1080), 1920, 1080);
    if (estimator == Estimator::kVolumes) {
      tested = stats.counter("photon_volumes.pairsTested");
      contributing = stats.counter("photon_volumes.pairsContributing");
    }
    state.ResumeTiming();
  }
  const auto average = benchmark::Counter::kAvgIterations;
  for (std::size_t i = 0; i < kStages.size(); ++i)
    if (milliseconds[i] > 0) state.counters[std::string(kStages[i]) + "Ms"] = {milliseconds[i], average};
  state.counters["primaryRaysMs"] = {rays, average};
  if (tested > 0) state.counters["pairsTested"] = tested;
  if (tested > 0) state.counters["pairsContributing"] = contributing;
}

BENCHMARK_CAPTURE(frame, atrium1080p20kVolumes, Estimator::kVolumes)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(frame, atrium1080p20kKdtree, Estimator::kKdtree)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace isophote

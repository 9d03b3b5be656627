// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Photon tracing against the ray tracer alone: the rays of a run are recorded and replayed, one at a time and
// 16 at once. Path by path is how a tracer that does not reorder rays would trace them: `ofEmbree` is the
// stage's speed over that of the faster such replay. `ofSorted` is that over the faster replay in the stage's
// own order. Everything is timed by the processor time of one thread, the five in turns within each
// iteration: what else the machine does weighs little, and on all of them. `twoThreads` is the stage's speed
// on two threads over that on one, by the clock.
#include "scene/builtin/builtin.h"
#include "scene/obj.h"
#include "stages/photon_trace/photon_trace.h"

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>

namespace isophote {
namespace {

double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double secondsOf(auto&& work) {
  const double start = threadSeconds();
  work();
  return threadSeconds() - start;
}

void replaySingly(const TraceScene& trace, const std::vector<Ray>& rays, std::vector<Hit>& hits) {
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = trace.closestHit(rays[i]);
}

void replayInSixteens(const TraceScene& trace, const std::vector<Ray>& rays, std::vector<Hit>& hits) {
  for (std::size_t i = 0; i < rays.size(); i += 16) {
    const std::size_t count = std::min<std::size_t>(16, rays.size() - i);
    trace.closestHits({&rays[i], count}, {&hits[i], count}, false);
  }
}

std::vector<Ray> raysOf(const std::vector<TracedRay>& traced) {
  std::vector<Ray> rays;
  for (const TracedRay& t : traced) rays.push_back(t.ray);
  return rays;
}

/// Of paths one after the other.
std::vector<Ray> pathByPath(std::vector<TracedRay> rays) {
  std::stable_sort(rays.begin(), rays.end(), [](const TracedRay& a, const TracedRay& b) {
    return std::pair(a.light, a.path) < std::pair(b.light, b.path);
  });
  return raysOf(rays);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

/// Seconds that runs on so many threads take by the clock.
double clockSeconds(PhotonTrace& stage, const TraceScene& trace, int threads) {
  PhotonMap map;
  Stats stats;
  std::vector<double> times;
  tbb::task_arena arena(threads);
  arena.execute([&] {
    for (int i = 0; i < 6; ++i) {
      const auto start = std::chrono::steady_clock::now();
      stage.run({.trace = trace}, map, stats);
      times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
  });
  return *std::min_element(times.begin(), times.end());
}

void measure(benchmark::State& state, const Scene& scene, std::uint32_t photons = 200'000) {
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = photons});
  PhotonMap map;
  Stats stats;
  std::vector<TracedRay> traced;
  stage.run({.trace = trace, .rays = &traced}, map, stats);
  const std::vector<Ray> sorted = raysOf(traced), rays = pathByPath(traced);
  std::vector<Hit> hits(rays.size());

  std::vector<double> stageTimes, single, wide, ratios, sortedRatios;
  tbb::task_arena oneThread(1);
  oneThread.execute([&] {
    for (auto _ : state) {
      stageTimes.push_back(secondsOf([&] { stage.run({.trace = trace}, map, stats); }));
      single.push_back(secondsOf([&] { replaySingly(trace, rays, hits); }));
      wide.push_back(secondsOf([&] { replayInSixteens(trace, rays, hits); }));
      ratios.push_back(std::min(single.back(), wide.back()) / stageTimes.back());
      const double sortedTime = std::min(secondsOf([&] { replaySingly(trace, sorted, hits); }),
                                         secondsOf([&] { replayInSixteens(trace, sorted, hits); }));
      sortedRatios.push_back(sortedTime / stageTimes.back());
    }
  });
  const double count = double(rays.size());
  state.counters["raysPerSecond"] = count / median(stageTimes);
  state.counters["singleRaysPerSecond"] = count / median(single);
  state.counters["wideRaysPerSecond"] = count / median(wide);
  state.counters["ofEmbree"] = median(ratios);
  state.counters["ofSorted"] = median(sortedRatios);
  state.counters["twoThreads"] = clockSeconds(stage, trace, 1) / clockSeconds(stage, trace, 2);
  state.counters["rays"] = count;
}

void builtin(benchmark::State& state, const char* name, std::uint32_t photons) {
  const BuiltinScene* entry = findBuiltinScene(name);
  if (!entry) {
    state.SkipWithError("no built-in scene of that name");
    return;
  }
  Scene scene = entry->make();
  finishScene(scene, name);
  measure(state, scene, photons);
}

/// A public scene from the folder that ISOPHOTE_ASSETS names, lit by one point light of 1500 W.
void asset(benchmark::State& state, const char* name, vec3 lightPosition) {
  const char* folder = std::getenv("ISOPHOTE_ASSETS");
  if (!folder) {
    state.SkipWithError("set ISOPHOTE_ASSETS to the folder of the public scenes");
    return;
  }
  Scene scene = loadScene((std::filesystem::path(folder) / name).string());
  scene.lights.clear();
  Light light{};
  light.type = kLightPoint;
  light.position = lightPosition;
  light.colour = vec3(1500.0f / (4.0f * kPi));
  scene.lights.push_back(light);
  finishScene(scene, name);
  measure(state, scene);
}

BENCHMARK_CAPTURE(builtin, photon_trace / cornell_box, "cornell-box", 200'000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(builtin, photon_trace / atrium, "atrium", 200'000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(builtin, photon_trace / atrium_few, "atrium", 20'000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(asset, photon_trace / sponza_dabrovic, "sponza-dabrovic/sponza.obj", vec3(0, 7, 0))
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(asset, photon_trace / sponza_crytek, "sponza-crytek/sponza.gltf", vec3(0, 4.5f, -0.3f))
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isophote

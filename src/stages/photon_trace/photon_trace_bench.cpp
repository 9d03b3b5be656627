// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Photon tracing against the ray tracer alone: the rays of a run are recorded and replayed in the same order,
// one at a time and 16 at once. `ofEmbree` is the stage's speed over that of the faster replay. Everything
// runs on one thread and is timed by the processor time of that thread, the three in turns within each
// iteration: what else the machine does weighs little, and on all of them.
#include "scene/builtin/builtin.h"
#include "scene/obj.h"
#include "stages/photon_trace/photon_trace.h"

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>
#include <time.h>

#include <algorithm>
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

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

void measure(benchmark::State& state, const Scene& scene) {
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = 200'000});
  PhotonMap map;
  Stats stats;
  std::vector<Ray> rays;
  stage.run({.trace = trace, .rays = &rays}, map, stats);
  std::vector<Hit> hits(rays.size());

  std::vector<double> stageTimes, single, wide, ratios;
  tbb::task_arena oneThread(1);
  oneThread.execute([&] {
    for (auto _ : state) {
      stageTimes.push_back(secondsOf([&] { stage.run({.trace = trace}, map, stats); }));
      single.push_back(secondsOf([&] { replaySingly(trace, rays, hits); }));
      wide.push_back(secondsOf([&] { replayInSixteens(trace, rays, hits); }));
      ratios.push_back(std::min(single.back(), wide.back()) / stageTimes.back());
    }
  });
  const double count = double(rays.size());
  state.counters["raysPerSecond"] = count / median(stageTimes);
  state.counters["singleRaysPerSecond"] = count / median(single);
  state.counters["wideRaysPerSecond"] = count / median(wide);
  state.counters["ofEmbree"] = median(ratios);
  state.counters["rays"] = count;
}

void builtin(benchmark::State& state, const char* name) {
  const BuiltinScene* entry = findBuiltinScene(name);
  if (!entry) {
    state.SkipWithError("no built-in scene of that name");
    return;
  }
  Scene scene = entry->make();
  finishScene(scene, name);
  measure(state, scene);
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

BENCHMARK_CAPTURE(builtin, photon_trace / cornell_box, "cornell-box")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(builtin, photon_trace / atrium, "atrium")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(asset, photon_trace / sponza_dabrovic, "sponza-dabrovic/sponza.obj", vec3(0, 7, 0))
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(asset, photon_trace / sponza_crytek, "sponza-crytek/sponza.gltf", vec3(0, 4.5f, -0.3f))
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The closest hits of all rays of a picture of 1920 x 1080: rasterised, rasterised and turned into hits, and
// traced in Embree's coherent packets of 16. They run in turns, on as many threads as the argument says;
// `ofEmbree` is how many times faster rasterising is than tracing, `hitsOfEmbree` the same with hits. Ratios
// and milliseconds are of the processor time of all threads together, so that other work on the machine
// weighs little; `...Wall` is the shortest time that passed.
#include "scene/builtin/builtin.h"
#include "trace/raster.h"

#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <time.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>

namespace isophote {
namespace {

constexpr int kWidth = 1920, kHeight = 1080, kTile = 8;

double secondsOn(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Of one kind of work, over the iterations.
struct Times {
  std::vector<double> processor;
  double shortest = 1e30;

  void measure(auto&& work) {
    const double wall = secondsOn(CLOCK_MONOTONIC), cpu = secondsOn(CLOCK_PROCESS_CPUTIME_ID);
    work();
    processor.push_back(secondsOn(CLOCK_PROCESS_CPUTIME_ID) - cpu);
    shortest = std::min(shortest, secondsOn(CLOCK_MONOTONIC) - wall);
  }
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

/// Tiles of 8 x 8 pixels, as gbuffer goes through them.
void forEachTile(auto&& work) {
  tbb::parallel_for(0, kWidth / kTile * (kHeight / kTile), [&](int tile) {
    work(tile % (kWidth / kTile) * kTile, tile / (kWidth / kTile) * kTile);
  });
}

void trace(const TraceScene& scene, const RasterView& view, std::vector<Hit>& hits) {
  forEachTile([&](int x0, int y0) {
    for (int part = 0; part < 4; ++part) {
      std::array<Ray, 16> rays;
      for (int i = 0; i < 16; ++i) rays[std::size_t(i)] = rasterRay(view, x0 + i % 8, y0 + part * 2 + i / 8);
      std::array<Hit, 16> found;
      scene.closestHits(rays, found, true);
      for (int i = 0; i < 16; ++i)
        hits[std::size_t((y0 + part * 2 + i / 8) * kWidth + x0 + i % 8)] = found[std::size_t(i)];
    }
  });
}

void toHits(const RasterScene& scene, const RasterView& view, const LargeVector<std::uint32_t>& triangles,
            std::vector<Hit>& hits) {
  forEachTile([&](int x0, int y0) {
    std::array<Ray, 64> rays;
    std::array<std::uint32_t, 64> ids;
    for (int i = 0; i < 64; ++i) {
      rays[std::size_t(i)] = rasterRay(view, x0 + i % 8, y0 + i / 8);
      ids[std::size_t(i)] = triangles[std::size_t((y0 + i / 8) * kWidth + x0 + i % 8)];
    }
    std::array<Hit, 64> found;
    scene.hits(rays, ids, found);
    for (int i = 0; i < 64; ++i)
      hits[std::size_t((y0 + i / 8) * kWidth + x0 + i % 8)] = found[std::size_t(i)];
  });
}

void measure(benchmark::State& state, const Scene& scene) {
  const TraceScene traceScene(scene);
  const RasterScene rasterScene(traceScene);
  const RasterView view{cameraRays(scene.cameras.front(), kWidth, kHeight), kWidth, kHeight};
  Rasteriser rasteriser;
  LargeVector<std::uint32_t> triangles;
  LargeVector<float> depths;
  std::vector<Hit> hits(std::size_t(kWidth) * kHeight);

  Times raster, depthsAlone, toHitsTimes, embree;
  std::vector<double> ratios, hitRatios;
  tbb::task_arena arena(int(state.range(0)));
  arena.execute([&] {
    for (auto _ : state) {
      raster.measure([&] { rasteriser.run(rasterScene, view, {&triangles, nullptr}); });
      depthsAlone.measure([&] { rasteriser.run(rasterScene, view, {nullptr, &depths}); });
      toHitsTimes.measure([&] { toHits(rasterScene, view, triangles, hits); });
      embree.measure([&] { trace(traceScene, view, hits); });
      const double rastered = raster.processor.back(), traced = embree.processor.back();
      ratios.push_back(traced / rastered);
      hitRatios.push_back(traced / (rastered + toHitsTimes.processor.back()));
    }
  });
  const auto count = [&](const std::string& name, const Times& times) {
    state.counters[name + "Ms"] = 1e3 * median(times.processor);
    state.counters[name + "Wall"] = 1e3 * times.shortest;
  };
  count("raster", raster);
  count("depths", depthsAlone);
  count("hits", toHitsTimes);
  count("embree", embree);
  state.counters["ofEmbree"] = median(ratios);
  state.counters["hitsOfEmbree"] = median(hitRatios);
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

/// A public scene from the folder that ISOPHOTE_ASSETS names.
void asset(benchmark::State& state, const char* name, vec3 eye, vec3 target) {
  const char* folder = std::getenv("ISOPHOTE_ASSETS");
  if (!folder) {
    state.SkipWithError("set ISOPHOTE_ASSETS to the folder of the public scenes");
    return;
  }
  Scene scene = loadScene((std::filesystem::path(folder) / name).string());
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.verticalFovDegrees = 60;
  scene.cameras = {camera};
  measure(state, scene);
}

BENCHMARK_CAPTURE(builtin, raster / cornell_box, "cornell-box")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(builtin, raster / atrium, "atrium")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(asset, raster / sponza_dabrovic, "sponza-dabrovic/sponza.obj", vec3(13.5f, 2.2f, 0),
                  vec3(-4, 4, 0))
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(asset, raster / sponza_crytek, "sponza-crytek/sponza.gltf", vec3(8.5f, 1.6f, -0.3f),
                  vec3(-2, 2.6f, -0.3f))
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isophote

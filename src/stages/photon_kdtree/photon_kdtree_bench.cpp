// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Searches in our kd-tree and in nanoflann's on the same photons (200 k stored) and the same queries, the
// view samples of a picture in their order: the k nearest, and all within a radius. `ofNanoflann` is our time
// over nanoflann's. Both are timed by the processor time of one thread, in turns within each iteration: what
// else the machine does weighs little, and on both.
#include "scene/scene.h"
#include "stages/gbuffer/gbuffer.h"
#include "stages/photon_kdtree/nearest_search.h"
#include "stages/photon_trace/photon_trace.h"

#include <benchmark/benchmark.h>
#include <time.h>
#include <nanoflann.hpp>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace isophote {
namespace {

double secondsOf(auto&& work) {
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

/// What both search, and what they are asked.
struct Input {
  std::vector<vec3> points, queries;
  float radius = 0;  ///< Of the automatic choice: 150 photons or so.
};

Input inputOf(const Scene& scene) {
  const TraceScene trace(scene);
  Stats stats;
  PhotonMap map;
  PhotonTraceSettings settings;
  settings.photonsStored = 200'000;
  PhotonTrace(settings).run({trace, 1, 0, 3, {}}, map, stats);
  Input input;
  for (const Photon& photon : map.photons) input.points.push_back(photon.position);
  input.radius = automaticRadius(map, 150.0f);
  constexpr int kWidth = 320, kHeight = 180;
  ViewSamples view;
  Gbuffer({}).run(
      {trace, cameraRays(scene.cameras.front(), kWidth, kHeight), kWidth, kHeight, vec2(0.5f), 1, 0, false},
      view, stats);
  for (const ViewTile& tile : view.tiles)
    for (int lane = 0; lane < kTileLanes; ++lane)
      if (tile.pixel[lane] != kNoPixel) input.queries.push_back(positionOf(tile, lane));
  return input;
}

/// How nanoflann sees points.
struct Cloud {
  const std::vector<vec3>& points;
  // NOLINTBEGIN(readability-identifier-naming): nanoflann's names.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][int(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  // NOLINTEND(readability-identifier-naming)
};
using Nanoflann =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

/// Runs both on all queries and checks that they agree.
void compare(benchmark::State& state, std::size_t queries, auto&& ours, auto&& theirs) {
  double oursSeconds = 0, theirsSeconds = 0;
  std::uint64_t found = 0, foundByThem = 0;
  for (auto _ : state) {
    oursSeconds += secondsOf([&] { found = ours(); });
    theirsSeconds += secondsOf([&] { foundByThem = theirs(); });
  }
  // Points at the very edge may be rounded to either side.
  if (found > foundByThem + queries / 100 || foundByThem > found + queries / 100)
    state.SkipWithError("nanoflann finds other points");
  const double perQuery = 1e9 / (double(queries) * double(state.iterations()));
  state.counters["found"] = double(found) / double(queries);
  state.counters["nanoseconds"] = oursSeconds * perQuery;
  state.counters["nanoflannNanoseconds"] = theirsSeconds * perQuery;
  state.counters["ofNanoflann"] = oursSeconds / theirsSeconds;
}

/// Dabrovic's Sponza, from the folder that ISOPHOTE_ASSETS names, under one lamp.
std::optional<Scene> sponza() {
  const char* folder = std::getenv("ISOPHOTE_ASSETS");
  if (!folder) return std::nullopt;
  Scene scene = loadScene((std::filesystem::path(folder) / "sponza-dabrovic" / "sponza.obj").string());
  Light light{};
  light.type = kLightPoint;
  light.position = {0, 7, 0};
  light.colour = vec3(1500.0f / (4.0f * kPi));
  scene.lights = {light};
  Camera camera;
  camera.eye = {13.5f, 2.2f, 0};
  camera.target = {-4, 4, 0};
  camera.verticalFovDegrees = 60;
  scene.cameras = {camera};
  finishScene(scene, "sponza");
  return scene;
}

/// Traced once for all benchmarks of a scene.
const Input* inputOf(const std::string& scene) {
  static std::map<std::string, std::optional<Input>> inputs;
  if (!inputs.contains(scene)) {
    const std::optional<Scene> loaded = scene == "assetSponza" ? sponza() : loadScene(scene);
    inputs[scene] = loaded ? std::optional(inputOf(*loaded)) : std::nullopt;
  }
  return inputs[scene] ? &*inputs[scene] : nullptr;
}

/// `nearest` 0: all within the radius.
void searches(benchmark::State& state, const std::string& scene, std::size_t nearest) {
  const Input* const traced = inputOf(scene);
  if (!traced) {
    state.SkipWithError("set ISOPHOTE_ASSETS to the folder of the public scenes");
    return;
  }
  const Input& input = *traced;
  Kdtree tree;
  tree.build(input.points);
  const Cloud cloud{input.points};
  Nanoflann nano(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(std::size_t(state.range(0))));
  nano.buildIndex();
  const float radius2 = input.radius * input.radius;
  NearestSearch search(tree);
  if (nearest > 0) {
    std::vector<std::uint32_t> indices(nearest);
    std::vector<float> distances(nearest);
    compare(
        state, input.queries.size(),
        [&] {
          std::uint64_t found = 0;
          for (const vec3 query : input.queries)
            found += search.nearest(query, nearest, 1e30f, [](std::uint32_t) { return true; }).size();
          return found;
        },
        [&] {
          std::uint64_t found = 0;
          for (const vec3 query : input.queries)
            found += nano.knnSearch(&query.x, nearest, indices.data(), distances.data());
          return found;
        });
  } else {
    std::vector<std::pair<std::uint32_t, float>> matches;
    const nanoflann::SearchParams unsorted(32, 0.0f, false);
    compare(
        state, input.queries.size(),
        [&] {
          std::uint64_t found = 0;
          for (const vec3 query : input.queries) found += search.within(query, radius2).size();
          return found;
        },
        [&] {
          std::uint64_t found = 0;
          for (const vec3 query : input.queries)
            found += nano.radiusSearch(&query.x, radius2, matches, unsorted);
          return found;
        });
  }
}

[[maybe_unused]] const bool registered = [] {
  for (const char* const scene : {"atrium", "assetSponza"})
    for (const std::size_t nearest : {10u, 50u, 100u, 500u, 0u}) {
      const std::string query = nearest > 0 ? "nearest" + std::to_string(nearest) : "radius";
      benchmark::RegisterBenchmark(("photon_kdtree/" + query + "/" + scene).c_str(), searches, scene, nearest)
          ->Arg(10)  // Points in a leaf of nanoflann's.
          ->Arg(32)
          ->Unit(benchmark::kMillisecond);
    }
  return true;
}();

}  // namespace
}  // namespace isophote

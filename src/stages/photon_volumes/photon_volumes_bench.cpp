// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Pairs of a photon and a view sample per second: the two loops at each instruction set beside the same loop
// kept scalar, then the stage as a whole. A loop below 4 times its twin has lost its vectorisation.
#include "stages/photon_volumes/photon_volumes.h"

#include "stages/photon_volumes/estimate.h"
#include "stages/photon_volumes/test_view.h"
#include "stages/photon_volumes/volumes.h"

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <numeric>

namespace isophote {
namespace {

using namespace photon_volumes;
using namespace photon_volumes_test;

#define ISOPHOTE_SCALAR __attribute__((optimize("no-tree-vectorize")))

ISOPHOTE_SCALAR void lambertianTwin(const ViewTile& tile, const PhotonVolume* volumes,
                                    const std::uint32_t* list, std::uint32_t count, uint kernel,
                                    RadianceTile& sums, PairCounts& counts) {
  photon_estimate::estimateLambertianBody<photon_estimate::WithinEllipsoid>(tile, volumes, list, count,
                                                                            kernel, kTileLanes, sums, counts);
}

ISOPHOTE_SCALAR void glossyTwin(const ViewTile& tile, const PhotonVolume* volumes, const std::uint32_t* list,
                                std::uint32_t count, uint kernel, RadianceTile& sums, PairCounts& counts) {
  photon_estimate::estimateGlossyBody<photon_estimate::WithinEllipsoid>(tile, volumes, list, count, kernel,
                                                                        kTileLanes, sums, counts);
}

/// One tile and photons of which about half are felt at each of its lanes, as on real lists; 256 KiB of
/// volumes, as in a part of a block.
struct LoopInput {
  ViewSamples view = makeView({.width = 64, .height = 64});
  std::vector<PhotonVolume> volumes;
  std::vector<std::uint32_t> list;
  const ViewTile* tile = nullptr;

  explicit LoopInput(bool lambertian) {
    // The middle of the view shows the far wall alone.
    const std::size_t middle = std::size_t(view.tilesY / 2 * view.tilesX + view.tilesX / 2);
    for (std::size_t i = middle; !tile; ++i)
      if ((view.tiles[i].lambertian != 0) == lambertian) tile = &view.tiles[i];
    PhotonMap map = makePhotons(4096);
    const vec3 centre = tile->bounds.centre();
    const vec3 normal(tile->ngX[0], tile->ngY[0], tile->ngZ[0]);
    const mat3 frame = basisAround(normal);
    for (std::uint32_t i = 0; i < map.photons.size(); ++i) {
      Photon& p = map.photons[i];
      const vec3 u = random3(4, i, 0);
      const vec2 disc = sampleDisc(vec2(u.x, u.y)) * (tile->bounds.radius() * 1.8f);
      p.position = centre + frame * vec3(disc.x, disc.y, 0.0f);
      p.pathDensity = PhotonVolumesSettings{}.densityReference;
      p.normal = packDirection(normal);
      p.direction = packDirection(frame * sampleCosineHemisphere(vec2(u.z, random3(4, i, 1).x)));
    }
    makeVolumes(map, tile->bounds.radius() * 1.3f, {}, volumes);
    list.resize(volumes.size());
    std::iota(list.begin(), list.end(), 0u);
  }
};

void loop(benchmark::State& state, bool lambertian, EstimateFn estimate) {
  const LoopInput in(lambertian);
  RadianceTile sums{};
  PairCounts counts;
  for (auto _ : state) {
    for (std::uint32_t i = 0; i < in.list.size(); i += kPhotonsPerCall)
      estimate(*in.tile, in.volumes.data(), in.list.data() + i, kPhotonsPerCall, kKernelEpanechnikov, sums,
               counts);
    benchmark::DoNotOptimize(sums);
  }
  const double pairs = double(state.iterations()) * double(in.list.size()) * kTileLanes;
  state.counters["pairs/s"] = benchmark::Counter(pairs, benchmark::Counter::kIsRate);
  state.counters["contributing"] = double(counts.contributing) / pairs;
}

void stage(benchmark::State& state, bool lambertian) {
  const ViewSamples view = makeView({.width = 1920, .height = 1080, .lambertian = lambertian});
  const PhotonMap map = makePhotons(20'000);
  PhotonVolumes volumes{PhotonVolumesSettings{}};
  Radiance out;
  tbb::task_arena arena(int(state.range(0)));
  for (auto _ : state) {
    Stats stats;
    arena.execute([&] { volumes.run({view, map, 0.1f}, out, stats); });
    benchmark::DoNotOptimize(out.data());
    state.counters["pairs/s"] = benchmark::Counter(stats.counter("photon_volumes.pairsTested"),
                                                   benchmark::Counter::kIsIterationInvariantRate);
    state.counters["contributing"] =
        stats.counter("photon_volumes.pairsContributing") / stats.counter("photon_volumes.pairsTested");
  }
}

[[maybe_unused]] const bool registered = [] {
  for (const bool lambertian : {true, false}) {
    const std::string kind = lambertian ? "lambertian" : "glossy";
    const EstimateFn twin = lambertian ? lambertianTwin : glossyTwin;
    benchmark::RegisterBenchmark(("photon_volumes/loop/" + kind + "/scalar").c_str(), loop, lambertian, twin);
    for (const SimdLevel level : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512})
      if (level <= bestSimdLevel())
        benchmark::RegisterBenchmark(("photon_volumes/loop/" + kind + "/" + std::string(name(level))).c_str(),
                                     loop, lambertian, estimateFor(lambertian, level));
    benchmark::RegisterBenchmark(("photon_volumes/stage/1080p/" + kind).c_str(), stage, lambertian)
        ->ArgName("threads")
        ->Arg(1)
        ->Arg(2)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace isophote

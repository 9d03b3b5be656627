// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of the estimators by photons of one radius share: photon_volumes with spheres and a constant
// kernel, which its own tests hold against every pair, is the answer.
#pragma once

#include "base/error.h"
#include "stages/photon_estimate/photon_sphere.shared.h"
#include "stages/photon_volumes/photon_volumes.h"
#include "stages/photon_volumes/test_view.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <string>

namespace isophote::sphere_tests {

using namespace photon_volumes_test;

struct Rendered {
  Radiance radiance;
  Stats stats;
};

template <class Stage>
Rendered render(Stage stage, const ViewSamples& view, const PhotonMap& map, float radius,
                SimdLevel simd = bestSimdLevel(), const Job& job = {}) {
  Rendered out;
  stage.run({view, map, radius, simd}, out.radiance, out.stats, job);
  return out;
}

inline Rendered expected(const ViewSamples& view, const PhotonMap& map, float radius) {
  PhotonVolumesSettings settings;
  settings.radiusMin = settings.radiusMax = settings.flatness = 1.0f;
  settings.kernel = Kernel::kConstant;
  return render(PhotonVolumes(settings), view, map, radius);
}

inline bool sameBytes(const Radiance& a, const Radiance& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(RadianceTile)) == 0;
}

/// The same light at every view sample up to the rounding of sums of `photons` positive terms in another
/// order; returns the share of samples that are lit.
inline double expectSameLight(const ViewSamples& view, const Radiance& got, const Radiance& want,
                              std::size_t photons) {
  EXPECT_EQ(got.size(), want.size());
  const double tolerance = 2.0 * (double(photons) + 16) * 0x1p-24;
  int wrong = 0, lit = 0, samples = 0;
  for (std::size_t i = 0; i < view.tiles.size(); ++i)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (view.tiles[i].pixel[lane] == kNoPixel) continue;
      ++samples;
      lit += want[i].g[lane] > 0.0f;
      for (const auto channel : {&RadianceTile::r, &RadianceTile::g, &RadianceTile::b}) {
        const double w = double((want[i].*channel)[lane]);
        if (!(std::abs(double((got[i].*channel)[lane]) - w) <= tolerance * w)) ++wrong;
      }
    }
  EXPECT_EQ(wrong, 0);
  return double(lit) / double(samples);
}

template <class MakeStage>
void expectMatchesVolumesWhereverTheEyeIs(MakeStage&& make, const char* pairsContributing) {
  const PhotonMap map = makePhotons(3000);
  const ViewOptions views[] = {
      {.secondaryTiles = 70},
      {.lambertian = true, .bentNormals = false},
      {.width = 40, .height = 30, .eye = {0.0f, -0.999f, 0.0f}, .forward = {1, 0.1f, 0.2f}},
      {.width = 40, .height = 30, .eye = {0.9f, 0.9f, 0.9f}, .forward = {-1, -1, -1}, .secondaryTiles = 3},
      {.width = 90, .height = 70, .eye = {0, 0, 0.5f}, .orthographic = 1},
      {.width = 7, .height = 3},
      {.width = 600, .height = 9, .secondaryTiles = 40, .lambertian = true}};
  for (const ViewOptions& options : views)
    for (const float radius : {0.05f, 0.3f, 1.5f}) {
      const ViewSamples view = makeView(options);
      const Rendered want = expected(view, map, radius);
      const Rendered got = render(make(), view, map, radius);
      EXPECT_GT(expectSameLight(view, got.radiance, want.radiance, map.photons.size()), 0.3);
      EXPECT_EQ(got.stats.counter(pairsContributing), want.stats.counter("photon_volumes.pairsContributing"));
    }
}

template <class MakeStage>
void expectSameBytesWithAnyNumberOfThreads(MakeStage&& make) {
  const ViewSamples view = makeView({.width = 200, .height = 100, .secondaryTiles = 130});
  const PhotonMap map = makePhotons(20'000);
  // More threads than this machine may have processors.
  const tbb::global_control threadLimit(tbb::global_control::max_allowed_parallelism, 8);
  Radiance one;
  tbb::task_arena(1).execute([&] { one = render(make(), view, map, 0.12f).radiance; });
  for (const int threads : {2, 8}) {
    Radiance many;
    tbb::task_arena(threads).execute([&] { many = render(make(), view, map, 0.12f).radiance; });
    EXPECT_TRUE(sameBytes(one, many)) << threads << " threads";
  }
}

template <class MakeStage>
void expectSameBytesOfEveryInstructionSet(MakeStage&& make) {
  const ViewSamples view = makeView({.secondaryTiles = 5});
  const ViewSamples flat = makeView({.lambertian = true, .bentNormals = false});
  const PhotonMap map = makePhotons(3000);
  for (const ViewSamples* v : {&view, &flat}) {
    const Radiance baseline = render(make(), *v, map, 0.2f, SimdLevel::kBaseline).radiance;
    for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512})
      if (level <= bestSimdLevel()) {
        EXPECT_TRUE(sameBytes(render(make(), *v, map, 0.2f, level).radiance, baseline)) << name(level);
      }
  }
}

template <class MakeStage>
void expectSamePictureWithinASmallMemoryBudget(MakeStage&& make, const char* subPasses) {
  const ViewSamples view = makeView({.secondaryTiles = 70});
  const PhotonMap map = makePhotons(3000);
  const Rendered whole = render(make(), view, map, 0.2f);
  EXPECT_EQ(whole.stats.counter(subPasses), 1);
  Job job;
  job.memoryBudgetBytes = std::uint64_t(1) << 14;  // Neither the photons' spheres nor their lists fit.
  const Rendered parts = render(make(), view, map, 0.2f, bestSimdLevel(), job);
  EXPECT_GE(parts.stats.counter(subPasses), 3);
  const std::string stage = std::string(subPasses).substr(0, std::string_view(subPasses).find('.'));
  const auto spheres = nlohmann::json::parse(parts.stats.toJson())["bytes"][stage + ".photons"];
  EXPECT_LT(spheres.get<std::size_t>(), map.photons.size() * sizeof(PhotonSphere) / 2);
  expectSameLight(view, parts.radiance, whole.radiance, map.photons.size());
}

template <class MakeStage>
void expectASecondRunOverwritesTheFirst(MakeStage&& make) {
  auto stage = make();
  const ViewSamples view = makeView({.secondaryTiles = 7});
  const ViewSamples small = makeView({.width = 20, .height = 9, .seed = 5});
  const PhotonMap map = makePhotons(1000);
  Radiance out;
  Stats stats;
  stage.run({view, map, 0.2f}, out, stats);
  const Radiance first = out;
  stage.run({small, map, 0.2f}, out, stats);
  EXPECT_TRUE(sameBytes(out, render(make(), small, map, 0.2f).radiance));
  stage.run({view, map, 0.2f}, out, stats);
  EXPECT_TRUE(sameBytes(out, first));
  stage.run({view, PhotonMap{}, 0.0f}, out, stats);
  EXPECT_TRUE(sameBytes(out, Radiance(view.tiles.size())));
  stage.run({ViewSamples{}, map, 0.2f}, out, stats);
  EXPECT_TRUE(out.empty());
}

template <class MakeStage>
void expectStopsAndRefusesARadiusOfZero(MakeStage&& make) {
  const ViewSamples view = makeView({});
  const PhotonMap map = makePhotons(100);
  std::stop_source source;
  source.request_stop();
  Job job;
  job.stop = source.get_token();
  EXPECT_THROW(render(make(), view, map, 0.2f, bestSimdLevel(), job), Error);
  EXPECT_THROW(render(make(), view, map, 0.0f), Error);
}

}  // namespace isophote::sphere_tests

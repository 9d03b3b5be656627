// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// --preset igpm, and photon differentials together with what else a frame can do.
#include "base/error.h"
#include "image/compare.h"
#include "render/cpu_frame.h"
#include "render/cpu_renderer.h"
#include "support/images.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstring>
#include <string>

namespace isophote {
namespace {

RenderSettings small() {
  RenderSettings settings = presetSettings("igpm");
  settings.frame.width = 120;
  settings.frame.height = 90;
  settings.photonTrace.photons = 20'000;
  settings.direct.areaSamples = 1;
  return settings;
}

Film rendered(const TraceScene& trace, const RenderSettings& settings, Stats& stats) {
  return renderCpu(trace, trace.scene().cameras.front(), settings, stats);
}

double meanOfIndirect(const Film& film) {
  double sum = 0;
  for (const vec3 p : film.layers.at("indirect").pixels) sum += double(meanOf(p));
  return sum / double(film.layers.at("indirect").pixels.size());
}

TEST(Igpm, ThePresetIsThePapersSystem) {
  const RenderSettings settings = presetSettings("igpm");
  EXPECT_EQ(settings.frame.estimator, Estimator::kBvh);
  EXPECT_EQ(settings.frame.bounces, 2u);
  EXPECT_EQ(settings.photonBvh.radiusMax, 0.7f);
  EXPECT_EQ(settings.photonBvh.smoothingCaustic, 5.0f);
  EXPECT_EQ(settings.photonBvh.split, PhotonSplit::kMorton);
}

TEST(Igpm, TheSameBytesWithAnyThreads) {
  const Scene scene = loadScene("cornell-objects");
  const TraceScene trace(scene);
  Film one;
  for (const int threads : {1, 4}) {
    tbb::global_control allow(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    tbb::task_arena arena(threads);
    Stats stats;
    const Film film = arena.execute([&] { return rendered(trace, small(), stats); });
    if (threads == 1) one = film;
    ASSERT_EQ(film.colour.pixels.size(), one.colour.pixels.size());
    EXPECT_EQ(std::memcmp(film.colour.pixels.data(), one.colour.pixels.data(),
                          one.colour.pixels.size() * sizeof(vec3)),
              0);
  }
}

/// What is seen in mirrors and through glass is estimated as well.
TEST(Igpm, LightsWhatIsSeenInMirrorsAndThroughGlass) {
  const Scene scene = loadScene("cornell-objects");
  const TraceScene trace(scene);
  RenderSettings settings = small();
  settings.photonTrace.photons = 100'000;
  Stats stats;
  const Film bvh = rendered(trace, settings, stats);
  settings.frame.estimator = Estimator::kVolumes;
  const Film volumes = rendered(trace, settings, stats);
  EXPECT_GE(compareImages(bvh.layers.at("indirect"), volumes.layers.at("indirect")).psnr, 25.0)
      << writeFailure(bvh.layers.at("indirect"), volumes.layers.at("indirect"));
}

TEST(Igpm, GoesWithSubsamplingAndSeveralSamplesAPixel) {
  const Scene scene = loadScene("cornell-box");
  const TraceScene trace(scene);
  RenderSettings settings = small();
  Stats stats;
  const double full = meanOfIndirect(rendered(trace, settings, stats));
  settings.frame.subsample = 4;
  EXPECT_NEAR(meanOfIndirect(rendered(trace, settings, stats)), full, 0.02 * full);
  settings.frame.aa = 3;
  EXPECT_NEAR(meanOfIndirect(rendered(trace, settings, stats)), full, 0.03 * full);
}

TEST(Igpm, GoesWithPhotonsStoredAndCulling) {
  const Scene scene = loadScene("cornell-box");
  const TraceScene trace(scene);
  RenderSettings settings = small();
  Stats stats;
  const double full = meanOfIndirect(rendered(trace, settings, stats));
  settings.photonTrace.photonsStored = 12'000;
  EXPECT_NEAR(meanOfIndirect(rendered(trace, settings, stats)), full, 0.05 * full);
  settings.photonTrace.photonsStored = 0;
  settings.cull.photons = 4.0f;  // Three of four go, those that stay stand for them.
  EXPECT_NEAR(meanOfIndirect(rendered(trace, settings, stats)), full, 0.05 * full);
  EXPECT_LT(stats.counter("cull.photonsKept"), 0.5 * stats.counter("photonsStored"));
}

TEST(Igpm, CountsPhotonsInTheLayerOfTheirDensity) {
  const Scene scene = loadScene("furnace-box");
  const TraceScene trace(scene);
  RenderSettings settings = small();
  settings.frame.densityLayer = true;
  settings.photonTrace.photons = 50'000;
  Stats stats;
  const Film film = rendered(trace, settings, stats);
  // Evenly lit: the middle of a wall has as many photons as the room has on average.
  const vec3 size = scene.bounds.size();
  const double area = 2.0 * double(size.x * size.y + size.y * size.z + size.z * size.x);
  EXPECT_NEAR(double(film.layers.at("density").at(60, 45).x), stats.counter("photonsStored") / area,
              0.2 * stats.counter("photonsStored") / area);
}

TEST(Igpm, SmoothingSetsTheSizeOfFootprints) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  RenderSettings settings = small();
  settings.photonBvh.radiusMax = 0;
  std::array<double, 2> radius{}, pairs{};
  for (int i = 0; i < 2; ++i) {
    settings.photonBvh.smoothing = i == 0 ? 5.0f : 10.0f;
    Stats stats;
    rendered(trace, settings, stats);
    radius[std::size_t(i)] = stats.counter("radiusMetres");
    pairs[std::size_t(i)] = stats.counter("photon_bvh.pairsContributing");
    EXPECT_NEAR(stats.counter("photon_bvh.smoothing"), settings.photonBvh.smoothing, 1e-3);
  }
  EXPECT_NEAR(radius[1], 2 * radius[0], 1e-3 * radius[1]);
  EXPECT_GT(pairs[1], 2.5 * pairs[0]);
}

TEST(Igpm, RefusesPhotonsOfBounceMaps) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  RenderSettings settings = small();
  settings.frame.firstBounce = FirstBounce::kMap;
  Stats stats;
  try {
    rendered(trace, settings, stats);
    ADD_FAILURE() << "took them";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadUsage);
    EXPECT_NE(std::string(e.what()).find("frame.firstBounce=traced"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace isophote

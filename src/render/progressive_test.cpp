// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/progressive.h"

#include "base/error.h"
#include "image/compare.h"
#include "image/exr.h"
#include "image/files.h"
#include "render/checkpoint.h"
#include "render/cpu_frame.h"
#include "render/reference.h"
#include "scene/builtin/builtin.h"
#include "support/files.h"
#include "support/statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>

namespace isophote {
namespace {

RenderSettings smallSettings(std::uint32_t photons = 3000) {
  RenderSettings settings;
  settings.frame.width = 48;
  settings.frame.height = 36;
  settings.photonTrace.photons = photons;
  return settings;
}

Film passesOf(const TraceScene& trace, const RenderSettings& settings, std::uint32_t passes) {
  ProgressiveRenderer renderer(trace, settings);
  Stats stats;
  for (std::uint32_t i = 0; i < passes; ++i) renderer.addPass(trace.scene().cameras.front(), stats);
  return renderer.film();
}

TEST(Progressive, RadiiFollowTheirRecurrence) {
  EXPECT_FLOAT_EQ(progressiveRadius(0), 1.0f);
  for (const std::uint32_t pass : {0u, 1u, 10u, 1000u, 100'000u}) {
    const double ratio = double(progressiveRadius(pass + 1)) / double(progressiveRadius(pass));
    const double i = double(pass) + 1.0;
    EXPECT_NEAR(ratio * ratio, (i + 2.0 / 3.0) / (i + 1.0), 1e-5) << pass;
  }
}

/// Of pictures of two passes: the second of its own radius.
void expectTheMeanOfPasses(RenderSettings settings) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  settings.photonVolumes.radius = settings.photonBvh.radius = 0.2f;
  CpuRenderer one(trace, settings);
  Film first, second;
  Stats stats;
  EXPECT_EQ(one.renderPass(scene.cameras.front(), {0, 0.0f}, first, stats), 0.2f);
  const float radius = 0.2f * settings.frame.passRadius * progressiveRadius(1);
  one.renderPass(scene.cameras.front(), {1, radius}, second, stats);
  const Film mean = passesOf(trace, settings, 2);
  for (std::size_t i = 0; i < mean.colour.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(mean.colour.pixels[i][k], 0.5f * (first.colour.pixels[i][k] + second.colour.pixels[i][k]),
                  1e-5f * (1.0f + mean.colour.pixels[i][k]));
  EXPECT_EQ(mean.layers.size(), first.layers.size());
}

TEST(Progressive, IsTheMeanOfItsPasses) { expectTheMeanOfPasses(smallSettings()); }

TEST(Progressive, PassesAfterTheFirstHaveRadiiOfTheirOwn) {
  RenderSettings settings = smallSettings();
  settings.frame.passRadius = 0.5f;
  for (const Estimator estimator : {Estimator::kVolumes, Estimator::kBvh}) {
    settings.frame.estimator = estimator;
    expectTheMeanOfPasses(settings);
  }
}

/// Footprints have lengths that their middle radius does not scale.
TEST(Progressive, AllOfAFootprintIsOfThePassRadius) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  RenderSettings half = smallSettings();
  half.frame.estimator = Estimator::kBvh;
  half.photonBvh = {.radius = 0.2f, .radiusMin = 0.1f, .radiusMax = 0.4f};
  half.frame.passRadius = 0.5f;
  RenderSettings set = half;
  set.frame.passRadius = 1;
  set.photonBvh = {.radius = 0.1f, .smoothingCaustic = 5.0f, .radiusMin = 0.05f, .radiusMax = 0.2f};
  const float radius = 0.1f * progressiveRadius(1);
  Film byPass, bySetting;
  Stats stats;
  CpuRenderer(trace, half).renderPass(scene.cameras.front(), {1, radius}, byPass, stats);
  CpuRenderer(trace, set).renderPass(scene.cameras.front(), {1, radius}, bySetting, stats);
  EXPECT_LT(compareImages(byPass.colour, bySetting.colour).relMse, 1e-8);
}

TEST(Progressive, SparsePassesKeepTheSubsampling) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  RenderSettings settings = smallSettings();
  settings.photonVolumes.radius = 0.2f;
  settings.frame.subsample = 4;
  settings.frame.sparsePasses = 3;
  const Film mean = passesOf(trace, settings, 4);
  std::vector<vec3> sum(mean.colour.pixels.size(), vec3(0.0f));
  for (std::uint32_t pass = 0; pass < 4; ++pass) {
    RenderSettings ofPass = settings;
    ofPass.frame.subsample = pass < 3 ? 4 : 1;
    Film film;
    Stats stats;
    CpuRenderer(trace, ofPass)
        .renderPass(scene.cameras.front(), {pass, 0.2f * progressiveRadius(pass)}, film, stats);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += 0.25f * film.colour.pixels[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i)
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(mean.colour.pixels[i][k], sum[i][k], 1e-5f * (1.0f + sum[i][k])) << i;
}

TEST(Progressive, ABrokenOffPictureGoesOnToTheSameBytes) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  const Camera& camera = scene.cameras.front();
  for (const char* preset : {"ispm", "jensen"}) {
    RenderSettings settings = presetSettings(preset);
    settings.frame.width = 48;
    settings.frame.height = 36;
    settings.photonTrace.photons = 3000;
    settings.frame.sparsePasses = 2;
    const std::vector<std::uint8_t> undisturbed = encodeExr(passesOf(trace, settings, 5));
    const TestFolder folder;
    const Checkpoint checkpoint(folder.path() / "passes.exr", scene, camera);
    EXPECT_FALSE(checkpoint.exists());
    Stats stats;
    {
      ProgressiveRenderer renderer(trace, settings);
      for (int i = 0; i < 2; ++i) renderer.addPass(camera, stats);
      checkpoint.save(renderer);
    }
    EXPECT_TRUE(checkpoint.exists());
    ProgressiveRenderer renderer(trace, settings);
    checkpoint.load(renderer, settings);
    EXPECT_EQ(renderer.passes(), 2u);
    tbb::task_arena(1).execute([&] {
      for (int i = 0; i < 3; ++i) renderer.addPass(camera, stats);
    });
    EXPECT_TRUE(encodeExr(renderer.film()) == undisturbed) << preset;
  }
}

TEST(Progressive, CheckpointsOfOtherPicturesAreRefused) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  const Camera& camera = scene.cameras.front();
  const RenderSettings settings = smallSettings();
  const TestFolder folder;
  const Checkpoint checkpoint(folder.path() / "passes.exr", scene, camera);
  Stats stats;
  ProgressiveRenderer renderer(trace, settings);
  renderer.addPass(camera, stats);
  checkpoint.save(renderer);
  const auto refusal = [&](const Checkpoint& from, const RenderSettings& now) -> std::string {
    try {
      ProgressiveRenderer fresh(trace, now);
      from.load(fresh, now);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  RenderSettings other = settings;
  other.frame.passes = 100;
  other.frame.seconds = 3;
  EXPECT_EQ(refusal(checkpoint, other), "");
  other.photonTrace.photons = 4000;
  EXPECT_THAT(refusal(checkpoint, other),
              testing::HasSubstr("photon_trace.photons is 3000 there and 4000 now"));
  Camera moved = camera;
  moved.eye.x += 0.1f;
  EXPECT_THAT(refusal(Checkpoint(folder.path() / "passes.exr", scene, moved), settings),
              testing::HasSubstr("another scene or camera"));
  writeFilm(folder.path() / "passes.exr", renderer.film());
  EXPECT_THAT(refusal(checkpoint, settings), testing::HasSubstr("is not a checkpoint"));
  EXPECT_THROW(Checkpoint("passes.png", scene, camera), Error);
}

TEST(Progressive, AStoppedPassLeavesThoseBefore) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  ProgressiveRenderer renderer(trace, smallSettings());
  Stats stats;
  renderer.addPass(scene.cameras.front(), stats);
  const std::vector<std::uint8_t> before = encodeExr(renderer.film());
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(renderer.addPass(scene.cameras.front(), stats, {.stop = stop.get_token()}), Error);
  EXPECT_EQ(renderer.passes(), 1u);
  EXPECT_TRUE(encodeExr(renderer.film()) == before);
}

TEST(Progressive, TimeEndsThePasses) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  Stats stats;
  ProgressiveRenderer once(trace, smallSettings());
  FrameSettings frame;
  frame.seconds = 1e-6f;
  addPasses(once, scene.cameras.front(), frame, stats);
  EXPECT_EQ(once.passes(), 1u);
  frame.seconds = 1000;
  frame.passes = 3;
  int calls = 0;
  ProgressiveRenderer thrice(trace, smallSettings());
  addPasses(thrice, scene.cameras.front(), frame, stats, {}, [&] { ++calls; });
  EXPECT_EQ(thrice.passes(), 3u);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(stats.counter("passes"), 3.0);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cpu_renderer.h"
#include "render/progressive.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

namespace isophote {
namespace {

RenderSettings smallSspm() {
  RenderSettings settings = presetSettings("sspm");
  settings.frame.width = 160;
  settings.frame.height = 120;
  settings.photonTrace.photons = 3000;
  return settings;
}

Image pictureOf(const Scene& scene, const RenderSettings& settings) {
  const TraceScene trace(scene);
  Film film;
  Stats stats;
  CpuRenderer(trace, settings).render(scene.cameras.front(), film, stats);
  return film.colour;
}

double rootMeanSquare(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const vec3 d = a.pixels[i] - b.pixels[i];
    sum += double(dot(d, d));
  }
  return std::sqrt(sum / double(a.pixels.size()));
}

TEST(Sspm, ThePresetIsTheThesissSystem) {
  const RenderSettings settings = presetSettings("sspm");
  EXPECT_EQ(settings.frame.firstBounce, FirstBounce::kMap);
  EXPECT_EQ(settings.frame.estimator, Estimator::kQuads);
  EXPECT_GT(settings.frame.subsample, 1u);
  EXPECT_TRUE(settings.upsample.merged);
  EXPECT_EQ(settings.direct.shadows, Shadows::kGathered);
  EXPECT_EQ(settings.direct.searchSamples, 16u);
  EXPECT_EQ(settings.direct.blurSamples, 25u);
}

/// In the pass of the shadows or in one of its own, upsampling gives the same bytes.
TEST(Sspm, MergedUpsamplingIsTheSamePicture) {
  for (const char* name : {"colour-bleed", "glass-sphere"}) {
    const Scene scene = loadScene(name);
    for (const Shadows shadows : {Shadows::kGathered, Shadows::kPcss, Shadows::kTraced}) {
      RenderSettings settings = smallSspm();
      settings.direct.shadows = shadows;
      const Image merged = pictureOf(scene, settings);
      settings.upsample.merged = false;
      EXPECT_EQ(rootMeanSquare(merged, pictureOf(scene, settings)), 0.0) << name;
    }
  }
}

TEST(Sspm, TheSameBytesWithAnyThreads) {
  const Scene scene = loadScene("colour-bleed");
  const Image many = pictureOf(scene, smallSspm());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(rootMeanSquare(many, pictureOf(scene, smallSspm())), 0.0);
}

/// Passes leave the approximations behind: direct light becomes that of rays to all of the lamp.
TEST(Sspm, PassesConvergeToTheLightOfAllOfTheLamp) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  RenderSettings settings = smallSspm();
  settings.frame.bounces = 0;
  settings.frame.aa = 1;
  settings.direct.lightRadius = 0.3f;
  settings.direct.blurRadius = 0.05f;
  RenderSettings truth = settings;
  truth.direct.shadows = Shadows::kArea;
  truth.direct.blurRadius = 0;
  truth.direct.areaSamples = 16;
  truth.frame.aa = 64;
  const Image expected = pictureOf(scene, truth);
  ProgressiveRenderer passes(trace, settings);
  Stats stats;
  std::vector<double> errors;
  for (int pass = 0; pass < 64; ++pass) {
    passes.addPass(scene.cameras.front(), stats);
    if (pass == 0 || pass == 63) errors.push_back(rootMeanSquare(passes.film().colour, expected));
  }
  EXPECT_LT(errors.back(), 0.25 * errors.front());
}

}  // namespace
}  // namespace isophote

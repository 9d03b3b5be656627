// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Upsampled pictures against those that estimate light at every pixel.
#include "image/compare.h"
#include "render/cpu_frame.h"
#include "support/files.h"
#include "support/images.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

namespace isophote {
namespace {

RenderSettings settingsFor(std::uint32_t width, std::uint32_t photons) {
  RenderSettings settings;
  settings.frame.width = width;
  settings.frame.height = width * 9 / 16;
  settings.photonTrace.photons = photons;
  return settings;
}

Image indirectLight(const TraceScene& trace, const Camera& camera, const RenderSettings& settings) {
  Stats stats;
  return renderCpu(trace, camera, settings, stats).layers.at("indirect");
}

double meanOf(const Image& image) {
  double sum = 0;
  for (const vec3& p : image.pixels) sum += double(p.x) + double(p.y) + double(p.z);
  return sum / (3.0 * double(image.pixels.size()));
}

/// ISPM's figure 12.
TEST(UpsampleAgreement, EachWeightBringsItCloserToTheFullPicture) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures bias, for which the sanitizers are too slow";
  const Scene scene = loadScene("atrium");
  const TraceScene trace(scene);
  RenderSettings settings = settingsFor(480, 50'000);
  const Image full = indirectLight(trace, scene.cameras.front(), settings);
  for (const std::uint32_t side : {4u, 16u}) {
    settings.frame.subsample = side;
    double before = 1e30;
    for (const UpsampleWeights weights : {UpsampleWeights::kNearest, UpsampleWeights::kBilinear,
                                          UpsampleWeights::kNormal, UpsampleWeights::kDepth}) {
      settings.upsample.weights = weights;
      const Image indirect = indirectLight(trace, scene.cameras.front(), settings);
      const Comparison c = compareImages(indirect, full);
      const char* called = EnumNames<UpsampleWeights>::names[std::size_t(weights)];
      std::printf("%u x %u, %s: relMse %.5f, PSNR %.2f dB, mean %.4f\n", side, side, called, c.relMse, c.psnr,
                  c.meanRatio);
      EXPECT_LT(c.relMse, before) << called << writeFailure(indirect, full);
      before = c.relMse;
      if (weights == UpsampleWeights::kDepth) {
        EXPECT_NEAR(c.meanRatio, 1.0, 0.005);
      }
    }
  }
}

/// The full picture's mean is held against the path tracer by Agreement; upsampling must keep it.
void expectMeanKept(const std::string& name) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures bias, for which the sanitizers are too slow";
  const std::filesystem::path own = std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "scenes" / name;
  const bool isPublic = own.extension() == ".json";
  if (isPublic && publicScenes().empty()) GTEST_SKIP() << "the public test scenes are not on this machine";
  SceneOptions options;
  options.assetFolders.push_back(publicScenes());
  const Scene scene = loadScene(isPublic ? own.string() : name, options);
  const TraceScene trace(scene);
  RenderSettings settings = settingsFor(640, 50'000);
  const double full = meanOf(indirectLight(trace, scene.cameras.front(), settings));
  for (const std::uint32_t side : {2u, 4u}) {
    settings.frame.subsample = side;
    const double ratio = meanOf(indirectLight(trace, scene.cameras.front(), settings)) / full;
    std::printf("%s, %u x %u: upsampled / full mean = %.4f\n", name.c_str(), side, side, ratio);
    EXPECT_NEAR(ratio, 1.0, 0.005) << side;
  }
}

TEST(UpsampleAgreement, KeepsTheMeanOfTheCornellBox) { expectMeanKept("cornell-box"); }
TEST(UpsampleAgreement, KeepsTheMeanOfGlossySurfaces) { expectMeanKept("caustic-ring"); }
TEST(UpsampleAgreement, KeepsTheMeanOfDabrovicsSponza) { expectMeanKept("sponza-dabrovic.json"); }

/// ISPM's photon volumes are clipped by the near plane and fade out as the viewer comes close; ours are found
/// in world space.
TEST(UpsampleAgreement, AWallStaysAsBrightAsTheCameraComesClose) {
  constexpr double kExact = 0.4375;  // Of three bounces in a room of albedo 1/2 that glows with radiance 1.
  constexpr std::uint32_t kSeeds = 6;
  const Scene scene = loadScene("furnace-box");
  const TraceScene trace(scene);
  const vec3 wall(scene.bounds.centre().x, scene.bounds.centre().y, scene.bounds.lower.z);
  Camera camera = scene.cameras.front();
  camera.target = wall;
  RenderSettings settings = settingsFor(96, 100'000);
  for (const float distance : {0.4f, 0.1f, 0.01f, 0.001f}) {
    camera.eye = wall + vec3(0, 0, distance * scene.bounds.size().z);
    double full = 0, upsampled = 0;
    for (settings.frame.seed = 0; settings.frame.seed < kSeeds; ++settings.frame.seed) {
      settings.frame.subsample = 1;
      full += meanOf(indirectLight(trace, camera, settings)) / kSeeds;
      settings.frame.subsample = 4;
      upsampled += meanOf(indirectLight(trace, camera, settings)) / kSeeds;
    }
    std::printf("at %g: %.4f, upsampled %.4f\n", double(distance), full, upsampled);
    EXPECT_NEAR(upsampled / full, 1.0, 0.005) << distance;
    // From close by, a picture shows no more than one estimate a seed, of about 100 photons.
    EXPECT_NEAR(full / kExact, 1.0, 4.0 / std::sqrt(100.0 * kSeeds)) << distance;
  }
}

}  // namespace
}  // namespace isophote

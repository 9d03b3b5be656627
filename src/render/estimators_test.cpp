// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Every estimator that feels photons within one radius gives the same picture: they differ in how they find
// the pairs of a photon and a view sample.
#include "image/compare.h"
#include "render/cpu_frame.h"
#include "support/files.h"
#include "support/images.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace isophote {
namespace {

/// Photons felt in a sphere of one radius, all alike: what tiles and clusters always do.
RenderSettings settingsFor(Estimator estimator, float radius) {
  RenderSettings settings;
  settings.frame.width = 200;
  settings.frame.height = 150;
  settings.frame.estimator = estimator;
  settings.photonTrace.photonsStored = 20'000;
  settings.direct.areaSamples = 1;
  settings.photonVolumes = {
      .radius = radius, .radiusMin = 1, .radiusMax = 1, .flatness = 1, .kernel = Kernel::kConstant};
  settings.photonKdtree = {.nearest = 0, .radius = radius};
  settings.photonTiles.radius = radius;
  settings.photonClusters = {.radius = radius, .cone = false, .trivial = TrivialAccept::kOff};
  return settings;
}

Image indirectLight(const TraceScene& trace, const RenderSettings& settings) {
  Stats stats;
  return renderCpu(trace, trace.scene().cameras.front(), settings, stats).layers.at("indirect");
}

void expectSamePictures(const Scene& scene, float radius, bool flat) {
  const TraceScene trace(scene);
  const Image expected = indirectLight(trace, settingsFor(Estimator::kVolumes, radius));
  const auto check = [&](const std::string& called, const RenderSettings& settings) {
    const Image got = indirectLight(trace, settings);
    const double psnr = compareImages(got, expected).psnr;
    EXPECT_TRUE(psnr >= 70.0) << called << ": " << psnr << " dB " << writeFailure(got, expected);
  };
  check("kdtree", settingsFor(Estimator::kKdtree, radius));
  check("tiles", settingsFor(Estimator::kTiles, radius));
  RenderSettings settings = settingsFor(Estimator::kClusters, radius);
  check("clusters", settings);
  settings.photonClusters.cone = true;
  check("clusters with cones", settings);
  settings.photonClusters.trivial = TrivialAccept::kFlat;
  check("clusters with trivial accept", settings);
  settings.photonClusters.trivial = TrivialAccept::kAll;
  if (flat) check("clusters with trivial accept everywhere", settings);
}

TEST(Estimators, GiveTheSamePictureOfACornellBox) {
  const Scene scene = loadScene("cornell-box");
  expectSamePictures(scene, 0.05f, true);
  expectSamePictures(scene, 0.4f, true);
}

// Mirrors, glass and glossy surfaces: secondary view samples and BSDFs that depend on the view.
TEST(Estimators, GiveTheSamePictureInMirrorsAndThroughGlass) {
  expectSamePictures(loadScene("cornell-objects"), 0.2f, false);
}

TEST(Estimators, GiveTheSamePictureOfDabrovicsSponza) {
  if (publicScenes().empty()) GTEST_SKIP() << "the public test scenes are not on this machine";
  SceneOptions options;
  options.assetFolders.push_back(publicScenes());
  const std::filesystem::path own =
      std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "scenes/sponza-dabrovic.json";
  expectSamePictures(loadScene(own.string(), options), 0.8f, false);
}

// One pixel a cell, and single pixels among the secondary samples.
TEST(Estimators, GiveTheSamePictureWithSubsampling) {
  const Scene scene = loadScene("cornell-objects");
  const TraceScene trace(scene);
  const auto subsampled = [&](Estimator estimator) {
    RenderSettings settings = settingsFor(estimator, 0.2f);
    settings.frame.width = 203;
    settings.frame.subsample = 4;
    return indirectLight(trace, settings);
  };
  const Image expected = subsampled(Estimator::kVolumes);
  for (const Estimator estimator : {Estimator::kTiles, Estimator::kClusters}) {
    const Image got = subsampled(estimator);
    EXPECT_TRUE(compareImages(got, expected).psnr >= 70.0) << writeFailure(got, expected);
  }
}

}  // namespace
}  // namespace isophote

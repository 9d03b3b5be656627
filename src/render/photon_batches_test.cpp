// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/photon_batches.h"

#include "base/error.h"
#include "render/cpu_frame.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isophote {
namespace {

RenderSettings settingsFor(Estimator estimator, std::uint32_t photons) {
  RenderSettings settings;
  settings.frame.width = 80;
  settings.frame.height = 60;
  settings.frame.estimator = estimator;
  settings.photonTrace.photons = photons;
  settings.photonKdtree.nearest = 0;
  return settings;
}

/// A budget in which the photons take so many batches.
Job budgetOf(std::uint32_t batches, const RenderSettings& settings) {
  Job job;
  const std::uint64_t bytes =
      2 * sizeof(Photon) * settings.frame.bounces * std::uint64_t(settings.photonTrace.photons);
  job.memoryBudgetBytes = 4 * ((bytes + batches - 1) / batches);
  EXPECT_EQ(photonBatches(settings, job.memoryBudgetBytes), batches);
  return job;
}

/// Largest relative difference of two pictures' pixels; dark ones against a hundredth of the mean.
double largestDifference(const Image& a, const Image& b) {
  double mean = 0, largest = 0;
  for (const vec3& pixel : b.pixels) mean += double(meanOf(pixel)) / double(b.pixels.size());
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const vec3 difference = abs(a.pixels[i] - b.pixels[i]);
    largest = std::max(largest, double(meanOf(difference)) / (double(meanOf(b.pixels[i])) + 0.01 * mean));
  }
  return largest;
}

class PhotonBatches : public testing::TestWithParam<Estimator> {};

// A million photons, so that sums of many terms are compared: they round in another order.
TEST_P(PhotonBatches, GiveThePictureOfOneBatch) {
  const Scene scene = loadScene("cornell-objects");
  const TraceScene trace(scene);
  RenderSettings settings = settingsFor(GetParam(), testSamples(1'000'000));
  for (float* radius :
       {&settings.photonVolumes.radius, &settings.photonKdtree.radius, &settings.photonTiles.radius,
        &settings.photonClusters.radius, &settings.photonQuads.radius})
    *radius = 0.02f;
  Stats one, ten;
  const Camera& camera = scene.cameras.front();
  const Film whole = renderCpu(trace, camera, settings, one);
  const Film parts = renderCpu(trace, camera, settings, ten, budgetOf(10, settings));
  EXPECT_LT(largestDifference(parts.colour, whole.colour), 1e-4);
  EXPECT_EQ(parts.metadata, whole.metadata);
  for (const char* counter : {"photonsEmitted", "photonsStored", "radiusMetres"})
    EXPECT_EQ(ten.counter(counter), one.counter(counter)) << counter;
}

INSTANTIATE_TEST_SUITE_P(Estimators, PhotonBatches,
                         testing::Values(Estimator::kVolumes, Estimator::kKdtree, Estimator::kTiles,
                                         Estimator::kClusters, Estimator::kQuads),
                         [](const auto& parameter) {
                           return std::string(EnumNames<Estimator>::names[std::size_t(parameter.param)]);
                         });

// Subpixels, sparse samples and lights of unequal shares: 99,991 photons divide into batches by none.
TEST(PhotonBatches, GoWithEverythingElseOfAFrame) {
  const Scene scene = loadScene("two-rooms");
  const TraceScene trace(scene);
  RenderSettings settings = settingsFor(Estimator::kClusters, 99'991);
  settings.frame.aa = 2;
  settings.frame.subsample = 4;
  Stats one, seven;
  const Camera& camera = scene.cameras.front();
  const Film whole = renderCpu(trace, camera, settings, one);
  const Job job = budgetOf(7, settings);
  const Film parts = renderCpu(trace, camera, settings, seven, job);
  EXPECT_EQ(seven.counter("photonsStored"), one.counter("photonsStored"));
  // The automatic radius is told by fewer photons, so that only it differs.
  EXPECT_NEAR(seven.counter("radiusMetres") / one.counter("radiusMetres"), 1.0, 0.15);
  settings.photonClusters.radius = float(one.counter("radiusMetres"));
  const Film sameRadius = renderCpu(trace, camera, settings, seven, job);
  EXPECT_LT(largestDifference(sameRadius.colour, whole.colour), 1e-4);
}

TEST(PhotonBatches, AreOneWhereAllPhotonsAreNeededAtOnce) {
  RenderSettings settings = settingsFor(Estimator::kClusters, 1'000'000);
  constexpr std::uint64_t kSmall = 1u << 20;
  EXPECT_GT(photonBatches(settings, kSmall), 100u);
  EXPECT_EQ(photonBatches(settings, std::uint64_t(16) << 30), 1u);
  RenderSettings nearest = settingsFor(Estimator::kKdtree, 1'000'000);
  nearest.photonKdtree.nearest = 10;
  EXPECT_EQ(photonBatches(nearest, kSmall), 1u);
  EXPECT_EQ(photonBatches(settingsFor(Estimator::kBvh, 1'000'000), kSmall), 1u);
  settings.frame.densityLayer = true;
  EXPECT_EQ(photonBatches(settings, kSmall), 1u);
  const Scene scene = loadScene("cornell-box");
  const TraceScene trace(scene);
  Stats stats;
  Job job;
  job.memoryBudgetBytes = kSmall;
  EXPECT_THROW(renderCpu(trace, scene.cameras.front(), nearest, stats, job), Error);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The estimator by photon differentials against the path tracer, and its caustics against converged pictures.
#include "agreement/agreement.h"
#include "render/test_ring.h"

#include <vector>

namespace isophote {
namespace {

/// As all footprints shrink to nothing, the mean of the picture becomes the reference's.
void expectBvhAgrees(const Case& c, bool noisy = false) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const std::optional<Scene> scene = sceneOf(c.scene);
  if (!scene) GTEST_SKIP() << whyNoScene();
  const TraceScene trace(*scene);
  const Mean expected = meanOfReference(reference(trace, c));
  RenderSettings settings;
  settings.frame.width = c.width;
  settings.frame.height = c.height;
  settings.frame.estimator = Estimator::kBvh;
  settings.photonTrace.photons = c.photons;
  settings.direct.areaSamples = 1;
  Trials trials;
  for (settings.frame.seed = 0; settings.frame.seed < c.seeds; ++settings.frame.seed) {
    const auto at = [&](float scale) {
      settings.photonBvh.radius = scale * c.radius;
      settings.photonBvh.smoothingCaustic = 10.0f * scale;
      return meanOfIndirect(trace, settings);
    };
    trials.add(2.0 * at(0.5f) - at(1.0f));
  }
  expectMeanAgrees(c, "bvh", trials.mean(), expected, noisy);
}

TEST(BvhAgreement, CornellBox) { expectBvhAgrees({"cornell-box", 160, 160, 256, 2'000'000, 4, 0.02f}); }
TEST(BvhAgreement, MirrorsGlassAndGloss) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  expectBvhAgrees({"cornell-objects", 160, 160, 640, 1'200'000, 3, 0.02f}, true);
}
TEST(BvhAgreement, DabrovicsSponza) {
  expectBvhAgrees({"sponza-dabrovic.json", 160, 90, 1024, 3'000'000, 4, 0.12f}, true);
}

constexpr int kWidth = 200, kHeight = 150;

Image indirectOf(const TraceScene& trace, RenderSettings settings) {
  settings.frame.width = kWidth;
  settings.frame.height = kHeight;
  settings.direct.areaSamples = 1;
  Stats stats;
  return renderCpu(trace, trace.scene().cameras.front(), settings, stats).layers.at("indirect");
}

/// What tells a sharp picture from a blurred one: the sum of squared differences between neighbouring pixels,
/// and how far it is from another picture.
struct Sharpness {
  double edges = 0;
  double error = 0;
};
Sharpness sharpnessOf(const Image& picture, const Image& expected) {
  Sharpness s;
  double norm = 0;
  for (int y = 0; y + 1 < kHeight; ++y)
    for (int x = 0; x + 1 < kWidth; ++x) {
      const auto at = [&](const Image& image, int i, int j) {
        return double(meanOf(image.at(x + i, y + j)));
      };
      const double here = at(picture, 0, 0);
      s.edges += std::pow(at(picture, 1, 0) - here, 2) + std::pow(at(picture, 0, 1) - here, 2);
      s.error += std::pow(here - at(expected, 0, 0), 2);
      norm += std::pow(at(expected, 0, 0), 2);
    }
  s.error /= norm;
  return s;
}

TEST(BvhAgreement, TheCausticOfARingIsSharpAndThatOfAConvergedPicture) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const Scene scene = spottedRing();
  const TraceScene trace(scene);
  RenderSettings converged;
  converged.frame.estimator = Estimator::kKdtree;
  converged.frame.seed = 1000;
  converged.photonTrace.photons = 8'000'000;
  converged.photonKdtree = {.nearest = 0, .radius = 0.002f};
  const Image expected = indirectOf(trace, converged);
  const double meanExpected = meanOfImage(expected);
  const Sharpness own = sharpnessOf(expected, expected);
  RenderSettings settings;
  settings.photonTrace.photons = 200'000;
  const auto measured = [&](const char* called) {
    const Image picture = indirectOf(trace, settings);
    const Sharpness s = sharpnessOf(picture, expected);
    const double mean = meanOfImage(picture) / meanExpected;
    std::printf(
        "caustic of the ring, %s: mean %.4f, squared error %.4f, edges %.3f of the converged picture's\n",
        called, mean, s.error, s.edges / own.edges);
    EXPECT_NEAR(mean, 1.0, 0.03) << called << writeFailure(picture, expected);
    return s;
  };
  settings.frame.estimator = Estimator::kBvh;
  const Sharpness bvh = measured("bvh");
  settings.frame.estimator = Estimator::kVolumes;
  const Sharpness volumes = measured("volumes");
  settings.frame.estimator = Estimator::kKdtree;
  const Sharpness kdtree = measured("kdtree");
  // The same photons: footprints follow the caustic, which one radius for all does not.
  EXPECT_GT(bvh.edges, 0.7 * own.edges);
  EXPECT_LT(bvh.edges, 1.5 * own.edges);
  EXPECT_LT(bvh.error, 0.5 * volumes.error);
  EXPECT_LT(bvh.error, 0.8 * kdtree.error);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Pictures of many passes converge to the path tracer's.
#include "agreement/agreement.h"
#include "render/progressive.h"

namespace isophote {
namespace {

/// The relative MSE of the whole picture must fall by at least a fifth from each power of four passes to
/// the next, up to 256, and the mean of the last be the reference's within `tolerance`:
/// bias falls as the sixth root of the passes.
void expectFallingError(const char* name, const char* called, RenderSettings settings,
                        std::uint32_t samplesPerPixel = 4096, double tolerance = 0.02) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const Scene scene = loadScene(name);
  const TraceScene trace(scene);
  const Camera& camera = scene.cameras.front();
  settings.frame.width = settings.frame.height = 48;
  settings.photonTrace.photons = 10'000;
  ReferenceSettings truth;
  settings.frame.bounces = truth.bounces;
  truth.width = truth.height = 48;
  truth.spp = samplesPerPixel;
  Stats stats;
  const Film expected = renderReference(scene, camera, truth, stats);
  ProgressiveRenderer renderer(trace, settings);
  double before = std::numeric_limits<double>::infinity();
  for (const std::uint32_t passes : {1u, 4u, 16u, 64u, 256u}) {
    while (renderer.passes() < passes) renderer.addPass(camera, stats);
    const double error = compareImages(renderer.film().colour, expected.colour).relMse;
    std::printf("%s %s, %u passes: relative MSE %.6f\n", name, called, passes, error);
    EXPECT_LT(error, 0.8 * before) << writeFailure(renderer.film().colour, expected.colour);
    before = error;
  }
  EXPECT_NEAR(meanOfImage(renderer.film().colour) / meanOfImage(expected.colour), 1.0, tolerance);
}

void expectFallingError(const char* name, const char* preset, std::uint32_t samplesPerPixel = 4096) {
  expectFallingError(name, preset, presetSettings(preset), samplesPerPixel);
}

TEST(ProgressiveAgreement, DiffuseByVolumes) { expectFallingError("colour-bleed", "ispm"); }
TEST(ProgressiveAgreement, DiffuseByKdtree) { expectFallingError("colour-bleed", "jensen"); }
TEST(ProgressiveAgreement, DiffuseByTiles) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  expectFallingError("colour-bleed", "tiled");
}
TEST(ProgressiveAgreement, DiffuseByClusters) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  expectFallingError("colour-bleed", "clusters");
}
TEST(ProgressiveAgreement, GlassAndItsCausticByClusters) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  expectFallingError("glass-sphere", "clusters");
}
TEST(ProgressiveAgreement, DiffuseByFootprints) { expectFallingError("colour-bleed", "igpm", 8192); }
TEST(ProgressiveAgreement, GlassAndItsCausticByFootprints) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  expectFallingError("glass-sphere", "igpm");
}
// What quads lose at bends goes with their radius, whether volumes help in corners or not.
TEST(ProgressiveAgreement, DiffuseByQuads) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  RenderSettings settings;
  settings.frame.estimator = Estimator::kQuads;
  expectFallingError("colour-bleed", "quads", settings);
}
TEST(ProgressiveAgreement, DiffuseByQuadsAlone) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  RenderSettings settings;
  settings.frame.estimator = Estimator::kQuads;
  settings.photonQuads.corners = false;
  expectFallingError("colour-bleed", "quads alone", settings, 4096, 0.05);
}
TEST(ProgressiveAgreement, GlassAndItsCaustic) { expectFallingError("glass-sphere", "ispm"); }

}  // namespace
}  // namespace isophote

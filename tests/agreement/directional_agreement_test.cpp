// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The estimate by directional flux, which approximates by design, against the path tracer.
#include "agreement/agreement.h"

namespace isophote {
namespace {

/// Mean of the indirect light at a radius and at half of it, extrapolated to 0, over the reference's.
double extrapolatedRatio(const TraceScene& trace, RenderSettings settings, const Case& c,
                         const Mean& expected) {
  Trials trials;
  for (settings.frame.seed = 0; settings.frame.seed < c.seeds; ++settings.frame.seed) {
    settings.photonDirectional.radius = c.radius;
    const double whole = meanOfIndirect(trace, settings);
    settings.photonDirectional.radius = 0.5f * c.radius;
    trials.add(2.0 * meanOfIndirect(trace, settings) - whole);
  }
  return trials.mean().value / expected.value;
}

void expectWithinThreePercent(const Case& c) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const Scene scene = loadScene(c.scene);
  const TraceScene trace(scene);
  const Mean expected = meanOfReference(reference(trace, c));
  RenderSettings settings;
  settings.frame.width = c.width;
  settings.frame.height = c.height;
  settings.frame.estimator = Estimator::kDirectional;
  settings.photonTrace.photons = c.photons;
  settings.direct.areaSamples = 1;
  // A blur as small beside the picture as it is beside one of 640 pixels by default.
  settings.irradianceBlur.radius = 3;
  settings.irradianceBlur.step = 1;
  const double part = extrapolatedRatio(trace, settings, c, expected);
  settings.photonDirectional.weights = OctantWeights::kPublished;
  const double published = extrapolatedRatio(trace, settings, c, expected);
  std::printf("%s directional: extrapolated mean / reference = %.4f, with the published weights %.4f\n",
              c.scene.c_str(), part, published);
  EXPECT_NEAR(part, 1.0, 0.03);
  EXPECT_GT(published, 1.05) << "twice the cosine with an octant's middle is too much";
  EXPECT_LT(published, 1.25);
}

TEST(DirectionalAgreement, CornellBox) {
  expectWithinThreePercent({"cornell-box", 160, 160, 128, 400'000, 2, 0.06f});
}
TEST(DirectionalAgreement, ColourBleed) {
  expectWithinThreePercent({"colour-bleed", 160, 120, 128, 400'000, 2, 0.06f});
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The estimator by photon quads against the path tracer. It approximates by design: light is lost at bends,
// more of it where no volumes help in corners.
#include "agreement/agreement.h"

namespace isophote {
namespace {

/// As quads shrink their mean becomes the reference's, within 5 % where it is extrapolated from the radius
/// and half of it.
void expectQuadsAgree(const TraceScene& trace, const Case& c, bool corners, const Mean& expected) {
  RenderSettings settings;
  settings.frame.width = c.width;
  settings.frame.height = c.height;
  settings.frame.estimator = Estimator::kQuads;
  settings.photonTrace.photons = c.photons;
  settings.photonQuads.radiusMin = settings.photonQuads.radiusMax = 1;
  settings.photonQuads.corners = corners;
  settings.direct.areaSamples = 1;
  Trials whole, extrapolated;
  for (settings.frame.seed = 0; settings.frame.seed < c.seeds; ++settings.frame.seed) {
    settings.photonQuads.radius = c.radius;
    const double mean = meanOfIndirect(trace, settings);
    settings.photonQuads.radius = 0.5f * c.radius;
    extrapolated.add(2.0 * meanOfIndirect(trace, settings) - mean);
    whole.add(mean);
  }
  const double ratio = extrapolated.mean().value / expected.value;
  const double noise =
      std::hypot(extrapolated.mean().deviation / expected.value, expected.deviation / expected.value);
  const std::string figures = fmt::format(
      "{} {}: mean / reference = {:.4f} at {} m, extrapolated {:.4f} +- {:.4f}", c.scene,
      corners ? "quads" : "quads alone", whole.mean().value / expected.value, c.radius, ratio, noise);
  std::printf("%s\n", figures.c_str());
  EXPECT_LT(noise, 0.01) << figures;
  EXPECT_NEAR(ratio, 1.0, 0.05) << figures;
}

/// With volumes in corners, and, where `alone`, without.
void expectQuadsAgree(const Case& c, bool alone) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const std::optional<Scene> scene = sceneOf(c.scene);
  if (!scene) GTEST_SKIP() << whyNoScene();
  const TraceScene trace(*scene);
  const Mean expected = meanOfReference(reference(trace, c));
  expectQuadsAgree(trace, c, true, expected);
  if (alone) expectQuadsAgree(trace, c, false, expected);
}

TEST(QuadsAgreement, CornellBox) {
  expectQuadsAgree({"cornell-box", 160, 160, 128, 200'000, 3, 0.04f}, true);
}
TEST(QuadsAgreement, ColourBleed) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  expectQuadsAgree({"colour-bleed", 160, 160, 128, 200'000, 3, 0.06f}, true);
}
TEST(QuadsAgreement, Atrium) {
  if (!wantsLongTests()) GTEST_SKIP() << "takes long: ./check --all runs it, or ./check with its name";
  expectQuadsAgree({"atrium", 160, 90, 192, 1'200'000, 3, 0.07f}, false);
}
TEST(QuadsAgreement, SponzaDabrovic) {
  expectQuadsAgree({"sponza-dabrovic.json", 160, 90, 192, 400'000, 3, 0.12f}, true);
}

}  // namespace
}  // namespace isophote

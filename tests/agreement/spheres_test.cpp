// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The estimators by photons of one radius against the path tracer.
#include "agreement/agreement.h"

namespace isophote {
namespace {

TEST(SpheresAgreement, CornellBox) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const Case c{"cornell-box", 160, 160, 256, 3'000'000, 4, 0.02f};
  const Scene scene = loadScene(c.scene);
  const TraceScene trace(scene);
  const Mean expected = meanOfReference(reference(trace, c));
  RenderSettings settings;
  settings.frame.width = c.width;
  settings.frame.height = c.height;
  settings.photonTrace.photons = c.photons;
  settings.direct.areaSamples = 1;
  for (const Estimator estimator : {Estimator::kTiles, Estimator::kClusters}) {
    settings.frame.estimator = estimator;
    const bool tiles = estimator == Estimator::kTiles;
    RenderSettings s = settings;
    Trials trials;
    for (s.frame.seed = 0; s.frame.seed < c.seeds; ++s.frame.seed) {
      s.photonTiles.radius = s.photonClusters.radius = c.radius;
      const double whole = meanOfIndirect(trace, s);
      s.photonTiles.radius = s.photonClusters.radius = 0.5f * c.radius;
      trials.add(2.0 * meanOfIndirect(trace, s) - whole);
    }
    expectMeanAgrees(c, tiles ? "tiles" : "clusters", trials.mean(), expected);
  }
}

}  // namespace
}  // namespace isophote

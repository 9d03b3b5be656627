// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "support/statistics.h"

#include "support/images.h"

namespace isophote {
namespace {

TEST(Statistics, PValuesAreThoseOfTables) {
  EXPECT_NEAR(chiSquarePValue(3.841459, 1), 0.05, 1e-7);
  EXPECT_NEAR(chiSquarePValue(18.307038, 10), 0.05, 1e-7);
  EXPECT_NEAR(chiSquarePValue(135.806723, 100), 0.01, 1e-7);
  EXPECT_NEAR(chiSquarePValue(2.0, 2), std::exp(-1.0), 1e-12);
  EXPECT_NEAR(zScore(0.05), 1.959964, 1e-6);
  EXPECT_NEAR(zScore(1e-3), 3.290527, 1e-6);
  EXPECT_NEAR(significance(10), 1e-4, 1e-7);
}

/// z = 1 - u^power: uniform over the hemisphere for 1.
std::optional<vec3> skewed(std::uint32_t i, float power) {
  const vec3 u = randomTriple(1, i);
  return detail::onSphere(double(1.0f - pow(u.x, power)), double(u.y));
}

TEST(Statistics, RightSamplesPassAndWrongOnesFail) {
  const auto uniform = [](vec3) { return 0.5 / M_PI; };
  const auto right = [](std::uint32_t i) { return skewed(i, 1.0f); };
  const auto wrong = [](std::uint32_t i) { return skewed(i, 1.05f); };
  const SampleTest enough{.samples = 200'000};  // To tell 5 %, under the sanitizers too.
  EXPECT_TRUE(samplesFollow(kHemisphereDomain, right, uniform, enough));
  EXPECT_FALSE(samplesFollow(kHemisphereDomain, wrong, uniform, enough));
  EXPECT_FALSE(samplesFollow(kHemisphereDomain, right, [](vec3) { return 0.55 / M_PI; }));
  EXPECT_FALSE(samplesFollow(kHemisphereDomain, right, [](vec3) { return 0.45 / M_PI; }));
}

TEST(Statistics, SamplesThatAreMissingMustBeExpected) {
  const auto tenthLost = [](std::uint32_t i) {
    return randomTriple(2, i).x < 0.1f ? std::nullopt : skewed(i, 1.0f);
  };
  EXPECT_TRUE(samplesFollow(kHemisphereDomain, tenthLost, [](vec3) { return 0.9 * 0.5 / M_PI; }));
  EXPECT_FALSE(samplesFollow(kHemisphereDomain, tenthLost, [](vec3) { return 0.5 / M_PI; }));
}

TEST(Statistics, DomainsAreMappedThereAndBack) {
  for (const SampleDomain& domain : {kSquareDomain, kDiscDomain, kSphereDomain, kHemisphereDomain}) {
    EXPECT_NEAR(integrateOver(domain, [](vec3) { return 1.0; }), domain.measure, 1e-6);
    for (std::uint32_t i = 0; i < 100; ++i) {
      const vec3 at = randomTriple(3, i);
      double u = 0, v = 0;
      domain.toSquare(domain.fromSquare(double(at.x), double(at.y)), u, v);
      EXPECT_NEAR(u, double(at.x), 1e-5);
      EXPECT_NEAR(v, double(at.y), 1e-5);
    }
  }
  EXPECT_NEAR(integrateOver(kHemisphereDomain, [](vec3 w) { return double(w.z); }), M_PI, 1e-5);
  EXPECT_NEAR(integrateOver(kDiscDomain, [](vec3 p) { return double(dot(p, p)); }), M_PI / 2, 1e-5);
}

TEST(Statistics, MeansAreToldApart) {
  Moments a, b, shifted;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    a.add(double(randomTriple(4, i).x));
    b.add(double(randomTriple(5, i).x));
    shifted.add(double(randomTriple(6, i).x) + 0.01);
  }
  EXPECT_NEAR(a.variance(), 1.0 / 12, 1e-3);
  EXPECT_TRUE(hasMean(a, 0.5));
  EXPECT_FALSE(hasMean(shifted, 0.5));
  EXPECT_TRUE(sameMean(a, b));
  EXPECT_FALSE(sameMean(a, shifted));
}

TEST(Statistics, FailuresLeavePictures) {
  const std::string said = writeFailure(Image(4, 4, vec3(1.0f)), Image(4, 4, vec3(0.5f)));
  const std::filesystem::path folder =
      std::filesystem::path(ISOPHOTE_BINARY_DIR) / "failures" / "Statistics.FailuresLeavePictures";
  EXPECT_NE(said.find(folder.string()), std::string::npos);
  EXPECT_EQ(readFilm(folder / "expected.exr").colour.at(3, 3), vec3(0.5f));
  EXPECT_TRUE(std::filesystem::exists(folder / "actual.png"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace isophote

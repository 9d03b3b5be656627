// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/sampling.shared.h"

#include "support/statistics.h"

#include <cmath>

namespace isophote {
namespace {

constexpr int kWarps = 7;

vec2 uniform(std::uint32_t stream, std::uint32_t i) {
  const vec3 u = randomTriple(stream, i);
  return vec2(u.x, u.y);
}

TEST(Sampling, DiscIsUniform) {
  const auto sample = [](std::uint32_t i) -> std::optional<vec3> {
    return vec3(sampleDisc(uniform(1, i)), 0.0f);
  };
  EXPECT_TRUE(samplesFollow(kDiscDomain, sample, [](vec3) { return 1 / M_PI; }, {.tests = kWarps}));
}

/// Rings of the square become rings of the disc, and the corners lie on the diagonals.
TEST(Sampling, DiscIsConcentric) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const vec2 u = uniform(2, i);
    const vec2 p = 2.0f * u - vec2(1.0f);
    ASSERT_NEAR(length(sampleDisc(u)), std::max(std::abs(p.x), std::abs(p.y)), 1e-6f);
  }
  const float diagonal = std::sqrt(0.5f);
  EXPECT_NEAR(sampleDisc(vec2(1.0f, 1.0f)).x, diagonal, 1e-6f);
  EXPECT_NEAR(sampleDisc(vec2(1.0f, 1.0f)).y, diagonal, 1e-6f);
  EXPECT_NEAR(sampleDisc(vec2(0.0f, 1.0f)).x, -diagonal, 1e-6f);
  EXPECT_EQ(sampleDisc(vec2(0.5f)), vec2(0.0f));
  EXPECT_NEAR(length(sampleDisc(vec2(0.5f, 0.75f)) - vec2(0.0f, 0.5f)), 0.0f, 1e-6f);
}

TEST(Sampling, HemisphereFollowsTheCosine) {
  const auto sample = [](std::uint32_t i) -> std::optional<vec3> {
    return sampleCosineHemisphere(uniform(3, i));
  };
  EXPECT_TRUE(samplesFollow(kHemisphereDomain, sample, [](vec3 w) { return double(w.z * kInvPi); },
                            {.tests = kWarps}));
}

TEST(Sampling, SphereIsUniform) {
  const auto sample = [](std::uint32_t i) -> std::optional<vec3> { return sampleSphere(uniform(4, i)); };
  EXPECT_TRUE(samplesFollow(kSphereDomain, sample, [](vec3) { return 0.25 / M_PI; }, {.tests = kWarps}));
}

TEST(Sampling, ConeIsUniform) {
  for (const float cosMax : {-0.3f, 0.7f}) {
    const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
      return sampleCone(uniform(5, i), cosMax);
    };
    const auto pdf = [&](vec3 w) { return w.z >= cosMax ? 0.5 / M_PI / double(1.0f - cosMax) : 0.0; };
    EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf, {.tests = kWarps})) << cosMax;
  }
}

/// A cone of a millionth of a radian still has an inside.
TEST(Sampling, NarrowConesKeepTheirWidth) {
  const double halfAngle = 1e-6, oneMinusCos = 0.5 * halfAngle * halfAngle;
  Moments squared;
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const vec3 w = sampleNarrowCone(uniform(6, i), float(oneMinusCos));
    const double r = std::hypot(double(w.x), double(w.y)) / halfAngle;
    ASSERT_LE(r, 1.0 + 1e-5);
    squared.add(r * r);
  }
  EXPECT_TRUE(hasMean(squared, 0.5));
}

TEST(Sampling, TriangleIsUniform) {
  const auto sample = [](std::uint32_t i) -> std::optional<vec3> {
    const vec2 b = sampleTriangle(uniform(7, i));
    return vec3(b, 0.0f);
  };
  const auto pdf = [](vec3 b) { return b.x + b.y <= 1.0f ? 2.0 : 0.0; };
  EXPECT_TRUE(samplesFollow(kSquareDomain, sample, pdf, {.tests = kWarps}));
}

TEST(Sampling, TurnsGiveSineAndCosine) {
  for (int i = -4000; i <= 4000; ++i) {
    const float turns = float(i) / 4000.0f;
    float s = 0, c = 0;
    sinCosOfTurns(turns, s, c);
    ASSERT_NEAR(s, std::sin(2 * M_PI * double(turns)), 2.5e-7) << turns;
    ASSERT_NEAR(c, std::cos(2 * M_PI * double(turns)), 2.5e-7) << turns;
  }
}

TEST(Sampling, BasesAreOrthonormal) {
  std::vector<vec3> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  normals.push_back(normalize(vec3(1e-4f, -1e-4f, -1.0f)));
  normals.push_back(normalize(vec3(1.0f, 1.0f, -0.0f)));
  normals.push_back(normalize(vec3(1.0f, -1.0f, -1e-8f)));
  for (std::uint32_t i = 0; i < 50'000; ++i) normals.push_back(sampleSphere(uniform(8, i)));
  for (const vec3 n : normals) {
    const mat3 b = basisAround(n);
    ASSERT_EQ(b[2], n);
    ASSERT_NEAR(dot(b[0], b[0]), 1.0f, 2e-6f);
    ASSERT_NEAR(dot(b[1], b[1]), 1.0f, 2e-6f);
    ASSERT_NEAR(dot(b[0], b[1]), 0.0f, 2e-6f);
    ASSERT_NEAR(dot(b[0], n), 0.0f, 2e-6f);
    ASSERT_NEAR(dot(b[1], n), 0.0f, 2e-6f);
    ASSERT_NEAR(dot(cross(b[0], b[1]), n), 1.0f, 4e-6f) << "left-handed";
  }
}

TEST(Sampling, PackedDirectionsErrAsLittleAsDocumented) {
  double worst = 0;
  for (std::uint32_t i = 0; i < testSamples(500'000); ++i) {
    const vec3 v = sampleSphere(uniform(9, i));
    const vec3 back = unpackDirection(packDirection(v));
    ASSERT_NEAR(length(back), 1.0f, 1e-6f);
    worst = std::max(worst, double(length(back - v)));
  }
  EXPECT_LE(worst, 6.6e-5);
  EXPECT_GE(worst, 5e-5) << "the documented bound is too wide";
}

TEST(Sampling, AxesArePackedExactly) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      vec3 v(0.0f);
      v[axis] = sign;
      EXPECT_EQ(unpackDirection(packDirection(v)), v) << axis << ' ' << sign;
    }
}

/// The corners of the unit square give directions, not NaN.
TEST(Sampling, CornersOfTheSquareAreFinite) {
  const float edges[] = {0.0f, 0.5f, 0.99999994f, 1.0f};
  for (const float x : edges)
    for (const float y : edges) {
      const vec2 u(x, y);
      EXPECT_NEAR(length(sampleCosineHemisphere(u)), 1.0f, 1e-5f);
      EXPECT_NEAR(length(sampleSphere(u)), 1.0f, 1e-5f);
      EXPECT_NEAR(length(sampleCone(u, 0.5f)), 1.0f, 1e-5f);
      const vec2 b = sampleTriangle(u);
      EXPECT_TRUE(b.x >= 0.0f && b.y >= 0.0f && b.x + b.y <= 1.0f + 1e-6f);
    }
}

}  // namespace
}  // namespace isophote

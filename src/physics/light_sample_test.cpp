// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Lights seen from a point: directions, densities, distances, and the rays that meet a light by chance.
#include "physics/emission.shared.h"

#include "support/statistics.h"

#include <cmath>

namespace isophote {
namespace {

Light sphereLight(vec3 position, float radius) {
  Light light{};
  light.type = kLightPoint;
  light.position = position;
  light.radius = radius;
  light.colour = vec3(4.0f);
  return light;
}

Light rectangleLight(vec3 corner, vec3 edgeU, vec3 edgeV) {
  Light light{};
  light.type = kLightRectangle;
  light.position = corner;
  light.edgeU = edgeU;
  light.edgeV = edgeV;
  light.area = length(cross(edgeU, edgeV));
  light.direction = cross(edgeU, edgeV) / light.area;
  light.colour = vec3(4.0f);
  return light;
}

/// Skewed, emitting downwards.
Light skewedRectangle() {
  return rectangleLight(vec3(-0.5f, -0.3f, 1.0f), vec3(0.1f, 1.2f, 0.2f), vec3(1.4f, 0.4f, -0.1f));
}

vec2 uniform(std::uint32_t stream, std::uint32_t i) {
  const vec3 u = randomTriple(stream, i);
  return vec2(u.x, u.y);
}

constexpr int kTests = 7;

TEST(LightSample, SphereDirectionsFollowTheDensityOfRaysThatMeetIt) {
  for (const vec3 from : {vec3(0.0f), vec3(1.0f, -2.0f, 0.5f)}) {
    const Light light = sphereLight(vec3(0.5f, 0.2f, 1.5f), 0.7f);
    const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
      return samplePoint(light, from, uniform(1, i)).wi;
    };
    const auto pdf = [&](vec3 w) {
      return intersectSphereLight(light, from, w) > 0.0f ? double(sphereLightPdf(light, from)) : 0.0;
    };
    EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf,
                              {.samples = testSamples(100'000), .tests = kTests, .depth = 3}));
  }
}

TEST(LightSample, RectangleDirectionsFollowTheDensityOfRaysThatMeetIt) {
  for (const vec3 from : {vec3(0.0f), vec3(1.0f, -1.0f, -0.5f)}) {
    const Light light = skewedRectangle();
    const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
      return sampleRectangle(light, from, uniform(2, i)).wi;
    };
    const auto pdf = [&](vec3 w) {
      const float t = intersectRectangleLight(light, from, w);
      return t > 0.0f ? double(areaSamplePdf(w * t, light.direction, light.area)) : 0.0;
    };
    EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf,
                              {.samples = testSamples(100'000), .tests = kTests, .depth = 3}));
  }
}

TEST(LightSample, TriangleDirectionsFollowTheirDensity) {
  EmissiveTriangle t{};
  t.v0 = vec3(-0.5f, -0.3f, 1.0f);
  t.edge1 = vec3(0.1f, 1.2f, 0.2f);
  t.edge2 = vec3(1.4f, 0.4f, -0.1f);
  t.radiance = vec3(1.0f);
  t.doubleSided = 1u;
  const vec3 n = normalize(cross(t.edge1, t.edge2));
  const float area = 0.5f * length(cross(t.edge1, t.edge2));
  for (const vec3 from : {vec3(0.0f), vec3(0.3f, 0.1f, 2.5f)}) {
    const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
      return sampleEmissiveTriangle(t, 1.0f, from, uniform(3, i)).wi;
    };
    const auto pdf = [&](vec3 w) {
      const float distance = dot(t.v0 - from, n) / dot(w, n);
      const vec3 p = from + w * distance - t.v0;
      const float u = dot(cross(p, t.edge2), n) / (2.0f * area),
                  v = dot(cross(t.edge1, p), n) / (2.0f * area);
      if (!(distance > 0.0f && u >= 0.0f && v >= 0.0f && u + v <= 1.0f)) return 0.0;
      return double(distance * distance / (std::abs(dot(w, n)) * area));
    };
    EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf,
                              {.samples = testSamples(100'000), .tests = kTests, .depth = 3}));
  }
}

TEST(LightSample, EnvironmentDirectionsFollowTheCosine) {
  const vec3 n = normalize(vec3(1.0f, -2.0f, -0.5f));
  Light light{};
  light.type = kLightEnvironment;
  light.colour = vec3(3.0f);
  const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
    return sampleEnvironment(light, n, uniform(4, i)).wi;
  };
  const auto pdf = [&](vec3 w) { return double(std::max(dot(w, n), 0.0f) * kInvPi); };
  EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf,
                            {.samples = testSamples(100'000), .tests = kTests, .depth = 3}));
}

TEST(LightSample, SpheresLieWhereTheirSamplesSay) {
  for (const float distance : {0.71f, 2.0f, 100.0f, 1e4f}) {
    const Light light = sphereLight(distance * normalize(vec3(1.0f, 2.0f, -0.7f)), 0.7f);
    int met = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const LightSample s = samplePoint(light, vec3(0.0f), uniform(5, i));
      ASSERT_NEAR(length(s.wi), 1.0f, 1e-5f);
      ASSERT_EQ(s.pdf, sphereLightPdf(light, vec3(0.0f)));
      ASSERT_NEAR(length(s.wi * s.distance - light.position), 0.7f, 2e-3f + 2e-6f * distance) << distance;
      const float t = intersectSphereLight(light, vec3(0.0f), s.wi);
      // At the rim, directions of float precision miss.
      met += t > 0.0f ? 1 : 0;
      ASSERT_NEAR(t > 0.0f ? t : s.distance, s.distance, 1e-2f + 2e-6f * distance) << distance;
    }
    EXPECT_GE(met, distance > 1e3f ? 1950 : 1990) << distance;
  }
}

TEST(LightSample, RectanglesLieWhereTheirSamplesSay) {
  const Light light = skewedRectangle();
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const vec3 from(randomTriple(6, i) * vec3(4.0f, 4.0f, 0.5f) - vec3(2.0f, 2.0f, 0.5f));
    const LightSample s = sampleRectangle(light, from, 0.01f + 0.98f * uniform(7, i));
    const float t = intersectRectangleLight(light, from, s.wi);
    ASSERT_NEAR(t, s.distance, 1e-4f);
    ASSERT_NEAR(areaSamplePdf(s.wi * t, light.direction, light.area) / s.pdf, 1.0f, 1e-3f);
    EXPECT_LT(intersectRectangleLight(light, from, -s.wi), 0.0f);
  }
}

TEST(LightSample, RectanglesAreDarkFromBehind) {
  const Light light = skewedRectangle();
  const vec3 behind(0.2f, 0.2f, 3.0f);
  EXPECT_EQ(sampleRectangle(light, behind, vec2(0.5f)).pdf, 0.0f);
  EXPECT_LT(intersectRectangleLight(light, behind, vec3(0.0f, 0.0f, -1.0f)), 0.0f);
}

TEST(LightSample, PointsGiveTheInverseSquare) {
  const LightSample s = samplePoint(sphereLight(vec3(0.0f, 3.0f, 4.0f), 0.0f), vec3(0.0f), vec2(0.3f));
  EXPECT_EQ(s.isDelta, 1.0f);
  EXPECT_EQ(s.pdf, 1.0f);
  EXPECT_FLOAT_EQ(s.distance, 5.0f);
  EXPECT_FLOAT_EQ(s.radiance.x, 4.0f / 25.0f);
  EXPECT_FLOAT_EQ(s.wi.y, 0.6f);
}

TEST(LightSample, SpotsFallOffBetweenTheirCones) {
  Light light{};
  light.type = kLightSpot;
  light.colour = vec3(8.0f);
  light.direction = vec3(0.0f, 0.0f, -1.0f);
  light.position = vec3(0.0f, 0.0f, 2.0f);
  light.cosInner = 0.9f;
  light.cosOuter = 0.7f;
  EXPECT_EQ(spotFalloff(light, 0.95f), 1.0f);
  EXPECT_EQ(spotFalloff(light, 0.69f), 0.0f);
  EXPECT_NEAR(spotFalloff(light, 0.8f), 0.25f, 1e-5f);
  EXPECT_FLOAT_EQ(sampleSpot(light, vec3(0.0f)).radiance.x, 2.0f);
  EXPECT_EQ(sampleSpot(light, vec3(0.0f, 0.0f, 4.0f)).radiance.x, 0.0f);
}

TEST(LightSample, SpheresAreDarkFromInside) {
  const Light light = sphereLight(vec3(0.0f), 1.0f);
  EXPECT_EQ(samplePoint(light, vec3(0.1f), vec2(0.5f)).pdf, 0.0f);
  EXPECT_LT(intersectSphereLight(light, vec3(0.1f), vec3(0.0f, 0.0f, 1.0f)), 0.0f);
}

/// Lights far away, tiny, in huge scenes, touching the point: finite and not negative.
TEST(LightSample, ExtremesStayFinite) {
  for (const float distance : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f})
    for (const float size : {1e-4f, 1.0f, 1e3f})
      for (const vec3 offset : {vec3(0.0f), vec3(1e5f, -2e5f, 3e4f)})
        for (std::uint32_t i = 0; i < 200; ++i) {
          const vec3 at = offset + vec3(0.0f, 0.0f, distance);
          const LightSample s = samplePoint(sphereLight(at, size), offset, uniform(8, i));
          const Light r = rectangleLight(at, vec3(0.0f, size, 0.0f), vec3(size, 0.0f, 0.0f));
          const LightSample q = sampleRectangle(r, offset, uniform(9, i));
          for (const LightSample& l : {s, q}) {
            ASSERT_TRUE(std::isfinite(l.wi.x) && std::isfinite(l.wi.z) && std::isfinite(l.distance));
            ASSERT_TRUE(std::isfinite(l.pdf) && l.pdf >= 0.0f) << distance << ' ' << size;
            ASSERT_TRUE(std::isfinite(l.radiance.x) && l.radiance.x >= 0.0f);
          }
        }
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Light leaves its sources as photons and is found from points that it reaches: both must tell of one light.
#include "physics/emission.shared.h"

#include "scene/light_power.h"
#include "support/statistics.h"

#include <cmath>
#include <functional>

namespace isophote {
namespace {

const vec3 kCentre(0.2f, -0.1f, 0.3f);
constexpr float kSceneRadius = 3.0f;
const vec3 kHalfSize(1.6f, 1.8f, 1.7f);

vec2 firstTwo(vec3 u) { return vec2(u.x, u.y); }

Light lightOf(uint type) {
  Light light{};
  light.type = type;
  light.colour = vec3(2.0f, 5.0f, 11.0f);
  light.position = vec3(0.4f, 0.3f, 1.5f);
  light.direction = normalize(vec3(0.3f, -0.2f, -1.0f));
  return light;
}

Light pointLight(float radius) {
  Light light = lightOf(kLightPoint);
  light.radius = radius;
  return light;
}

Light spotLight(float cosInner, float cosOuter) {
  Light light = lightOf(kLightSpot);
  light.cosInner = cosInner;
  light.cosOuter = cosOuter;
  return light;
}

Light rectangleLight() {
  Light light = lightOf(kLightRectangle);
  light.position = vec3(-0.5f, -0.3f, 1.2f);
  light.edgeU = vec3(0.1f, 0.9f, 0.2f);
  light.edgeV = vec3(1.1f, 0.0f, 0.1f);
  const vec3 n = cross(light.edgeU, light.edgeV);
  light.area = length(n);
  light.direction = n / light.area;
  return light;
}

EmissiveTriangle emissiveTriangle(bool doubleSided) {
  EmissiveTriangle t{};
  t.v0 = vec3(-0.5f, -0.3f, 1.2f);
  t.edge1 = vec3(0.1f, 0.9f, 0.2f);
  t.edge2 = vec3(1.1f, 0.0f, 0.1f);
  t.radiance = vec3(2.0f, 5.0f, 11.0f);
  t.doubleSided = doubleSided ? 1u : 0u;
  return t;
}

/// One kind of light: how it emits (u: six numbers) and how it is seen from a point.
struct Source {
  const char* name;
  std::function<EmittedPhoton(vec3 u, vec3 v)> emit;
  std::function<LightSample(vec3 from, vec3 normal, vec2 u)> sample;
  double power;  ///< Mean of RGB.
};

Source sourceOf(const char* name, const Light& light) {
  Bounds bounds;
  bounds.extend(kCentre - kHalfSize);
  bounds.extend(kCentre + kHalfSize);
  const float radius = bounds.radius();
  const auto emit = [=](vec3 u, vec3 v) {
    switch (light.type) {
      case kLightPoint:
        return emitPoint(light, firstTwo(u), firstTwo(v));
      case kLightSpot:
        return emitSpot(light, firstTwo(u));
      case kLightDirectional:
        return emitDirectional(light, kCentre, kHalfSize, firstTwo(u));
      case kLightRectangle:
        return emitRectangle(light, firstTwo(u), firstTwo(v));
      default:
        return emitEnvironment(light, kCentre, radius, firstTwo(u), firstTwo(v));
    }
  };
  const auto sample = [=](vec3 from, vec3 normal, vec2 u) {
    switch (light.type) {
      case kLightPoint:
        return samplePoint(light, from, u);
      case kLightSpot:
        return sampleSpot(light, from);
      case kLightDirectional:
        return sampleDirectional(light);
      case kLightRectangle:
        return sampleRectangle(light, from, u);
      default:
        return sampleEnvironment(light, normal, u);
    }
  };
  return {name, emit, sample, double(lightPower(light, bounds))};
}

Source sourceOf(const char* name, const EmissiveTriangle& t, float probability) {
  const float area = 0.5f * length(cross(t.edge1, t.edge2));
  return {name, [=](vec3 u, vec3 v) { return emitTriangle(t, probability, u.z, firstTwo(u), firstTwo(v)); },
          [=](vec3 from, vec3, vec2 u) { return sampleEmissiveTriangle(t, probability, from, u); },
          M_PI * 6.0 * double(area) * (t.doubleSided ? 2 : 1) / double(probability)};
}

std::vector<Source> allSources() {
  return {sourceOf("point", pointLight(0.0f)),
          sourceOf("sphere", pointLight(0.3f)),
          sourceOf("spot", spotLight(0.95f, 0.8f)),
          sourceOf("wide spot", spotLight(0.1f, -0.4f)),
          sourceOf("directional", lightOf(kLightDirectional)),
          sourceOf("rectangle", rectangleLight()),
          sourceOf("triangle", emissiveTriangle(false), 1.0f),
          sourceOf("two-sided triangle", emissiveTriangle(true), 1.0f),
          sourceOf("environment", lightOf(kLightEnvironment))};
}

double meanOfRgb(vec3 v) { return double(v.x + v.y + v.z) / 3; }

TEST(Emission, MeanPowerIsTheLights) {
  const std::vector<Source> sources = allSources();
  std::uint32_t stream = 100;
  for (const Source& source : sources) {
    Moments power;
    stream += 2;
    for (std::uint32_t i = 0; i < testSamples(100'000); ++i) {
      const EmittedPhoton e = source.emit(randomTriple(stream, i), randomTriple(stream + 1, i));
      ASSERT_NEAR(length(e.direction), 1.0f, 1e-5f);
      power.add(meanOfRgb(e.power));
    }
    EXPECT_TRUE(hasMean(power, source.power, int(sources.size()), 1e-4)) << source.name;
  }
}

TEST(Emission, PowersKeepTheLightsColour) {
  for (const Source& source : allSources()) {
    const EmittedPhoton e = source.emit(vec3(0.1f), vec3(0.4f));
    EXPECT_NEAR(e.power.y / e.power.x, 2.5f, 1e-5f) << source.name;
    EXPECT_NEAR(e.power.z / e.power.x, 5.5f, 1e-5f) << source.name;
  }
}

TEST(Emission, DirectionsFollowTheirDensity) {
  const Light rectangle = rectangleLight(), spot = spotLight(0.95f, 0.8f);
  struct Case {
    const char* name;
    std::function<vec3(std::uint32_t)> direction;
    std::function<double(vec3)> pdf;
  };
  const auto uniform = [](vec3) { return 0.25 / M_PI; };
  const auto triple = [](std::uint32_t stream, std::uint32_t i) { return firstTwo(randomTriple(stream, i)); };
  const EmissiveTriangle twoSided = emissiveTriangle(true);
  const vec3 normal = rectangle.direction;
  const Case cases[] = {
      {"point", [&](auto i) { return emitPoint(pointLight(0.0f), triple(1, i), triple(2, i)).direction; },
       uniform},
      // Averaged over the sphere's surface.
      {"sphere", [&](auto i) { return emitPoint(pointLight(0.3f), triple(3, i), triple(4, i)).direction; },
       uniform},
      {"spot", [&](auto i) { return emitSpot(spot, triple(5, i)).direction; },
       [&](vec3 w) { return dot(w, spot.direction) >= 0.8f ? 0.5 / M_PI / double(1.0f - 0.8f) : 0.0; }},
      {"rectangle", [&](auto i) { return emitRectangle(rectangle, triple(6, i), triple(7, i)).direction; },
       [&](vec3 w) { return double(std::max(dot(w, normal), 0.0f) * kInvPi); }},
      {"two-sided triangle",
       [&](auto i) {
         return emitTriangle(twoSided, 1.0f, randomTriple(8, i).x, triple(9, i), triple(10, i)).direction;
       },
       [&](vec3 w) { return 0.5 * double(std::abs(dot(w, normal)) * kInvPi); }},
      {"environment",
       [&](auto i) {
         return emitEnvironment(lightOf(kLightEnvironment), kCentre, kSceneRadius, triple(11, i),
                                triple(12, i))
             .direction;
       },
       uniform}};
  for (const Case& c : cases) {
    const auto sample = [&](std::uint32_t i) -> std::optional<vec3> { return c.direction(i); };
    EXPECT_TRUE(samplesFollow(kSphereDomain, sample, c.pdf,
                              {.samples = testSamples(100'000), .tests = int(std::size(cases))}))
        << c.name;
  }
}

TEST(Emission, PhotonsLeaveFromTheLight) {
  const Light rectangle = rectangleLight(), sphere = pointLight(0.3f);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const vec3 u = randomTriple(20, i), v = randomTriple(21, i);
    const EmittedPhoton a = emitPoint(sphere, firstTwo(u), firstTwo(v));
    ASSERT_NEAR(length(a.origin - sphere.position), 0.3f, 1e-5f);
    ASSERT_GE(dot(a.direction, a.origin - sphere.position), -1e-6f);
    const EmittedPhoton b = emitRectangle(rectangle, firstTwo(u), firstTwo(v));
    ASSERT_NEAR(dot(b.origin - rectangle.position, rectangle.direction), 0.0f, 1e-6f);
    const EmittedPhoton c =
        emitEnvironment(lightOf(kLightEnvironment), kCentre, kSceneRadius, firstTwo(u), firstTwo(v));
    ASSERT_GE(length(c.origin - kCentre), kSceneRadius);
    const EmittedPhoton d = emitDirectional(lightOf(kLightDirectional), kCentre, kHalfSize, firstTwo(u));
    // In front of every corner of the box.
    for (int corner = 0; corner < 8; ++corner) {
      const vec3 side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      ASSERT_GT(dot(kCentre + side * kHalfSize - d.origin, d.direction), 0.0f);
    }
  }
}

/// Irradiance on a tilted disc, front and back apart: by photons that cross it and by samples of the light
/// from its points.
TEST(Emission, PhotonsAndLightSamplesGiveOneIrradiance) {
  const vec3 discCentre(0.3f, 0.2f, -0.4f);
  const vec3 normal = normalize(vec3(0.2f, -0.3f, 1.0f));
  constexpr float kDiscRadius = 0.9f;
  const float area = kPi * kDiscRadius * kDiscRadius;
  const std::vector<Source> sources = allSources();
  std::uint32_t stream = 300;
  for (const Source& source : sources) {
    stream += 3;
    for (const float side : {1.0f, -1.0f}) {
      const vec3 n = normal * side;
      Moments photons, samples;
      for (std::uint32_t i = 0; i < testSamples(200'000); ++i) {
        const EmittedPhoton e = source.emit(randomTriple(stream, i), randomTriple(stream + 1, i));
        const float cosine = -dot(e.direction, n);
        const float t = dot(e.origin - discCentre, n) / std::max(cosine, 1e-9f);
        const vec3 at = e.origin + e.direction * t - discCentre;
        const bool hits = cosine > 0.0f && t > 0.0f && dot(at, at) < kDiscRadius * kDiscRadius;
        photons.add(hits ? meanOfRgb(e.power) / double(area) : 0.0);
      }
      for (std::uint32_t i = 0; i < testSamples(50'000); ++i) {
        const vec3 u = randomTriple(stream + 2, i);
        const vec2 d = sampleDisc(firstTwo(u)) * kDiscRadius;
        const mat3 frame = basisAround(n);
        const vec3 from = discCentre + frame[0] * d.x + frame[1] * d.y;
        const LightSample l = source.sample(from, n, firstTwo(randomTriple(stream, i)));
        const float cosine = std::max(dot(l.wi, n), 0.0f);
        samples.add(l.pdf > 0.0f ? meanOfRgb(l.radiance) * double(cosine / l.pdf) : 0.0);
      }
      EXPECT_TRUE(sameMean(photons, samples, 2 * int(sources.size()), 1e-4))
          << source.name << (side > 0.0f ? " in front" : " behind");
    }
  }
}

}  // namespace
}  // namespace isophote

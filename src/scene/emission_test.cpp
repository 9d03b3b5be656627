// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Light leaves its sources as photons and is found from points that it reaches: both must tell of one light.
#include "physics/emission.shared.h"

#include "scene/environment.h"
#include "scene/light_power.h"
#include "support/statistics.h"

#include <cmath>
#include <functional>
#include <memory>
#include <optional>

namespace isophote {
namespace {

const vec3 kCentre(0.2f, -0.1f, 0.3f);
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

/// An environment with a map that is turned and tilted.
Light mappedLight() {
  Light light = lightOf(kLightEnvironment);
  light.mapped = 1u;
  light.edgeV = normalize(vec3(0.3f, 0.8f, -0.2f));
  light.edgeU = normalize(cross(light.edgeV, vec3(0.5f, 0.1f, 1.0f)));
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
  double power;            ///< Mean of RGB.
  double rounding = 1e-4;  ///< Relative, of `power`.
};

Source sourceOf(const char* name, const Light& light) {
  Bounds bounds;
  bounds.extend(kCentre - kHalfSize);
  bounds.extend(kCentre + kHalfSize);
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
        return emitEnvironment(light, kCentre, kHalfSize, v.z, firstTwo(u), firstTwo(v));
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

/// A dim sky over a dark ground with a small sun 10000 times as bright, all of them of lightOf()'s hue.
EnvironmentMap skyWithSun() {
  EnvironmentMap map;
  map.radiance = Image(64, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      map.radiance.at(x, y) = vec3(y < 16 ? 0.5f + 0.4f * std::sin(0.3f * float(x)) : 0.05f);
  map.radiance.at(40, 9) = vec3(1e4f);
  Bounds bounds;
  bounds.extend(kCentre - kHalfSize);
  bounds.extend(kCentre + kHalfSize);
  prepareEnvironment(map, mappedLight(), bounds);
  return map;
}

/// The same power at the same place, whoever asks.
Source mappedSource(const char* name, EnvironmentMap map) {
  const auto shared = std::make_shared<const EnvironmentMap>(std::move(map));
  return {name,
          [=](vec3 u, vec3 v) {
            return emitFromMap(*shared, mappedLight(), kCentre, kHalfSize, firstTwo(u), firstTwo(v));
          },
          [=](vec3, vec3 normal, vec2 u) {
            // The choice between cosine and map is drawn from the first number's digits.
            const float choice = u.x * 1024.0f - std::floor(u.x * 1024.0f);
            return sampleEnvironmentLight(*shared, mappedLight(), normal, vec3(choice, u));
          },
          double(environmentPower(*shared)), 2e-3};  // a sum over texels for an integral
}

EnvironmentMap constantMap() {
  EnvironmentMap map;
  map.radiance = Image(256, 128, vec3(1.0f));
  Bounds bounds;
  bounds.extend(kCentre - kHalfSize);
  bounds.extend(kCentre + kHalfSize);
  prepareEnvironment(map, mappedLight(), bounds);
  return map;
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
          sourceOf("environment", lightOf(kLightEnvironment)),
          mappedSource("environment of one colour", constantMap()),
          mappedSource("sky with sun", skyWithSun())};
}

double meanOfRgb(vec3 v) { return double(v.x + v.y + v.z) / 3; }

TEST(Emission, AMapOfOneColourIsAConstantEnvironment) {
  Bounds bounds;
  bounds.extend(kCentre - kHalfSize);
  bounds.extend(kCentre + kHalfSize);
  const double constant = double(lightPower(lightOf(kLightEnvironment), bounds));
  EXPECT_NEAR(double(environmentPower(constantMap())) / constant, 1.0, 2e-4);
}

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
    EXPECT_TRUE(hasMean(power, source.power, int(sources.size()), source.rounding)) << source.name;
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
       [&](vec3 w) { return 0.5 * double(std::abs(dot(w, normal)) * kInvPi); }}};
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
  }
}

/// Distance at which a ray enters the box, or nothing.
std::optional<float> entersBox(vec3 origin, vec3 direction, vec3 halfSize) {
  float begin = -1e30f, end = 1e30f;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) < 1e-12f) continue;
    const float a = (kCentre[k] - halfSize[k] - origin[k]) / direction[k];
    const float b = (kCentre[k] + halfSize[k] - origin[k]) / direction[k];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (begin > end + 1e-4f) return std::nullopt;
  return begin;
}

TEST(Emission, LightFromOutsideAlwaysEntersTheScene) {
  const EnvironmentMap map = skyWithSun();
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const vec3 u = randomTriple(22, i), v = randomTriple(23, i);
    Light sun = lightOf(kLightDirectional);
    sun.direction = sampleSphere(firstTwo(randomTriple(24, i)));
    const EmittedPhoton photons[] = {
        emitDirectional(sun, kCentre, kHalfSize, firstTwo(u)),
        emitEnvironment(lightOf(kLightEnvironment), kCentre, kHalfSize, v.z, firstTwo(u), firstTwo(v)),
        emitFromMap(map, mappedLight(), kCentre, kHalfSize, firstTwo(u), firstTwo(v))};
    for (const EmittedPhoton& e : photons) {
      ASSERT_NEAR(length(e.direction), 1.0f, 1e-5f);
      const std::optional<float> distance = entersBox(e.origin, e.direction, kHalfSize);
      ASSERT_TRUE(distance.has_value()) << i;
      ASSERT_GT(*distance, 0.0f) << i;
    }
  }
}

/// A flat scene is lit too, and without its own thickness.
TEST(Emission, FlatScenesAreLitFromOutside) {
  const vec3 flat(2.0f, 0.0f, 1.0f);
  Light sun = lightOf(kLightDirectional);
  sun.direction = vec3(0.0f, -1.0f, 0.0f);
  EXPECT_NEAR(emitDirectional(sun, kCentre, flat, vec2(0.3f, 0.6f)).power.x, 2.0f * 8.0f, 1e-4f);
  sun.direction = vec3(1.0f, 0.0f, 0.0f);
  EXPECT_EQ(emitDirectional(sun, kCentre, flat, vec2(0.3f, 0.6f)).power.x, 0.0f) << "it sees an edge";
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const vec3 u = randomTriple(25, i), v = randomTriple(26, i);
    const EmittedPhoton e =
        emitEnvironment(lightOf(kLightEnvironment), kCentre, flat, v.z, firstTwo(u), firstTwo(v));
    const float t = (kCentre.y - e.origin.y) / e.direction.y;
    const vec3 at = abs(e.origin + e.direction * t - kCentre);
    ASSERT_GT(t, 0.0f);
    ASSERT_LT(at.x, 2.001f);
    ASSERT_LT(at.z, 1.001f);
  }
}

/// Photons of a grey map carry nearly the same power, a sun or not.
TEST(Emission, MapPhotonsAreEvenlyStrong) {
  const EnvironmentMap map = skyWithSun();
  Moments power;
  for (std::uint32_t i = 0; i < testSamples(20'000); ++i)
    power.add(meanOfRgb(
        emitFromMap(map, mappedLight(), kCentre, kHalfSize, vec2(0.5f), firstTwo(randomTriple(27, i)))
            .power));
  EXPECT_LT(std::sqrt(power.variance()) / power.mean(), 0.1);
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

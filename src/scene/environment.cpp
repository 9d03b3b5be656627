// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/environment.h"

#include "math/bounds.h"

#include <vector>

namespace isophote {

namespace {

/// Part of the samples that follow the cosine where a map could lead them too.
constexpr float kCosineShare = 0.5f;
/// Solid angle of the whole map's area at its equator.
constexpr float kMapMeasure = 2.0f * kPi * kPi;

float meanOf(vec3 v) { return (v.x + v.y + v.z) / 3.0f; }

vec3 lookUp(const Image& image, vec2 uv) {
  const MapTexels t(uv, image.width, image.height);
  const vec3 upper = mix(image.at(t.x[0], t.y[0]), image.at(t.x[1], t.y[0]), t.weight.x);
  const vec3 lower = mix(image.at(t.x[0], t.y[1]), image.at(t.x[1], t.y[1]), t.weight.x);
  return mix(upper, lower, t.weight.y);
}

/// Mean of mapSine() over the heights at which a row is seen, weighted as the interpolation does.
float rowSine(int row, int height) {
  constexpr int kSteps = 64;
  float sum = 0.0f;
  for (int i = 0; i < kSteps; ++i) {
    const float offset = (float(i) + 0.5f) * (2.0f / float(kSteps)) - 1.0f;
    const float y = float(row) + 0.5f + offset;
    const bool held = (row == 0 && offset < 0.0f) || (row == height - 1 && offset > 0.0f);
    const float weight = held ? (y > 0.0f && y < float(height) ? 1.0f : 0.0f) : 1.0f - abs(offset);
    sum += weight * mapSine(y / float(height));
  }
  return sum * (2.0f / float(kSteps));
}

/// Density per solid angle of one per area of the map, there.
float perSolidAngle(float density, vec2 uv) { return density / (kMapMeasure * max(mapSine(uv.y), 1e-12f)); }

/// Towards the environment.
vec3 worldDirection(const Light& light, vec2 uv) { return normalize(worldFromMap(light, mapDirection(uv))); }

}  // namespace

void prepareEnvironment(EnvironmentMap& map, const Light& light, const Bounds& bounds) {
  const Image& image = map.radiance;
  const vec3 halfSize = 0.5f * bounds.size();
  const auto fillSeen = [&](int y, float* weights) {
    const float sine = rowSine(y, image.height);
    for (int x = 0; x < image.width; ++x) weights[x] = meanOf(image.at(x, y) * light.colour) * sine;
  };
  map.seen = TexelDistribution(image.width, image.height, fillSeen);
  std::vector<vec2> longitudes;
  for (int x = 0; x < image.width; ++x) {
    const vec3 d = mapDirection(vec2((float(x) + 0.5f) / float(image.width), 0.5f));
    longitudes.emplace_back(d.x, d.z);
  }
  map.entering = TexelDistribution(image.width, image.height, [&](int y, float* weights) {
    fillSeen(y, weights);
    const vec3 middle = mapDirection(vec2(0.5f, (float(y) + 0.5f) / float(image.height)));
    const float sine = -middle.z;
    for (int x = 0; x < image.width; ++x) {
      const vec3 d = worldFromMap(light, vec3(sine * longitudes[x].x, middle.y, sine * longitudes[x].y));
      weights[x] *= boxOutline(d, halfSize);
    }
  });
}

float environmentPower(const EnvironmentMap& map) {
  return float(map.entering.total() * double(kMapMeasure) /
               (double(map.radiance.width) * double(map.radiance.height)));
}

vec3 environmentRadiance(const EnvironmentMap& map, const Light& light, vec3 direction) {
  if (light.mapped == 0u) return light.colour;
  return light.colour * lookUp(map.radiance, mapUv(mapFromWorld(light, direction)));
}

EnvironmentView viewEnvironment(const EnvironmentMap& map, const Light& light, vec3 direction, vec3 normal) {
  const float cosinePdf = max(dot(direction, normal), 0.0f) * kInvPi;
  if (light.mapped == 0u) return {light.colour, cosinePdf};
  const vec2 uv = mapUv(mapFromWorld(light, direction));
  const float mapPdf = perSolidAngle(map.seen.density(uv), uv);
  return {light.colour * lookUp(map.radiance, uv), mix(mapPdf, cosinePdf, kCosineShare)};
}

LightSample sampleEnvironmentLight(const EnvironmentMap& map, const Light& light, vec3 normal, vec3 u) {
  LightSample s = sampleEnvironment(light, normal, vec2(u.y, u.z));
  if (light.mapped == 0u) return s;
  if (u.x >= kCosineShare) s.wi = worldDirection(light, map.seen.sample(vec2(u.y, u.z)).uv);
  const EnvironmentView view = viewEnvironment(map, light, s.wi, normal);
  s.radiance = view.radiance;
  s.pdf = view.pdf;
  return s;
}

EmittedPhoton emitFromMap(const EnvironmentMap& map, const Light& light, vec3 centre, vec3 halfSize,
                          vec2 uPosition, vec2 uDirection) {
  const TexelDistribution::Point point = map.entering.sample(uDirection);
  EmittedPhoton e;
  e.direction = -worldDirection(light, point.uv);
  e.origin = originBeforeBox(e.direction, centre, halfSize, uPosition);
  const float pdf = perSolidAngle(point.density, point.uv);
  const vec3 radiance = light.colour * lookUp(map.radiance, point.uv);
  e.power = pdf > 0.0f ? radiance * (boxOutline(e.direction, halfSize) / pdf) : vec3(0.0f);
  return e;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/rng.shared.h"
#include "stages/cull/cull.h"

#include <algorithm>
#include <numeric>

namespace isophote {

namespace {

/// Stands for this stage where random numbers are keyed by light.
constexpr std::uint32_t kCullStream = 0xfffffffbu;
/// Nearer lights count as if they were so far away [m].
constexpr float kNearestLight = 0.1f;

float distanceTo(const Scene& scene, const Light& light, vec3 eye) {
  switch (light.type) {
    case kLightDirectional:
    case kLightEnvironment:
      return 0.0f;
    case kLightRectangle:
      return length(light.position + 0.5f * (light.edgeU + light.edgeV) - eye);
    case kLightMesh: {
      float nearest = 1e30f;
      for (std::uint32_t i = 0; i < light.triangleCount; ++i)
        nearest = std::min(nearest, length(scene.emissiveTriangles[light.firstTriangle + i].v0 - eye));
      return nearest;
    }
    default:
      return length(light.position - eye);
  }
}

}  // namespace

void Cull::lights(const Scene& scene, std::span<const Light> lights, vec3 eye,
                  std::vector<std::uint8_t>& stays, Stats& stats) const {
  stays.assign(lights.size(), 1);
  std::vector<double> brightness(lights.size());
  std::vector<std::uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const float distance = distanceTo(scene, lights[i], eye);
    // What has no place is as bright everywhere as it is here.
    const bool placed = lights[i].type != kLightDirectional && lights[i].type != kLightEnvironment;
    const double near = placed ? double(std::max(distance, kNearestLight)) : 1.0;
    brightness[i] = double(lights[i].power) / (near * near);
    if (settings_.distance > 0.0f && distance > settings_.distance) stays[i] = 0;
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return brightness[a] < brightness[b]; });
  double budget = double(settings_.lights) * std::accumulate(brightness.begin(), brightness.end(), 0.0);
  for (const std::uint32_t i : order) {
    budget -= brightness[i];
    if (budget < 0) break;
    stays[i] = 0;
  }
  if (!order.empty() && std::ranges::count(stays, 1) == 0) stays[order.back()] = 1;
  double leftOut = 0;
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (stays[i] == 0) leftOut += double(lights[i].power);
  stats.setCounter("cull.lightsLeftOut", double(std::ranges::count(stays, 0)));
  stats.setCounter("cull.lightPowerLeftOut", leftOut);
}

void Cull::photons(vec3 eye, std::uint32_t seed, PhotonMap& map, Stats& stats) const {
  if (!(settings_.distance > 0.0f) && !(settings_.photons > 0.0f)) return;
  const auto scope = stats.scope("cull");
  double sum = 0;
  for (const Photon& photon : map.photons) sum += double(meanOf(photon.power));
  const float least = settings_.photons * float(sum / double(std::max<std::size_t>(map.photons.size(), 1)));
  const float farthest2 = settings_.distance > 0.0f ? settings_.distance * settings_.distance : 1e38f;
  double leftOut = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < map.photons.size(); ++i) {
    Photon photon = map.photons[i];
    const float power = meanOf(photon.power);
    PhotonFootprint* footprint = map.footprints.empty() ? nullptr : &map.footprints[kept];
    if (footprint) *footprint = map.footprints[i];
    const vec3 d = photon.position - eye;
    if (dot(d, d) > farthest2) {
      leftOut += double(power);
      continue;
    }
    if (power < least) {
      const float survival = power / least;
      const std::uint32_t key = pathKey(seed, 0, kCullStream, std::uint32_t(i));
      if (random3(key, 0, 0).x >= survival) continue;
      photon.power /= survival;
      if (footprint) {
        footprint->axisX /= std::sqrt(survival);
        footprint->axisY /= std::sqrt(survival);
      }
    }
    map.photons[kept++] = photon;
  }
  map.photons.resize(kept);
  if (!map.footprints.empty()) map.footprints.resize(kept);
  stats.setCounter("cull.photonPowerLeftOut", leftOut);
  stats.setCounter("cull.photonsKept", double(kept));
}

}  // namespace isophote

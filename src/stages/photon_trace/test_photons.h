// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of photons share.
#pragma once

#include "scene/builtin/builtin.h"
#include "scene/builtin/shapes.h"
#include "stages/photon_trace/photon_trace.h"

#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace isophote {

inline Scene builtinScene(const std::string& name) {
  Scene scene = findBuiltinScene(name)->make();
  finishScene(scene, name);
  return scene;
}

struct TraceOptions {
  std::uint32_t photons = 50'000;
  std::uint32_t photonsStored = 0;
  std::uint32_t bounces = 3;
  std::uint32_t seed = 1;
  std::uint32_t pass = 0;
};

inline PhotonMap traced(const Scene& scene, const TraceOptions& o = {}, const Job& job = {}) {
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = o.photons, .photonsStored = o.photonsStored});
  PhotonMap map;
  Stats stats;
  stage.run({.trace = trace, .seed = o.seed, .pass = o.pass, .bounces = o.bounces}, map, stats, job);
  return map;
}

inline double meanPower(const Photon& p) { return double(p.power.x + p.power.y + p.power.z) / 3; }

inline double storedPower(const PhotonMap& map, std::uint32_t bounce) {
  double sum = 0;
  for (const Photon& p : map.photons)
    if (p.bounce == bounce) sum += meanPower(p);
  return sum;
}

inline Light pointLight(vec3 position, vec3 watts) {
  Light light{};
  light.type = kLightPoint;
  light.position = position;
  light.colour = watts / (4.0f * kPi);
  return light;
}

/// A floor at y = 0 and the lights given.
inline Scene floorScene(float halfSide, std::vector<Light> lights, vec3 albedo = vec3(0.5f)) {
  Scene scene;
  Mesh floor;
  addQuad(floor, {-halfSide, 0, halfSide}, {2 * halfSide, 0, 0}, {0, 0, -2 * halfSide});
  addObject(scene, "floor", addMaterial(scene, lambert("grey", albedo)), std::move(floor));
  scene.lights = std::move(lights);
  return scene;
}

inline bool sameBytes(const PhotonMap& a, const PhotonMap& b) {
  return a.photons.size() == b.photons.size() &&
         std::memcmp(a.photons.data(), b.photons.data(), a.photons.size() * sizeof(Photon)) == 0;
}

}  // namespace isophote

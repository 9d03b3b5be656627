// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"
#include "physics/emission.shared.h"
#include "scene/texel_distribution.h"

namespace isophote {

struct Bounds;
struct Scene;

/// A lat-long picture of the light that comes from outside of the scene, and what chooses directions by it.
struct EnvironmentMap {
  Image radiance;  ///< [W/(m^2 sr)], to be multiplied by the light's colour; no value negative or infinite.
  /// By the radiance that comes from a direction, and that times the area of the scene's bounds that it
  /// meets. finishScene() makes them.
  TexelDistribution seen;
  TexelDistribution entering;

  bool empty() const { return radiance.pixels.empty(); }
  std::uint64_t bytes() const {
    return radiance.pixels.size() * sizeof(vec3) + seen.bytes() + entering.bytes();
  }
};

/// What the sampling of an environment makes of one direction towards it.
struct EnvironmentView {
  vec3 radiance;
  float pdf;  ///< sampleEnvironmentLight()'s density of the direction, per solid angle.
};

/// Makes the map's distributions for the environment light that it belongs to.
void prepareEnvironment(EnvironmentMap& map, const Light& light, const Bounds& bounds);

/// Power through the bounds, mean of RGB [W].
float environmentPower(const EnvironmentMap& map);

/// Radiance that comes from a direction, of an environment with or without a map.
vec3 environmentRadiance(const EnvironmentMap& map, const Light& light, vec3 direction);

EnvironmentView viewEnvironment(const EnvironmentMap& map, const Light& light, vec3 direction, vec3 normal);

/// A sample of the environment for a surface of that normal: constant ones by the cosine; of a map half of
/// the samples by the cosine and half by the map, weighted against each other (u.x chooses).
LightSample sampleEnvironmentLight(const EnvironmentMap& map, const Light& light, vec3 normal, vec3 u);

/// A photon of an environment with a map that enters the box (centre, halfSize). Photons of a grey map carry
/// nearly the same power.
EmittedPhoton emitFromMap(const EnvironmentMap& map, const Light& light, vec3 centre, vec3 halfSize,
                          vec2 uPosition, vec2 uDirection);

}  // namespace isophote

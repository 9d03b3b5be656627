// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/stats.h"
#include "scene/scene.h"
#include "settings/visit.h"
#include "stages/photon_trace/photon_map.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote {

struct CullSettings {
  float distance = 0;
  float lights = 0;
  float photons = 0;

  void visit(auto&& v) {
    v("distance", distance,
      {.help = "Lights and photons farther from the eye are left out, directional and environment lights "
               "never; 0: none.",
       .unit = "m",
       .min = 0,
       .max = 1e9});
    v("lights", lights,
      {.help =
           "Part of the lights that may be left out, the faintest first, measured by their power over the "
           "square of their distance from the eye; 0: none.",
       .min = 0,
       .max = 0.99});
    v("photons", photons,
      {.help = "Photons of less than this multiple of the mean power are thinned out at random; those that "
               "stay make up for the others; 0: none.",
       .min = 0,
       .max = 10});
  }
};

/// Leaves out what costs time and shows little: lights and photons that are far away or faint. Off by
/// default. What is cut off by distance and faintness of lights is missing from the picture, and counted:
/// counters cull.lightsLeftOut, cull.lightPowerLeftOut and cull.photonPowerLeftOut [W]. Thinning photons
/// keeps the expectation.
class Cull {
 public:
  explicit Cull(CullSettings settings) : settings_(settings) {}

  bool cullsLights() const { return settings_.distance > 0.0f || settings_.lights > 0.0f; }

  /// By light, 1 where it stays. At least one light stays.
  void lights(const Scene& scene, std::span<const Light> lights, vec3 eye, std::vector<std::uint8_t>& stays,
              Stats& stats) const;

  /// Takes photons out of the map; the order of the others, and the map's account, stay. Random numbers are
  /// keyed by the photons' places.
  void photons(vec3 eye, std::uint32_t seed, PhotonMap& map, Stats& stats) const;

 private:
  CullSettings settings_;
};

}  // namespace isophote

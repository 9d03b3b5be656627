// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/lanes.h"
#include "math/rng.shared.h"
#include "math/simd.h"
#include "math/sobol.shared.h"
#include "physics/light.shared.h"
#include "scene/scene.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

#include <cstdint>

namespace isophote::direct {

/// What a light, or a sample of one that has an area, sends to the eye by way of each view sample of a tile,
/// were nothing between them.
struct LightLanes {
  Vec3Lanes<kTileLanes> radiance;     ///< [W/(m^2 sr)].
  Vec3Lanes<kTileLanes> origin;       ///< Of the shadow ray, off the surface.
  Vec3Lanes<kTileLanes> wi;           ///< Unit, towards the light.
  Lanes<float, kTileLanes> distance;  ///< To just before it.
  std::uint64_t lit = 0;              ///< Lanes where there is any.
};

/// The part of a light that arrives at each lane.
using LightVisibility = Lanes<float, kTileLanes>;

/// Adds what arrives.
void addVisible(const LightLanes& lanes, const LightVisibility& visible, RadianceTile& out,
                SimdLevel level = bestSimdLevel());

/// True points, spots and directional lights.
bool hasNoExtent(const Light& light);

/// Stands for this stage where random numbers are keyed by light.
inline constexpr std::uint32_t kDirectStream = 0xfffffffdu;

/// Reflections up to this GGX alpha are sampled by the BSDF too: samples of the light alone rarely meet their
/// peak.
SHARED_CONST float kSharpAlpha = 0.3f;
SHARED_FN bool reflectsSharply(const Bsdf& b) {
  return b.alpha > 0.0f && b.alpha < kSharpAlpha && b.f90 > 0.0f;
}

/// Key of the random numbers by which a lane samples lights. Secondary samples share pixels: the lane keeps
/// theirs apart.
SHARED_FN std::uint32_t laneKey(std::uint32_t seed, std::uint32_t pass, std::uint32_t lane,
                                std::uint32_t pixel) {
  return pathKey(seed, pass, kDirectStream ^ (lane << 8), pixel);
}

/// How one lane's samples of a light are scrambled (owenScramble), a seed for each dimension.
SHARED_FN uvec3 lightScramble(std::uint32_t key, std::uint32_t light) {
  const uvec3 hash = hash3(uvec3(key, light, 0u));
  return uvec3(hash.z, hash.x, hash.y);
}
/// Sample `index` of all that are stratified together, before scrambling.
SHARED_FN uvec3 unscrambledSample(std::uint32_t index) {
  return uvec3(sobolBits(index, 2), sobolBits(index, 0), sobolBits(index, 1));
}
SHARED_FN vec3 scrambled(uvec3 bits, uvec3 scramble) {
  return vec3(unitFloat(owenScramble(bits.x, scramble.x)), unitFloat(owenScramble(bits.y, scramble.y)),
              unitFloat(owenScramble(bits.z, scramble.z)));
}

struct ScrambleLanes {
  Lanes<std::uint32_t, kTileLanes> x, y, z;
};

/// For a light that has no extent, and a tile that does not transmit.
void lightTile(const Light& light, const ViewTile& tile, LightLanes& out, SimdLevel level = bestSimdLevel());

/// All that have an area but environments with a map; `size` is that which a light without one is given.
bool isSampledInLanes(const Light& light, float size = 0.0f);

/// A light that isSampledInLanes(), as each lane of a tile that does not transmit samples it. Where a lane
/// reflects sharply its samples are weighted against those of its BSDF (balance heuristic).
class AreaLanes {
 public:
  struct In {
    const Scene& scene;
    const Light& light;
    const ViewTile& tile;
    std::uint32_t seed = 0;
    std::uint32_t pass = 0;
    std::uint32_t index = 0;    ///< Of the light.
    std::uint32_t samples = 1;  ///< From each lane, of which each brings its part.
    SimdLevel simd = bestSimdLevel();
    float size = 0;  ///< Given to a light that has no extent, as of SoftLight.
  };
  explicit AreaLanes(const In& in);
  void sample(std::uint32_t index, LightLanes& out) const;

 private:
  In in_;
  ScrambleLanes scramble_;
};

}  // namespace isophote::direct

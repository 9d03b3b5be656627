// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_directional/leaf_light.h"

#include <algorithm>
#include <bit>
#include <iterator>

namespace isophote::photon_directional {
namespace {

constexpr int kGroup = 16;
constexpr float kLeastLight = 1e-30f;  // Irradiance below which shading normals change nothing.

/// Reflectance towards the eye of light from everywhere on its side, over pi.
SHARED_FN vec3 reflectanceOf(Bsdf b, float cosO) {
  const float meanFresnel = b.coupling0 + (b.coupling90 - b.coupling0) * (1.0f / 21.0f);
  const float glossy = b.alpha > 0.0f && b.f90 > 0.0f ? 1.0f : 0.0f;
  const vec3 mirror(schlick(b.f0.x, b.f90, cosO), schlick(b.f0.y, b.f90, cosO), schlick(b.f0.z, b.f90, cosO));
  return (b.diffuse * (couplingFactor(b, cosO) * (1.0f - meanFresnel)) + mirror * glossy) * kInvPi;
}

SHARED_FN void reflectBody(const ViewTile& tile, RadianceTile& out) {
  if (tile.lambertian != 0) {
    for (int i = 0; i < kTileLanes; ++i) {
      out.r[i] = tile.diffuseR[i] * kInvPi;
      out.g[i] = tile.diffuseG[i] * kInvPi;
      out.b[i] = tile.diffuseB[i] * kInvPi;
    }
    return;
  }
  for (int i = 0; i < kTileLanes; ++i) {
    const Bsdf b = reflectionOf(tile, i);
    const vec3 wo = woOf(tile, i), ns = nsOf(tile, i);
    const vec3 reflectance = reflectanceOf(b, abs(dot(wo, ns)));
    out.r[i] = reflectance.x;
    out.g[i] = reflectance.y;
    out.b[i] = reflectance.z;
  }
}

/// Light of one lane.
struct Sum {
  float r = 0, g = 0, b = 0;
};

/// Light of the lanes of a group.
struct Sums {
  float r[kGroup], g[kGroup], b[kGroup];

  SHARED_FN void set(int i, const Sum& sum) {
    r[i] = sum.r;
    g[i] = sum.g;
    b[i] = sum.b;
  }
};

/// Of each octant: its light over what the leaf sees of it, for the loops over lanes to weigh.
struct OctantLights {
  float r[kOctants], g[kOctants], b[kOctants];

  SHARED_FN void set(int octant, const LeafLight& light, float scale) {
    r[octant] = light.r[octant] * scale;
    g[octant] = light.g[octant] * scale;
    b[octant] = light.b[octant] * scale;
  }
  SHARED_FN void addTo(Sum& sum, int octant, float weight) const {
    sum.r += weight * r[octant];
    sum.g += weight * g[octant];
    sum.b += weight * b[octant];
  }
};

/// Calls each(octant) for so many octants, without a loop, which would keep the loop over lanes around it
/// from being vectorised.
template <int kCount, class Each>
SHARED_FN void forOctants(Each&& each) {
  each(kCount - 1);
  if constexpr (kCount > 1) forOctants<kCount - 1>(each);
}

SHARED_FN void seeBody(const ViewTile& tile, std::uint64_t lanes, float* seen) {
  float sums[kOctants][kGroup] = {};
  for (int first = 0; first < kTileLanes; first += kGroup) {
    const std::uint32_t bits = std::uint32_t(lanes >> first) & ((1u << kGroup) - 1u);
    if (bits == 0) continue;
    for (int i = 0; i < kGroup; ++i) {
      const vec3 n = ngOf(tile, first + i);
      const float half = (bits & (1u << i)) != 0 ? 0.5f : 0.0f;
      forOctants<kOctantPairs>([&](int pair) __attribute__((always_inline)) {
        const vec3 m = n * octantSigns(uint(pair));
        const float magnitude = octantMagnitude(m), balance = octantBalance(m);
        sums[pair][i] += half * (magnitude + balance);
        sums[kOctants - 1 - pair][i] += half * (magnitude - balance);
      });
    }
  }
  for (int o = 0; o < kOctants; ++o) {
    for (int width = kGroup / 2; width > 0; width /= 2)
      for (int i = 0; i < width; ++i) sums[o][i] += sums[o][i + width];
    seen[o] += sums[o][0];
  }
}

SHARED_FN void putChannel(std::uint32_t lanes, const float* geometric, const float* shading, bool flat,
                          float* light, float* factor) {
  for (int i = 0; i < kGroup; ++i) {
    const bool in = (lanes & (1u << i)) != 0;
    light[i] = in ? geometric[i] : light[i];
  }
  if (flat) return;
  for (int i = 0; i < kGroup; ++i) {
    const bool in = (lanes & (1u << i)) != 0;
    const float change = (shading[i] + kLeastLight) / (geometric[i] + kLeastLight);
    factor[i] *= in ? change : 1.0f;
  }
}

SHARED_FN void put(std::uint32_t lanes, int first, const Sums& geometric, const Sums& shading, bool flat,
                   RadianceTile& irradiance, RadianceTile& reflectance) {
  putChannel(lanes, geometric.r, shading.r, flat, irradiance.r + first, reflectance.r + first);
  putChannel(lanes, geometric.g, shading.g, flat, irradiance.g + first, reflectance.g + first);
  putChannel(lanes, geometric.b, shading.b, flat, irradiance.b + first, reflectance.b + first);
}

/// What shading normals make of the light where the geometric normal is everywhere the same.
SHARED_FN void shadeNarrow(const ViewTile& tile, const OctantLights& pairs, int first, Sums& shading) {
  for (int i = 0; i < kGroup; ++i) {
    const vec3 n = nsOf(tile, first + i);
    Sum sum;
    forOctants<kOctantPairs>([&](int pair) __attribute__((always_inline)) {
      pairs.addTo(sum, pair, octantMagnitude(n * octantSigns(uint(pair))));
    });
    shading.set(i, sum);
  }
}

SHARED_FN void shadeFlat(const ViewTile& tile, const OctantLights& octants, int first, Sums& geometric) {
  for (int i = 0; i < kGroup; ++i) {
    const vec3 n = ngOf(tile, first + i);
    Sum sum;
    forOctants<kOctantPairs>([&](int pair) __attribute__((always_inline)) {
      const vec3 m = n * octantSigns(uint(pair));
      const float magnitude = octantMagnitude(m), balance = octantBalance(m);
      octants.addTo(sum, pair, magnitude + balance);
      octants.addTo(sum, kOctants - 1 - pair, magnitude - balance);
    });
    geometric.set(i, sum);
  }
}

SHARED_FN void shadeWide(const ViewTile& tile, const OctantLights& octants, int first, Sums& shading) {
  for (int i = 0; i < kGroup; ++i) {
    const vec3 n = ngOf(tile, first + i), ns = nsOf(tile, first + i);
    Sum sum;
    forOctants<kOctantPairs>([&](int pair) __attribute__((always_inline)) {
      const vec3 signs = octantSigns(uint(pair));
      const vec3 m = n * signs;
      const float magnitude = octantMagnitude(m), balance = octantBalance(m);
      const float change = octantMagnitude(ns * signs) / magnitude;
      octants.addTo(sum, pair, (magnitude + balance) * change);
      octants.addTo(sum, kOctants - 1 - pair, (magnitude - balance) * change);
    });
    shading.set(i, sum);
  }
}

SHARED_FN void shadeBody(const ViewTile& tile, const LeafLanes& leaf, const LeafLight& light,
                         const OctantRule&, RadianceTile& irradiance, RadianceTile& reflectance) {
  OctantLights octants;
  Sums geometric, shading;
  if (leaf.narrow) {
    OctantLights seen;
    Sum all;
    for (int o = 0; o < kOctants; ++o) {
      seen.set(o, light, light.inverseSeen[o] > 0.0f ? 1.0f : 0.0f);
      seen.addTo(all, o, 1.0f);
    }
    for (int pair = 0; pair < kOctantPairs; ++pair) {
      const float scale = 1.0f / octantMagnitude(leaf.axis * octantSigns(uint(pair)));
      octants.r[pair] = (seen.r[pair] + seen.r[kOctants - 1 - pair]) * scale;
      octants.g[pair] = (seen.g[pair] + seen.g[kOctants - 1 - pair]) * scale;
      octants.b[pair] = (seen.b[pair] + seen.b[kOctants - 1 - pair]) * scale;
    }
    for (int i = 0; i < kGroup; ++i) geometric.set(i, all);
  } else {
    for (int o = 0; o < kOctants; ++o) octants.set(o, light, 0.5f * light.inverseSeen[o]);
  }
  for (int first = 0; first < kTileLanes; first += kGroup) {
    const std::uint32_t bits = std::uint32_t(leaf.lanes >> first) & ((1u << kGroup) - 1u);
    if (bits == 0) continue;
    if (!leaf.narrow) shadeFlat(tile, octants, first, geometric);
    if (!leaf.flat && !leaf.narrow) shadeWide(tile, octants, first, shading);
    if (!leaf.flat && leaf.narrow) shadeNarrow(tile, octants, first, shading);
    put(bits, first, geometric, shading, leaf.flat, irradiance, reflectance);
  }
}

SHARED_FN void shadePublishedBody(const ViewTile& tile, const LeafLanes& leaf, const LeafLight& light,
                                  const OctantRule& rule, RadianceTile& irradiance,
                                  RadianceTile& reflectance) {
  OctantLights octants;
  for (int o = 0; o < kOctants; ++o) octants.set(o, light, 1.0f);
  for (int first = 0; first < kTileLanes; first += kGroup) {
    const std::uint32_t bits = std::uint32_t(leaf.lanes >> first) & ((1u << kGroup) - 1u);
    if (bits == 0) continue;
    Sums geometric, shading;
    for (int i = 0; i < kGroup; ++i) {
      const vec3 n = ngOf(tile, first + i), ns = nsOf(tile, first + i);
      Sum sum, shadingSum;
      forOctants<kOctants>([&](int o) __attribute__((always_inline)) {
        octants.addTo(sum, o, publishedOctantWeight(n, rule.middles[o]));
        octants.addTo(shadingSum, o, publishedOctantWeight(ns, rule.middles[o]));
      });
      geometric.set(i, sum);
      shading.set(i, shadingSum);
    }
    put(bits, first, geometric, shading, leaf.flat, irradiance, reflectance);
  }
}

ISOPHOTE_SIMD(reflectTile, reflectBody, (const ViewTile& tile, RadianceTile& reflectance),
              (tile, reflectance))
ISOPHOTE_SIMD(seeNormals, seeBody, (const ViewTile& tile, std::uint64_t lanes, float* seen),
              (tile, lanes, seen))
#define ISOPHOTE_SHADE(name, body)                                                             \
  ISOPHOTE_SIMD(name, body,                                                                    \
                (const ViewTile& tile, const LeafLanes& leaf, const LeafLight& light,          \
                 const OctantRule& rule, RadianceTile& irradiance, RadianceTile& reflectance), \
                (tile, leaf, light, rule, irradiance, reflectance))
ISOPHOTE_SHADE(shadeByPart, shadeBody)
ISOPHOTE_SHADE(shadeByPublished, shadePublishedBody)
#undef ISOPHOTE_SHADE

/// Irradiance from the side of a normal.
vec3 irradianceAt(vec3 n, const LeafLight& light, const OctantRule& rule) {
  vec3 sum(0.0f);
  for (int o = 0; o < kOctants; ++o) {
    const float weight = rule.published ? publishedOctantWeight(n, rule.middles[o])
                                        : octantIrradiance(uint(o), n) * light.inverseSeen[o];
    sum += vec3(light.r[o], light.g[o], light.b[o]) * weight;
  }
  return sum;
}

}  // namespace

vec3 LeafLight::sum() const {
  vec3 all(0.0f);
  for (int o = 0; o < kOctants; ++o) all += vec3(r[o], g[o], b[o]);
  return all;
}

ReflectFn reflectFor(SimdLevel level) { return reflectTileFor(level); }
SeeFn seeFor(SimdLevel level) { return seeNormalsFor(level); }
ShadeFn shadeFor(const OctantRule& rule, SimdLevel level) {
  return rule.published ? shadeByPublishedFor(level) : shadeByPartFor(level);
}

void shadeAlike(std::uint64_t lanes, vec3 light, RadianceTile& irradiance) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const bool in = (lanes >> lane & 1u) != 0;
    irradiance.r[lane] = in ? light.x : irradiance.r[lane];
    irradiance.g[lane] = in ? light.y : irradiance.g[lane];
    irradiance.b[lane] = in ? light.z : irradiance.b[lane];
  }
}

void shadeTransmitting(const ViewTile& tile, std::uint64_t lanes, const LeafLight& light,
                       const OctantRule& rule, RadianceTile& irradiance, RadianceTile& reflectance) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    const ViewSample s = laneOf(tile, lane);
    const float cosO = abs(dot(s.wo, s.ns));
    vec3 reflected(reflectance.r[lane], reflectance.g[lane], reflectance.b[lane]);
    vec3 refracted(0.0f), behind(0.0f);
    const vec3 before = irradianceAt(s.ng, light, rule);
    if (refractsRoughly(s.bsdf) > 0.5f) {
      // Radiance changes on the way out of or into a solid, and the boundary reflects as a clear one does.
      const bool thin = (s.bsdf.flags & kMaterialThinWalled) != 0u;
      const float eta = thin ? 1.0f : s.entering > 0.5f ? 1.0f / s.bsdf.ior : s.bsdf.ior;
      reflected += mirrorReflectance(s.bsdf, cosO, s.entering) * kInvPi -
                   vec3(schlick(s.bsdf.f0.x, s.bsdf.f90, cosO), schlick(s.bsdf.f0.y, s.bsdf.f90, cosO),
                        schlick(s.bsdf.f0.z, s.bsdf.f90, cosO)) *
                       kInvPi;
      refracted = refractedPart(s.bsdf, cosO, s.entering) * (eta * eta * kInvPi);
      behind = irradianceAt(-s.ng, light, rule);
    }
    const vec3 all = before + behind;
    const vec3 shown = reflected * before + refracted * behind;
    float* const lights[] = {irradiance.r, irradiance.g, irradiance.b};
    float* const factors[] = {reflectance.r, reflectance.g, reflectance.b};
    for (int c = 0; c < 3; ++c) {
      lights[c][lane] = all[c];
      factors[c][lane] = all[c] > kLeastLight ? shown[c] / all[c] : reflected[c];
    }
  }
}

}  // namespace isophote::photon_directional

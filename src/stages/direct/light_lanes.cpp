// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/direct/light_lanes.h"

#include "physics/emission.shared.h"
#include "physics/shading_normal.shared.h"
#include "trace/surface.h"

namespace isophote::direct {

namespace {

/// `sample` gives the light from a place, `bsdf` the surface of a lane. Unless it knows that `out` lies
/// apart, the compiler does not vectorise the loop.
template <class Sample, class Surface>
SHARED_FN void lightLanes(const ViewTile& tile, LightLanes& __restrict out, Sample&& sample, Surface&& bsdf) {
  alignas(64) float above[kTileLanes];
  for (int i = 0; i < kTileLanes; ++i) {
    const vec3 position = positionOf(tile, i);
    const vec3 ng = ngOf(tile, i);
    const vec3 ns = nsOf(tile, i);
    const vec3 wo = woOf(tile, i);
    const LightSample l = sample(position);
    const float cosine = abs(dot(l.wi, ns)) * lightFade(l.wi, ng, ns);
    const vec3 radiance = evalBsdf(bsdf(i), l.wi, wo, ng, ns) * l.radiance * cosine;
    const vec3 origin = offsetFrom(position, ng, l.wi);
    above[i] = dot(l.wi, ng) > 0.0f ? maxOf(radiance) : 0.0f;
    out.radiance.set(i, radiance);
    out.origin.set(i, origin);
    out.wi.set(i, l.wi);
    out.distance[i] = l.distance * (1.0f - 1e-4f);
  }
  out.lit = bitsWhere([&](int i) __attribute__((always_inline)) {
    return above[i] > 0.0f && tile.pixel[i] != kNoPixel;
  });
}

template <class Surface>
SHARED_FN void lightBy(const Light& light, const ViewTile& tile, LightLanes& out, Surface&& bsdf) {
  if (light.type == kLightPoint) {
    // A point's radius is 0: so that the compiler knows it and drops all that is about spheres.
    Light point = light;
    point.radius = 0.0f;
    lightLanes(
        tile,
        out, [&](vec3 from) __attribute__((always_inline)) { return samplePoint(point, from, vec2(0.5f)); },
        bsdf);
  } else if (light.type == kLightSpot) {
    lightLanes(
        tile, out, [&](vec3 from) __attribute__((always_inline)) { return sampleSpot(light, from); }, bsdf);
  } else {
    lightLanes(
        tile, out, [&](vec3) __attribute__((always_inline)) { return sampleDirectional(light); }, bsdf);
  }
}

SHARED_FN void lambertianBody(const Light& light, const ViewTile& tile, LightLanes& out) {
  lightBy(
      light, tile, out, [&](int i) __attribute__((always_inline)) {
        Bsdf b{};
        b.diffuse = diffuseOf(tile, i);
        return b;
      });
}

SHARED_FN void glossyBody(const Light& light, const ViewTile& tile, LightLanes& out) {
  lightBy(
      light, tile, out, [&](int i) __attribute__((always_inline)) { return reflectionOf(tile, i); });
}

SHARED_FN void addVisibleBody(const LightLanes& lanes, const LightVisibility& visible,
                              RadianceTile& __restrict out) {
  for (int i = 0; i < kTileLanes; ++i) {
    const vec3 radiance = lanes.radiance[i] * visible[i];
    out.r[i] += visible[i] > 0.0f ? +radiance.x : 0.0f;
    out.g[i] += visible[i] > 0.0f ? +radiance.y : 0.0f;
    out.b[i] += visible[i] > 0.0f ? +radiance.z : 0.0f;
  }
}

ISOPHOTE_SIMD(addVisibleLanes, addVisibleBody,
              (const LightLanes& lanes, const LightVisibility& visible, RadianceTile& out),
              (lanes, visible, out))
ISOPHOTE_SIMD(lightLambertian, lambertianBody, (const Light& light, const ViewTile& tile, LightLanes& out),
              (light, tile, out))
ISOPHOTE_SIMD(lightGlossy, glossyBody, (const Light& light, const ViewTile& tile, LightLanes& out),
              (light, tile, out))

}  // namespace

void addVisible(const LightLanes& lanes, const LightVisibility& visible, RadianceTile& out, SimdLevel level) {
  addVisibleLanesFor(level)(lanes, visible, out);
}

bool hasNoExtent(const Light& light) {
  return light.type == kLightSpot || light.type == kLightDirectional ||
         (light.type == kLightPoint && light.radius == 0.0f);
}

void lightTile(const Light& light, const ViewTile& tile, LightLanes& out, SimdLevel level) {
  (tile.lambertian != 0 ? lightLambertianFor(level) : lightGlossyFor(level))(light, tile, out);
}

}  // namespace isophote::direct

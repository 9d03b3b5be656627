// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/direct/light_lanes.h"

#include "physics/emission.shared.h"
#include "physics/shading_normal.shared.h"
#include "scene/mesh_emission.h"
#include "stages/direct/soft_light.shared.h"
#include "trace/surface.h"

namespace isophote::direct {

namespace {

/// `sample` gives lane i's sample of the light, `bsdf` its surface and `share` what of the sample's light
/// over its density counts. Unless it knows that `out` lies apart, the compiler does not vectorise the loop.
template <class Sample, class Surface, class Share>
SHARED_FN void lightLanes(const ViewTile& tile, LightLanes& __restrict out, Sample&& sample, Surface&& bsdf,
                          Share&& share) {
  alignas(64) float above[kTileLanes];
  for (int i = 0; i < kTileLanes; ++i) {
    const vec3 position = positionOf(tile, i);
    const vec3 ng = ngOf(tile, i);
    const vec3 ns = nsOf(tile, i);
    const vec3 wo = woOf(tile, i);
    const LightSample l = sample(i);
    const Bsdf surface = bsdf(i);
    const float cosine = abs(dot(l.wi, ns)) * lightFade(l.wi, ng, ns) * share(i, l, surface);
    const vec3 radiance = evalBsdf(surface, l.wi, wo, ng, ns) * l.radiance * cosine;
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

SHARED_FN Bsdf lambertianOf(const ViewTile& tile, int i) {
  Bsdf b{};
  b.diffuse = diffuseOf(tile, i);
  return b;
}

template <class Surface>
SHARED_FN void lightBy(const Light& light, const ViewTile& tile, LightLanes& out, Surface&& bsdf) {
  const auto whole = [](int, const LightSample&, const Bsdf&) __attribute__((always_inline)) { return 1.0f; };
  if (light.type == kLightPoint) {
    // A point's radius is 0: so that the compiler knows it and drops all that is about spheres.
    Light point = light;
    point.radius = 0.0f;
    lightLanes(
        tile, out,
        [&](int i)
            __attribute__((always_inline)) { return samplePoint(point, positionOf(tile, i), vec2(0.5f)); },
        bsdf, whole);
  } else if (light.type == kLightSpot) {
    lightLanes(
        tile,
        out, [&](int i) __attribute__((always_inline)) { return sampleSpot(light, positionOf(tile, i)); },
        bsdf, whole);
  } else {
    lightLanes(
        tile, out, [&](int) __attribute__((always_inline)) { return sampleDirectional(light); }, bsdf, whole);
  }
}

SHARED_FN void lambertianBody(const Light& light, const ViewTile& tile, LightLanes& out) {
  lightBy(
      light, tile, out, [&](int i) __attribute__((always_inline)) { return lambertianOf(tile, i); });
}

SHARED_FN void glossyBody(const Light& light, const ViewTile& tile, LightLanes& out) {
  lightBy(
      light, tile, out, [&](int i) __attribute__((always_inline)) { return reflectionOf(tile, i); });
}

SHARED_FN void scrambleBody(const AreaLanes::In& in, ScrambleLanes& __restrict out) {
  for (std::uint32_t i = 0; i < std::uint32_t(kTileLanes); ++i) {
    const uvec3 scramble = lightScramble(laneKey(in.seed, in.pass, i, in.tile.pixel[i]), in.index);
    out.x[i] = scramble.x;
    out.y[i] = scramble.y;
    out.z[i] = scramble.z;
  }
}

SHARED_FN void randomBody(uvec3 bits, const ScrambleLanes& scramble, Vec3Lanes<kTileLanes>& __restrict u) {
  for (std::uint32_t i = 0; i < std::uint32_t(kTileLanes); ++i)
    u.set(i, scrambled(bits, uvec3(scramble.x[i], scramble.y[i], scramble.z[i])));
}

/// The triangle of a mesh light that each lane samples: EmissiveTriangle, an array a component.
struct TriangleLanes {
  Vec3Lanes<kTileLanes> v0, edge1, edge2, radiance;
  Lanes<float, kTileLanes> probability;
  Lanes<std::uint32_t, kTileLanes> doubleSided;
};

void chooseTriangles(const Scene& scene, const Light& light, const Vec3Lanes<kTileLanes>& u,
                     TriangleLanes& out) {
  for (std::uint32_t i = 0; i < std::uint32_t(kTileLanes); ++i) {
    const EmissiveTriangle t = litAt(scene, chooseTriangle(scene, light, u.x[i]), vec2(u.y[i], u.z[i]));
    out.v0.set(i, t.v0);
    out.edge1.set(i, t.edge1);
    out.edge2.set(i, t.edge2);
    out.radiance.set(i, t.radiance);
    out.probability[i] = t.probability;
    out.doubleSided[i] = t.doubleSided;
  }
}

SHARED_FN EmissiveTriangle triangleOf(const TriangleLanes& lanes, std::uint32_t i) {
  EmissiveTriangle t{};
  t.v0 = lanes.v0[i];
  t.edge1 = lanes.edge1[i];
  t.edge2 = lanes.edge2[i];
  t.radiance = lanes.radiance[i];
  t.probability = lanes.probability[i];
  t.doubleSided = lanes.doubleSided[i];
  return t;
}

template <class Surface, class Share>
SHARED_FN void sampleBy(const Light& light, float size, const ViewTile& tile, const Vec3Lanes<kTileLanes>& u,
                        const TriangleLanes& triangles, LightLanes& out, Surface&& bsdf, Share&& share) {
  const auto u2 = [&](int i) __attribute__((always_inline)) { return vec2(u.y[i], u.z[i]); };
  if (size > 0.0f) {
    lightLanes(
        tile, out,
        [&](int i) __attribute__((always_inline)) {
          return sampleSoftLight(light, size, positionOf(tile, i), u2(i));
        },
        bsdf, share);
  } else if (light.type == kLightMesh) {
    lightLanes(
        tile, out,
        [&](int i) __attribute__((always_inline)) {
          const EmissiveTriangle t = triangleOf(triangles, i);
          return sampleEmissiveTriangle(t, t.probability, positionOf(tile, i), u2(i));
        },
        bsdf, share);
  } else if (light.type == kLightRectangle) {
    lightLanes(
        tile, out,
        [&](int i)
            __attribute__((always_inline)) { return sampleRectangle(light, positionOf(tile, i), u2(i)); },
        bsdf, share);
  } else if (light.type == kLightPoint) {
    lightLanes(
        tile, out,
        [&](int i) __attribute__((always_inline)) { return samplePoint(light, positionOf(tile, i), u2(i)); },
        bsdf, share);
  } else {
    lightLanes(
        tile, out,
        [&](int i) __attribute__((always_inline)) { return sampleEnvironment(light, ngOf(tile, i), u2(i)); },
        bsdf, share);
  }
}

SHARED_FN void sampleLambertianBody(const Light& light, float size, const ViewTile& tile,
                                    const Vec3Lanes<kTileLanes>& u, const TriangleLanes& triangles,
                                    float count, LightLanes& out) {
  sampleBy(
      light, size, tile, u, triangles,
      out, [&](int i) __attribute__((always_inline)) { return lambertianOf(tile, i); },
      [&](int, const LightSample& l, const Bsdf&)
          __attribute__((always_inline)) { return l.pdf > 0.0f ? 1.0f / (l.pdf * count) : 0.0f; });
}

SHARED_FN void sampleGlossyBody(const Light& light, float size, const ViewTile& tile,
                                const Vec3Lanes<kTileLanes>& u, const TriangleLanes& triangles, float count,
                                LightLanes& out) {
  sampleBy(
      light, size, tile, u, triangles,
      out, [&](int i) __attribute__((always_inline)) { return reflectionOf(tile, i); },
      [&](int i, const LightSample& l, const Bsdf& b) __attribute__((always_inline)) {
        const float other = pdfBsdf(b, l.wi, woOf(tile, i), ngOf(tile, i), nsOf(tile, i), 1.0f);
        const float density = l.pdf * count + (reflectsSharply(b) && !(size > 0.0f) ? other : 0.0f);
        return l.pdf > 0.0f ? 1.0f / density : 0.0f;
      });
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

ISOPHOTE_SIMD(scrambleLanes, scrambleBody, (const AreaLanes::In& in, ScrambleLanes& out), (in, out))
ISOPHOTE_SIMD(randomLanes, randomBody, (uvec3 bits, const ScrambleLanes& scramble, Vec3Lanes<kTileLanes>& u),
              (bits, scramble, u))
ISOPHOTE_SIMD(sampleLambertian, sampleLambertianBody,
              (const Light& light, float size, const ViewTile& tile, const Vec3Lanes<kTileLanes>& u,
               const TriangleLanes& triangles, float count, LightLanes& out),
              (light, size, tile, u, triangles, count, out))
ISOPHOTE_SIMD(sampleGlossy, sampleGlossyBody,
              (const Light& light, float size, const ViewTile& tile, const Vec3Lanes<kTileLanes>& u,
               const TriangleLanes& triangles, float count, LightLanes& out),
              (light, size, tile, u, triangles, count, out))

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

bool isSampledInLanes(const Light& light, float size) {
  if (hasNoExtent(light)) return size > 0.0f;
  return (light.type != kLightEnvironment || light.mapped == 0u);
}

AreaLanes::AreaLanes(const In& in) : in_(in) { scrambleLanesFor(in.simd)(in, scramble_); }

void AreaLanes::sample(std::uint32_t index, LightLanes& out) const {
  Vec3Lanes<kTileLanes> u;
  randomLanesFor(in_.simd)(unscrambledSample(index), scramble_, u);
  TriangleLanes triangles;
  if (in_.light.type == kLightMesh) chooseTriangles(in_.scene, in_.light, u, triangles);
  const auto sampleLanes =
      in_.tile.lambertian != 0 ? sampleLambertianFor(in_.simd) : sampleGlossyFor(in_.simd);
  sampleLanes(in_.light, hasNoExtent(in_.light) ? in_.size : 0.0f, in_.tile, u, triangles, float(in_.samples),
              out);
}

}  // namespace isophote::direct

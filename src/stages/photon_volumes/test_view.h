// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// View samples and photons for the tests and benchmarks of photon_volumes, made without a scene.
#pragma once

#include "math/rng.shared.h"
#include "math/sampling.shared.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_trace/photon_map.h"

#include <algorithm>
#include <cmath>

namespace isophote::photon_volumes_test {

struct ViewOptions {
  int width = 64;
  int height = 48;
  vec3 eye{0.1f, 0.2f, 0.6f};
  vec3 forward{0, 0, -1};
  float orthographic = 0;
  int secondaryTiles = 0;   ///< Scattered over the walls.
  bool lambertian = false;  ///< Every tile; otherwise every third one.
  bool bentNormals = true;  ///< Shading normals differ from the geometric ones.
  std::uint32_t seed = 1;
};

/// A point on the inside of the cube [-1, 1]^3.
struct WallPoint {
  vec3 position;
  vec3 normal;  ///< Inwards.
};

/// Where the ray from inside the cube meets it; from outside, the far wall.
inline WallPoint castInCube(vec3 origin, vec3 direction) {
  float t = 1e30f;
  int axis = 0;
  for (int a = 0; a < 3; ++a) {
    const float along =
        direction[a] != 0.0f ? (std::copysign(1.0f, direction[a]) - origin[a]) / direction[a] : 1e30f;
    if (along < t) {
      t = along;
      axis = a;
    }
  }
  WallPoint wall{origin + direction * t, vec3(0.0f)};
  wall.normal[axis] = direction[axis] > 0.0f ? -1.0f : 1.0f;
  return wall;
}

/// A surface whose reflection is drawn from `u`.
inline ViewSample makeSample(WallPoint wall, vec3 wo, bool lambertian, bool bentNormal, vec3 u) {
  ViewSample s{};
  s.position = wall.position;
  s.ng = dot(wall.normal, wo) >= 0.0f ? wall.normal : -wall.normal;
  s.ns = bentNormal ? normalize(s.ng + 0.3f * (u - vec3(0.5f))) : s.ng;
  if (dot(s.ns, wo) < 0.0f) s.ns = s.ng;
  s.wo = wo;
  s.bsdf.diffuse = u;
  if (!lambertian) {
    s.bsdf.f0 = vec3(0.04f + 0.5f * u.y, 0.04f, 0.04f + 0.5f * u.x);
    s.bsdf.f90 = 1;
    s.bsdf.alpha = 0.05f + 0.9f * u.z;
    s.bsdf.coupling0 = 0.04f;
    s.bsdf.coupling90 = 1;
  }
  s.throughput = vec3(1.0f);
  return s;
}

inline CameraRays makeCamera(const ViewOptions& o) {
  CameraRays c{};
  c.eye = o.eye;
  c.orthographic = o.orthographic;
  c.forward = normalize(o.forward);
  const vec3 side = normalize(cross(c.forward, std::abs(c.forward.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0)));
  c.right = side * (0.7f * float(o.width) / float(o.height));
  c.up = cross(side, c.forward) * 0.7f;
  return c;
}

/// What a camera sees of the inside of the cube [-1, 1]^3, and secondary tiles on its walls. Some lanes have
/// no surface.
inline ViewSamples makeView(const ViewOptions& o) {
  ViewSamples v;
  v.width = o.width;
  v.height = o.height;
  v.tilesX = (o.width + kTileSide - 1) / kTileSide;
  v.tilesY = (o.height + kTileSide - 1) / kTileSide;
  v.camera = makeCamera(o);
  v.primaryTiles = v.directTiles = std::size_t(v.tilesX) * std::size_t(v.tilesY);
  v.tiles.assign(v.primaryTiles + std::size_t(o.secondaryTiles), ViewTile{});
  const vec2 size(float(o.width), float(o.height));
  for (std::size_t i = 0; i < v.tiles.size(); ++i) {
    ViewTile& t = v.tiles[i];
    clearTile(t);
    const vec3 random = random3(o.seed, std::uint32_t(i), 7);
    for (int lane = 0; lane < kTileLanes; ++lane) {
      const vec3 u = random3(o.seed, std::uint32_t(i * kTileLanes) + std::uint32_t(lane), 1);
      const int x = int(i) % v.tilesX * kTileSide + lane % kTileSide;
      const int y = int(i) / v.tilesX * kTileSide + lane / kTileSide;
      const bool primary = i < v.primaryTiles;
      if (primary ? x >= o.width || y >= o.height : u.x < 0.1f) continue;
      vec3 origin = random3(o.seed, std::uint32_t(i), 8) - vec3(0.5f);  // Each mirror's own.
      vec3 direction = normalize(sampleSphere(vec2(random.x, random.y)) + 0.1f * (u - vec3(0.5f)));
      if (primary) {
        const vec2 p = imagePlaneFromPixel(vec2(float(x) + 0.5f, float(y) + 0.5f), size);
        origin = cameraRayOrigin(v.camera, p);
        direction = cameraRayDirection(v.camera, p);
      }
      ViewSample sample =
          makeSample(castInCube(origin, direction), -direction, o.lambertian || i % 3 == 0, o.bentNormals, u);
      sample.pixel = primary ? std::uint32_t(y * o.width + x) : 0;
      setLane(t, lane, sample);
    }
  }
  return v;
}

/// Photons all over the walls of the cube, from everywhere (also from behind), in part just off the walls.
inline PhotonMap makePhotons(std::uint32_t count, std::uint32_t seed = 2) {
  PhotonMap map;
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 u = random3(seed, i, 0);
    const vec3 w = random3(seed, i, 1);
    const vec3 z = random3(seed, i, 2);
    const WallPoint wall = castInCube(vec3(0.0f), sampleSphere(vec2(u.x, u.y)));
    Photon p{};
    p.position = wall.position + wall.normal * (0.04f * (z.x - 0.5f));
    p.pathDensity = 1e-4f + 2e-3f * u.z * u.z;
    p.power = vec3(0.5f) + 0.5f * w;
    p.direction = packDirection(normalize(basisAround(wall.normal) * sampleCosineHemisphere(vec2(w.x, w.y)) *
                                          (z.y < 0.1f ? -1.0f : 1.0f)));
    p.normal = packDirection(z.z < 0.2f ? normalize(wall.normal + 0.5f * (w - vec3(0.5f))) : wall.normal);
    p.bounce = 1;
    map.photons.push_back(p);
  }
  map.emitted = count;
  return map;
}

}  // namespace isophote::photon_volumes_test

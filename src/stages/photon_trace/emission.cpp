// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/emission.h"

#include "math/simd.h"
#include "scene/mesh_emission.h"
#include "trace/surface.h"

#include <algorithm>

namespace isophote {

namespace {

/// Box that holds the scene.
struct Extent {
  vec3 centre;
  vec3 halfSize;
};

SHARED_FN void setPath(const EmittedPhoton& e, std::uint32_t i, PathColumns& out) {
  out.origin.set(i, e.origin);
  out.direction.set(i, e.direction);
  out.power.set(i, e.power);
}

/// Calls emit(numbers for the direction, numbers for the position) for each path.
template <class Emit>
SHARED_FN void forEachPath(const EmissionNumbers& u, std::uint32_t count, PathColumns& out,
                           const Emit& emit) {
  for (std::uint32_t i = 0; i < count; ++i)
    setPath(emit(vec2(u[kMainDimension][i], u[kMainDimension + 1][i]),
                 vec2(u[kOtherDimension][i], u[kOtherDimension + 1][i])),
            i, out);
}

/// Lights other than meshes and environments with a map. `light` and `extent` come by value: the compiler
/// then knows that what is written leaves them alone.
SHARED_FN void emitBody(Light light, Extent extent, const EmissionNumbers& u, std::uint32_t count,
                        PathColumns& out) {
  switch (light.type) {
    case kLightPoint:
      if (!(light.radius > 0.0f)) {
        light.radius = 0.0f;  // as it is; now the compiler knows, and leaves the sphere out
        forEachPath(
            u, count, out, [=](vec2 main, vec2 other) __attribute__((always_inline)) {
              return emitPoint(light, other, main);
            });
        break;
      }
      forEachPath(
          u, count, out, [=](vec2 main, vec2 other) __attribute__((always_inline)) {
            return emitPoint(light, other, main);
          });
      break;
    case kLightSpot:
      forEachPath(
          u, count,
          out, [=](vec2 main, vec2) __attribute__((always_inline)) { return emitSpot(light, main); });
      break;
    case kLightDirectional:
      forEachPath(
          u, count, out, [=](vec2 main, vec2) __attribute__((always_inline)) {
            return emitDirectional(light, extent.centre, extent.halfSize, main);
          });
      break;
    case kLightRectangle:
      forEachPath(
          u, count, out, [=](vec2 main, vec2 other) __attribute__((always_inline)) {
            EmittedPhoton e = emitRectangle(light, other, main);
            e.origin = offsetFrom(e.origin, light.direction, e.direction);
            return e;
          });
      break;
    default:
      for (std::uint32_t i = 0; i < count; ++i)
        setPath(emitEnvironment(light, extent.centre, extent.halfSize, u[kChoiceDimension][i],
                                vec2(u[kOtherDimension][i], u[kOtherDimension + 1][i]),
                                vec2(u[kMainDimension][i], u[kMainDimension + 1][i])),
                i, out);
  }
}

ISOPHOTE_SIMD(emitAll, emitBody,
              (const Light& light, const Extent& extent, const EmissionNumbers& u, std::uint32_t count,
               PathColumns& out),
              (light, extent, u, count, out))

void emitFromMesh(const Scene& scene, const Light& light, const EmissionNumbers& u, std::uint32_t count,
                  PathColumns& out) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec2 uPosition(u[kOtherDimension][i], u[kOtherDimension + 1][i]);
    const EmissiveTriangle t = litAt(scene, chooseTriangle(scene, light, u[kChoiceDimension][i]), uPosition);
    EmittedPhoton e = emitTriangle(t, max(t.probability, 1e-30f), u[kSideDimension][i], uPosition,
                                   vec2(u[kMainDimension][i], u[kMainDimension + 1][i]));
    e.origin = offsetFrom(e.origin, normalize(cross(t.edge1, t.edge2)), e.direction);
    setPath(e, i, out);
  }
}

void emitFromEnvironment(const EnvironmentMap& map, const Light& light, const Extent& extent,
                         const EmissionNumbers& u, std::uint32_t count, PathColumns& out) {
  for (std::uint32_t i = 0; i < count; ++i)
    setPath(emitFromMap(map, light, extent.centre, extent.halfSize,
                        vec2(u[kOtherDimension][i], u[kOtherDimension + 1][i]),
                        vec2(u[kMainDimension][i], u[kMainDimension + 1][i])),
            i, out);
}

}  // namespace

std::uint32_t emissionDimensions(const Light& light) {
  switch (light.type) {
    case kLightSpot:
    case kLightDirectional:
      return 2;
    case kLightPoint:
      return light.radius > 0.0f ? 4 : 2;
    case kLightMesh:
      return 6;
    case kLightEnvironment:
      return light.mapped != 0u ? 4 : 5;
    default:
      return 4;
  }
}

void emitPaths(const Scene& scene, const Light& light, const EmissionNumbers& u, std::uint32_t count,
               PathColumns& out) {
  const Extent extent{scene.bounds.centre(), 0.5f * scene.bounds.size()};
  if (light.type == kLightMesh) return emitFromMesh(scene, light, u, count, out);
  if (light.type == kLightEnvironment && light.mapped != 0u)
    return emitFromEnvironment(scene.environment, light, extent, u, count, out);
  emitAllFor(bestSimdLevel())(light, extent, u, count, out);
}

}  // namespace isophote

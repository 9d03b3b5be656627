// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/emission.h"

#include "math/simd.h"
#include "physics/emission.shared.h"
#include "trace/surface.h"

#include <algorithm>
#include <span>

namespace isophote {

namespace {

/// Box that holds the scene.
struct Extent {
  vec3 centre;
  vec3 halfSize;
  float radius;
};

/// Calls emit(numbers for the direction, numbers for the position) for each path.
template <class Emit>
SHARED_FN void forEachPath(const EmissionNumbers& u, std::uint32_t count, PathColumns& out,
                           const Emit& emit) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const EmittedPhoton e = emit(vec2(u[kMainDimension][i], u[kMainDimension + 1][i]),
                                 vec2(u[kOtherDimension][i], u[kOtherDimension + 1][i]));
    out.origin.set(i, e.origin);
    out.direction.set(i, e.direction);
    out.power.set(i, e.power);
  }
}

/// Lights other than meshes. `light` and `extent` come by value: the compiler then knows that what is written
/// leaves them alone.
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
      forEachPath(
          u, count, out, [=](vec2 main, vec2 other) __attribute__((always_inline)) {
            return emitEnvironment(light, extent.centre, extent.radius, other, main);
          });
  }
}

ISOPHOTE_SIMD(emitAll, emitBody,
              (const Light& light, const Extent& extent, const EmissionNumbers& u, std::uint32_t count,
               PathColumns& out),
              (light, extent, u, count, out))

/// The triangle of a mesh light that `choice` picks in proportion to its power, as index into the light's
/// range.
std::uint32_t chooseTriangle(std::span<const EmissiveTriangle> triangles, float choice) {
  const auto found =
      std::upper_bound(triangles.begin(), triangles.end(), choice,
                       [](float u, const EmissiveTriangle& t) { return u < t.cumulativePower; });
  return std::uint32_t(std::min<std::ptrdiff_t>(found - triangles.begin(), std::ssize(triangles) - 1));
}

void emitFromMesh(std::span<const EmissiveTriangle> triangles, const EmissionNumbers& u, std::uint32_t count,
                  PathColumns& out) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t chosen = chooseTriangle(triangles, u[kChoiceDimension][i]);
    const EmissiveTriangle& t = triangles[chosen];
    const float before = chosen > 0 ? triangles[chosen - 1].cumulativePower : 0.0f;
    const EmittedPhoton e = emitTriangle(t, max(t.cumulativePower - before, 1e-30f), u[kSideDimension][i],
                                         vec2(u[kOtherDimension][i], u[kOtherDimension + 1][i]),
                                         vec2(u[kMainDimension][i], u[kMainDimension + 1][i]));
    out.origin.set(i, offsetFrom(e.origin, normalize(cross(t.edge1, t.edge2)), e.direction));
    out.direction.set(i, e.direction);
    out.power.set(i, e.power);
  }
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
    default:
      return 4;
  }
}

void emitPaths(const Scene& scene, const Light& light, const EmissionNumbers& u, std::uint32_t count,
               PathColumns& out) {
  if (light.type == kLightMesh) {
    emitFromMesh({&scene.emissiveTriangles[light.firstTriangle], light.triangleCount}, u, count, out);
    return;
  }
  const Extent extent{scene.bounds.centre(), 0.5f * scene.bounds.size(), scene.bounds.radius()};
  emitAllFor(bestSimdLevel())(light, extent, u, count, out);
}

}  // namespace isophote

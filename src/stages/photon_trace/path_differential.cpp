// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/path_differential.h"

#include "physics/bsdf.shared.h"
#include "physics/emission.shared.h"
#include "scene/environment.h"
#include "scene/mesh_emission.h"

namespace isophote {

namespace {

/// Solid angle that the light's photons share.
float emittedSolidAngle(const Light& light) {
  switch (light.type) {
    case kLightPoint:
      return light.radius > 0.0f ? 2.0f * kPi : 4.0f * kPi;
    case kLightSpot:
      return 2.0f * kPi * (1.0f - light.cosOuter);
    case kLightDirectional:
      return 0.0f;
    case kLightEnvironment:
      return 4.0f * kPi;
    default:
      return 2.0f * kPi;
  }
}

/// Area, perpendicular to their direction, that photons share; of mesh lights as if this triangle alone
/// shone.
float emittedArea(const Scene& scene, const Light& light, vec3 origin, vec3 direction, float uChoice) {
  switch (light.type) {
    case kLightPoint:
      return 4.0f * kPi * light.radius * abs(dot(origin - light.position, direction));
    case kLightSpot:
      return 0.0f;
    case kLightMesh: {
      const EmissiveTriangle& t = chooseTriangle(scene, light, uChoice);
      const float sides = t.doubleSided != 0u ? 2.0f : 1.0f;
      return sides * 0.5f * abs(dot(cross(t.edge1, t.edge2), direction)) / max(t.probability, 1e-30f);
    }
    case kLightRectangle:
      return light.area * abs(dot(direction, light.direction));
    default:
      return boxOutline(direction, 0.5f * scene.bounds.size());
  }
}

/// Density per solid angle with which a photon of an environment's map has taken its direction.
float mapDensity(const Scene& scene, const Light& light, vec3 direction, vec3 power) {
  const vec3 radiance = environmentRadiance(scene.environment, light, -direction);
  return meanOf(radiance) * boxOutline(direction, 0.5f * scene.bounds.size()) / max(meanOf(power), 1e-30f);
}

}  // namespace

void emitDifferentials(const Scene& scene, const Light& light, const EmissionNumbers& u, float photons,
                       const PathColumns& emitted, std::uint32_t count, PathDifferential* out) {
  const bool mapped = light.type == kLightEnvironment && light.mapped != 0u;
  const float spacing = photonSpacing(emittedSolidAngle(light), photons);
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 direction = emitted.direction[i];
    const float directionStep =
        mapped ? lobeSpacing(mapDensity(scene, light, direction, emitted.power[i]), photons) : spacing;
    const float area = emittedArea(scene, light, emitted.origin[i], direction, u[kChoiceDimension][i]);
    out[i] = {leavingDifferential(direction, directionStep, sqrt(area / photons)), 0u};
  }
}

}  // namespace isophote

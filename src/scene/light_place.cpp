// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/light_place.h"

#include "base/error.h"
#include "scene/light_power.h"
#include "scene/validate.h"

#include <cmath>

namespace isophote {

namespace {

const char* kindOf(const Light& light) {
  switch (light.type) {
    case kLightDirectional:
      return "a directional light";
    case kLightEnvironment:
      return "an environment light";
    case kLightMesh:
      return "an emissive mesh";
    case kLightRectangle:
      return "a rectangle";
    default:
      return "a point light";
  }
}

}  // namespace

std::optional<vec3> lightPosition(const Light& light) {
  if (light.type == kLightPoint || light.type == kLightSpot) return light.position;
  if (light.type == kLightRectangle) return light.position + 0.5f * (light.edgeU + light.edgeV);
  return std::nullopt;
}

bool hasAim(const Light& light) { return light.type == kLightSpot || light.type == kLightDirectional; }

Light movedLight(Light light, vec3 position) {
  const std::optional<vec3> before = lightPosition(light);
  if (!before)
    failUsage("", "{} has no place to be moved from; point, spot and rectangle lights have", kindOf(light));
  for (int k = 0; k < 3; ++k)
    if (!(std::abs(position[k]) <= kLargestCoordinate))
      failUsage("", "a light cannot stand at ({:g}, {:g}, {:g}); coordinates must stay below {:g} m",
                position.x, position.y, position.z, kLargestCoordinate);
  if (light.type == kLightRectangle)
    light.position = position - 0.5f * (light.edgeU + light.edgeV);
  else
    light.position = position;
  return light;
}

Light aimedLight(Light light, vec3 direction, const Bounds& bounds) {
  if (!hasAim(light))
    failUsage("", "{} has no direction to be turned; spot and directional lights have", kindOf(light));
  const float size = length(direction);
  if (!(size > 1e-18f && size < 1e18f))
    failUsage("", "a light cannot shine along ({:g}, {:g}, {:g})", direction.x, direction.y, direction.z);
  light.direction = direction / size;
  light.power = lightPower(light, bounds);
  return light;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/light_power.h"

#include "physics/emission.shared.h"

namespace isophote {

namespace {

float meanOf(vec3 colour) { return (colour.x + colour.y + colour.z) / 3.0f; }

}  // namespace

float lightPower(const Light& light, const Bounds& bounds) {
  const float strength = meanOf(light.colour);
  switch (light.type) {
    case kLightPoint:
      return 4.0f * kPi * strength;
    case kLightSpot:
      // The integral of t^2 over the falloff, t rising linearly with the cosine, is a third of its width.
      return 2.0f * kPi * strength * ((1.0f - light.cosInner) + (light.cosInner - light.cosOuter) / 3.0f);
    case kLightDirectional:
      return strength * boxOutline(light.direction, 0.5f * bounds.size());
    case kLightRectangle:
      return kPi * light.area * strength;
    case kLightEnvironment: {
      if (light.mapped != 0u) return light.power;
      // Irradiance pi L on the whole surface of the bounds.
      const vec3 faces = boxFaces(0.5f * bounds.size());
      return kPi * strength * 2.0f * (faces.x + faces.y + faces.z);
    }
    default:
      return light.power;
  }
}

}  // namespace isophote

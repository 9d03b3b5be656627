// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/light_power.h"

#include "physics/emission.shared.h"

#include <cmath>

namespace isophote {

namespace {

float meanOf(vec3 colour) { return (colour.x + colour.y + colour.z) / 3.0f; }

}  // namespace

Light spotLight(float innerDegrees, float outerDegrees, vec3 watts) {
  const auto cosDegrees = [](float degrees) {
    return float(std::cos(double(degrees) * 3.14159265358979323846 / 180.0));
  };
  Light light{};
  light.type = kLightSpot;
  light.cosInner = cosDegrees(innerDegrees);
  light.cosOuter = cosDegrees(outerDegrees);
  // Flux of a spot of unit intensity on its axis: the falloff is the square of a ramp over the cosine, whose
  // integral is a third of the ramp's width.
  const float solidAngle = 2.0f * kPi * ((1.0f - light.cosInner) + (light.cosInner - light.cosOuter) / 3.0f);
  light.colour = watts / solidAngle;
  return light;
}

Light environmentLight(vec3 colour, bool mapped, double rotationDegrees) {
  const double angle = rotationDegrees * 3.14159265358979323846 / 180.0;
  Light light{};
  light.type = kLightEnvironment;
  light.direction = vec3(0, -1, 0);
  light.mapped = mapped ? 1u : 0u;
  light.colour = colour;
  light.edgeU = vec3(float(std::cos(angle)), 0.0f, float(-std::sin(angle)));
  light.edgeV = vec3(0, 1, 0);
  return light;
}

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

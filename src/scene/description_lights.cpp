// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/description_parts.h"
#include "scene/light_power.h"
#include "settings/suggest.h"

#include <array>

namespace isophote {

namespace {

Light readPoint(const JsonValue& value) {
  value.expectKeys({"type", "watts", "position", "radius"});
  Light light{};
  light.type = kLightPoint;
  light.position = value.at("position").vector();
  if (const auto radius = value.find("radius")) light.radius = radius->number(0.0);
  light.colour = value.at("watts").colour() / (4.0f * kPi);
  return light;
}

Light readSpot(const JsonValue& value) {
  value.expectKeys({"type", "watts", "position", "direction", "innerDegrees", "outerDegrees"});
  const JsonValue outerValue = value.at("outerDegrees");
  const float outer = outerValue.number(0.1, 90.0);
  float inner = 0.0f;
  if (const auto given = value.find("innerDegrees")) {
    inner = given->number(0.0, 90.0);
    if (inner > outer)
      given->fail("must not be greater than outerDegrees, which is {}, but is {}", outer, inner);
  }
  Light light = spotLight(inner, outer, value.at("watts").colour());
  light.position = value.at("position").vector();
  light.direction = value.at("direction").direction();
  return light;
}

Light readDirectional(const JsonValue& value) {
  value.expectKeys({"type", "irradiance", "direction"});
  Light light{};
  light.type = kLightDirectional;
  light.direction = value.at("direction").direction();
  light.colour = value.at("irradiance").colour();
  return light;
}

Light readRectangle(const JsonValue& value) {
  value.expectKeys({"type", "radiance", "position", "direction", "up", "width", "height"});
  Light light{};
  light.type = kLightRectangle;
  light.direction = value.at("direction").direction();
  const float width = value.at("width").positive();
  const float height = value.at("height").positive();
  // Without "up", the world axis that is least along the direction.
  const vec3 a = abs(light.direction);
  vec3 up = a.y <= a.x && a.y <= a.z ? vec3(0, 1, 0) : a.z <= a.x ? vec3(0, 0, 1) : vec3(1, 0, 0);
  if (const auto given = value.find("up")) {
    up = given->direction();
    if (length(cross(up, light.direction)) < 1e-3f) given->fail("must not be parallel to \"direction\"");
  }
  const vec3 u = normalize(cross(up, light.direction));
  const vec3 v = cross(light.direction, u);
  light.edgeU = u * width;
  light.edgeV = v * height;
  light.area = width * height;
  light.position = value.at("position").vector() - 0.5f * (light.edgeU + light.edgeV);
  light.colour = value.at("radiance").colour();
  return light;
}

Light readEnvironment(const JsonValue& value) {
  value.expectKeys({"type", "radiance", "file", "source", "rotationDegrees"});
  const bool mapped = value.has("file");
  for (const char* key : {"source", "rotationDegrees"})
    if (!mapped && value.has(key)) value.at(key).fail("belongs to an environment map: give its \"file\" too");
  const vec3 colour = mapped && !value.has("radiance") ? vec3(1.0f) : value.at("radiance").colour();
  const auto rotation = value.find("rotationDegrees");
  return environmentLight(colour, mapped, rotation ? double(rotation->number(-360.0, 360.0)) : 0.0);
}

}  // namespace

Light readLight(const JsonValue& value) {
  const JsonValue type = value.at("type");
  const std::string name = type.string();
  if (name == "point") return readPoint(value);
  if (name == "spot") return readSpot(value);
  if (name == "directional") return readDirectional(value);
  if (name == "rectangle") return readRectangle(value);
  if (name == "environment") return readEnvironment(value);
  constexpr std::array<std::string_view, 5> kTypes = {"point", "spot", "directional", "rectangle",
                                                      "environment"};
  type.fail("there is no light type \"{}\"{}; there are {}", name,
            suggestion(name, std::span<const std::string_view>(kTypes)), fmt::join(kTypes, ", "));
}

Camera readCamera(const JsonValue& value) {
  value.expectKeys({"name", "eye", "target", "up", "verticalFovDegrees", "aspect", "orthographicHeight"});
  Camera camera;
  if (const auto name = value.find("name")) camera.name = name->string();
  camera.eye = value.at("eye").vector();
  camera.target = value.at("target").vector();
  if (camera.eye == camera.target) value.at("target").fail("must differ from \"eye\"");
  if (const auto up = value.find("up")) {
    camera.up = up->direction();
    if (length(cross(camera.up, normalize(camera.target - camera.eye))) < 1e-4f) {
      up->fail("must not be parallel to the direction from \"eye\" to \"target\"");
    }
  }
  if (const auto fov = value.find("verticalFovDegrees")) camera.verticalFovDegrees = fov->number(0.1, 179.0);
  if (const auto aspect = value.find("aspect")) camera.aspect = aspect->positive();
  if (const auto height = value.find("orthographicHeight")) {
    if (value.has("verticalFovDegrees"))
      height->fail("stands beside \"verticalFovDegrees\": give one of the two");
    camera.orthographicHeight = height->positive();
  }
  return camera;
}

}  // namespace isophote

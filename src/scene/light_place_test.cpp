// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/light_place.h"
#include "base/error.h"
#include "scene/light_power.h"

#include <gtest/gtest.h>

#include <limits>

namespace isophote {
namespace {

Light lightOf(uint type) {
  Light light{};
  light.type = type;
  light.position = {1, 2, 3};
  light.direction = {0, -1, 0};
  light.edgeU = {2, 0, 0};
  light.edgeV = {0, 0, 4};
  light.colour = vec3(5.0f);
  return light;
}

TEST(LightPlace, MovesWhatHasOne) {
  for (const uint type : {kLightPoint, kLightSpot, kLightRectangle}) {
    const Light light = lightOf(type);
    const vec3 middle = type == kLightRectangle ? vec3(2, 2, 5) : vec3(1, 2, 3);
    EXPECT_EQ(lightPosition(light), middle) << type;
    const Light moved = movedLight(light, vec3(-7, 8, 9));
    EXPECT_EQ(lightPosition(moved), vec3(-7, 8, 9)) << type;
    EXPECT_EQ(moved.colour, light.colour);
    EXPECT_EQ(moved.edgeV, light.edgeV);
  }
}

TEST(LightPlace, RefusesWhatHasNone) {
  for (const uint type : {kLightDirectional, kLightMesh, kLightEnvironment}) {
    EXPECT_EQ(lightPosition(lightOf(type)), std::nullopt) << type;
    EXPECT_THROW(movedLight(lightOf(type), vec3(0.0f)), Error) << type;
  }
  const Light point = lightOf(kLightPoint);
  EXPECT_THROW(movedLight(point, vec3(0, std::numeric_limits<float>::quiet_NaN(), 0)), Error);
  EXPECT_THROW(movedLight(point, vec3(0, 0, 1e13f)), Error);
}

TEST(LightPlace, TurnsSpotsAndSuns) {
  Bounds room;
  room.extend(vec3(0.0f));
  room.extend(vec3(1, 2, 4));
  const Light sun = aimedLight(lightOf(kLightDirectional), vec3(0, 0, -3), room);
  EXPECT_EQ(sun.direction, vec3(0, 0, -1));
  EXPECT_NEAR(sun.power, 5.0f * 1 * 2, 1e-4f) << "what goes through the side that it meets";
  EXPECT_EQ(aimedLight(lightOf(kLightSpot), vec3(2, 0, 0), room).direction, vec3(1, 0, 0));
  EXPECT_THROW(aimedLight(lightOf(kLightPoint), vec3(1, 0, 0), room), Error);
  EXPECT_THROW(aimedLight(lightOf(kLightSpot), vec3(0.0f), room), Error);
}

}  // namespace
}  // namespace isophote

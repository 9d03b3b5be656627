// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/camera.shared.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isophote {
namespace {

void expectNear(vec3 actual, vec3 expected) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(actual[k], expected[k], 1e-6f) << k;
}

/// At (1, 2, 3), looking along -z: half the image is 0.5 high and 0.8 wide at distance 1.
CameraRays someCamera(float orthographic) {
  CameraRays c{};
  c.eye = vec3(1.0f, 2.0f, 3.0f);
  c.orthographic = orthographic;
  c.forward = vec3(0.0f, 0.0f, -1.0f);
  c.right = vec3(0.8f, 0.0f, 0.0f);
  c.up = vec3(0.0f, 0.5f, 0.0f);
  return c;
}

TEST(Camera, PinholeRaysStartAtTheEyeAndFan) {
  const CameraRays c = someCamera(0.0f);
  expectNear(cameraRayOrigin(c, vec2(0.7f, -0.3f)), c.eye);
  expectNear(cameraRayDirection(c, vec2(0.0f)), vec3(0.0f, 0.0f, -1.0f));
  const float length = std::sqrt(0.64f + 0.25f + 1.0f);
  expectNear(cameraRayDirection(c, vec2(1.0f, 1.0f)), vec3(0.8f, 0.5f, -1.0f) / length);
  expectNear(cameraRayDirection(c, vec2(-1.0f, -1.0f)), vec3(-0.8f, -0.5f, -1.0f) / length);
}

TEST(Camera, OrthographicRaysAreParallel) {
  const CameraRays c = someCamera(1.0f);
  expectNear(cameraRayDirection(c, vec2(0.9f, -0.9f)), vec3(0.0f, 0.0f, -1.0f));
  expectNear(cameraRayOrigin(c, vec2(0.5f, -1.0f)), vec3(1.4f, 1.5f, 3.0f));
}

TEST(Camera, PixelsCountFromTheUpperLeftCorner) {
  const vec2 size(640.0f, 480.0f);
  EXPECT_EQ(imagePlaneFromPixel(vec2(0.0f, 0.0f), size), vec2(-1.0f, 1.0f));
  EXPECT_EQ(imagePlaneFromPixel(size, size), vec2(1.0f, -1.0f));
  EXPECT_EQ(imagePlaneFromPixel(vec2(320.0f, 120.0f), size), vec2(0.0f, 0.5f));
  const vec2 centre = imagePlaneFromPixel(vec2(0.5f, 0.5f), vec2(1.0f));
  EXPECT_EQ(centre, vec2(0.0f));
}

}  // namespace
}  // namespace isophote

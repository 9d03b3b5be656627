// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/camera_control.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isophote::viewer {
namespace {

Bounds cube(vec3 centre, float half) {
  Bounds bounds;
  bounds.extend(centre - vec3(half));
  bounds.extend(centre + vec3(half));
  return bounds;
}

Camera along(vec3 eye, vec3 target) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  return camera;
}

void expectNear(vec3 a, vec3 b, float tolerance = 1e-4f) { EXPECT_LT(length(a - b), tolerance); }

TEST(CameraControl, FliesAlongItsOwnAxes) {
  CameraControl control(along({0, 0, 0}, {0, 0, -2}), cube(vec3(0.0f), 1));
  control.setSpeed(2);
  control.fly({0, 0, 1}, 0.5f, false);
  expectNear(control.camera().eye, {0, 0, -1});
  expectNear(control.camera().target, {0, 0, -3});
  control.fly({1, 0, 0}, 0.5f, false);
  expectNear(control.camera().eye, {1, 0, -1});
  control.fly({0, -1, 0}, 0.1f, true);
  expectNear(control.camera().eye, {1, -1, -1});
}

TEST(CameraControl, WhatTheMouseGoesToComesToTheMiddle) {
  CameraControl control(along({0, 0, 0}, {0, 0, -2}), cube(vec3(0.0f), 1));
  control.turn({100, 0});
  EXPECT_GT(control.camera().target.x, 0.0f) << "to the right";
  expectNear(control.camera().eye, vec3(0.0f));
  control.turn({-100, -50});
  EXPECT_NEAR(control.camera().target.x, 0.0f, 1e-5f);
  EXPECT_GT(control.camera().target.y, 0.0f) << "up";
  EXPECT_NEAR(length(control.camera().target), 2.0f, 1e-5f);
}

TEST(CameraControl, NeverTurnsOver) {
  for (const CameraMode mode : {CameraMode::kFly, CameraMode::kOrbit}) {
    CameraControl control(along({0, 0, 3}, {0, 0, 0}), cube(vec3(0.0f), 1));
    control.setMode(mode);
    for (int i = 0; i < 50; ++i) control.turn({0, 100});
    const vec3 down = normalize(control.camera().target - control.camera().eye);
    EXPECT_NEAR(down.y, -std::sin(89.0f * kPi / 180.0f), 1e-4f);
    EXPECT_LT(down.z, 0.0f) << "still the way it looked";
    for (int i = 0; i < 50; ++i) control.turn({13, -100});
    EXPECT_GT(normalize(control.camera().target - control.camera().eye).y, 0.99f);
    cameraRays(control.camera(), 4, 3);  // Throws where the camera is none.
  }
}

TEST(CameraControl, OrbitsAtAFixedDistance) {
  CameraControl control(along({0, 0, 3}, {0, 0, 0}), cube(vec3(0.0f), 1));
  control.setMode(CameraMode::kOrbit);
  control.turn({40, 25});
  EXPECT_EQ(control.camera().target, vec3(0.0f));
  EXPECT_NEAR(length(control.camera().eye), 3.0f, 1e-5f);
  EXPECT_LT(control.camera().eye.x, 0.0f) << "the scene turns with the hand";
  EXPECT_GT(control.camera().eye.y, 0.0f);
}

TEST(CameraControl, WheelChangesSpeedOrDistance) {
  CameraControl control(along({0, 0, 3}, {0, 0, 0}), cube(vec3(0.0f), 1));
  const float speed = control.speed();
  control.wheel(2);
  EXPECT_NEAR(control.speed(), 1.44f * speed, 1e-5f);
  expectNear(control.camera().eye, {0, 0, 3});
  control.setMode(CameraMode::kOrbit);
  control.wheel(1);
  expectNear(control.camera().eye, {0, 0, 2.5f});
  for (int i = 0; i < 100; ++i) control.wheel(20);
  EXPECT_GT(control.camera().eye.z, 0.0f) << "the eye never reaches the target";
  Camera flat = along({0, 0, 3}, {0, 0, 0});
  flat.orthographicHeight = 6;
  control.setCamera(flat);
  control.wheel(1);
  EXPECT_NEAR(control.camera().orthographicHeight, 5.0f, 1e-5f);
}

TEST(CameraControl, PansWithThePointer) {
  CameraControl control(along({0, 0, 2}, {0, 0, 0}), cube(vec3(0.0f), 1));
  const vec3 seen(0.0f);  // At the target's distance.
  const float height = 480;
  control.pan({30, -20}, height);
  // What was in the middle has moved by those pixels.
  const CameraRays rays = cameraRays(control.camera(), 640, 480);
  const vec3 d = seen - rays.eye;
  const float z = dot(d, rays.forward);
  EXPECT_NEAR(dot(d, rays.right) / dot(rays.right, rays.right) / z * 320, 30.0f, 1e-2f);
  EXPECT_NEAR(-dot(d, rays.up) / dot(rays.up, rays.up) / z * 240, -20.0f, 1e-2f);
}

TEST(CameraControl, FramesTheWholeScene) {
  const Bounds scene = cube({5, -3, 2}, 4);
  for (const float aspect : {0.5f, 1.0f, 2.4f})
    for (const float orthographic : {0.0f, 1.0f}) {
      Camera camera = along({0, 0, 0}, {1, -0.3f, 0.4f});
      camera.orthographicHeight = orthographic;
      CameraControl control(camera, scene);
      control.frameScene(aspect);
      const CameraRays rays = cameraRays(control.camera(), int(1000 * aspect), 1000);
      float widest = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const vec3 p(corner & 1 ? scene.lower.x : scene.upper.x, corner & 2 ? scene.lower.y : scene.upper.y,
                     corner & 4 ? scene.lower.z : scene.upper.z);
        const float z = dot(p - rays.eye, rays.forward);
        ASSERT_GT(z, 0.0f);
        const float scale = orthographic > 0.0f ? 1.0f : 1.0f / z;
        widest =
            std::max(widest, std::abs(dot(p - rays.eye, rays.right) / dot(rays.right, rays.right) * scale));
        widest = std::max(widest, std::abs(dot(p - rays.eye, rays.up) / dot(rays.up, rays.up) * scale));
      }
      EXPECT_LE(widest, 1.001f) << aspect;
      EXPECT_GT(widest, 0.4f) << aspect << ": no farther than need be";
    }
}

TEST(CameraControl, LooksStraightDownAndUpAgain) {
  CameraControl control(along({0, 5, 0}, {0, 0, 0}), cube(vec3(0.0f), 1));
  control.turn({0, -100});
  const vec3 view = normalize(control.camera().target - control.camera().eye);
  EXPECT_GT(view.y, -0.95f);
  cameraRays(control.camera(), 4, 3);
}

}  // namespace
}  // namespace isophote::viewer

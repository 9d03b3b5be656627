// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/camera_control.h"

#include "scene/validate.h"

#include <algorithm>
#include <cmath>

namespace isophote::viewer {

namespace {

constexpr float kRadiansPerPixel = 0.004f;
/// How near the view may come to straight up or down.
constexpr float kSteepest = 89.0f * kPi / 180.0f;
constexpr float kFast = 5.0f;
constexpr float kNotch = 1.2f;

vec3 rotated(vec3 v, vec3 axis, float radians) {
  const float c = std::cos(radians), s = std::sin(radians);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0f - c));
}

vec3 upOf(const Camera& camera) {
  const float size = length(camera.up);
  return size > 0.0f ? camera.up / size : vec3(0, 1, 0);
}

}  // namespace

CameraControl::CameraControl(const Camera& camera, const Bounds& scene) : camera_(camera), scene_(scene) {
  setSpeed(0.25f * scene.radius());
}

void CameraControl::setCamera(const Camera& camera) { camera_ = camera; }

void CameraControl::setSpeed(float metresPerSecond) {
  const float scale = std::max(scene_.radius(), 1e-6f);
  speed_ = std::clamp(metresPerSecond, 1e-4f * scale, 1e2f * scale);
}

CameraControl::Axes CameraControl::axes() const {
  const CameraRays rays = cameraRays(camera_, 1, 1);
  return {normalize(rays.right), normalize(rays.up), rays.forward};
}

vec3 CameraControl::turned(vec2 radians) const {
  const vec3 up = upOf(camera_);
  const vec3 reach = camera_.target - camera_.eye;
  const vec3 right = axes().right;
  // A camera that looks along its up direction has a right of its own; it is left as it is until it is
  // raised.
  const float pitch = std::asin(std::clamp(dot(normalize(reach), up), -1.0f, 1.0f));
  const float steepest = std::max(kSteepest, std::abs(pitch));
  const float wanted = std::clamp(pitch + radians.y, -steepest, steepest);
  return rotated(rotated(reach, right, wanted - pitch), up, radians.x);
}

void CameraControl::turn(vec2 pixels) {
  const vec3 reach = turned(-pixels * kRadiansPerPixel);
  if (mode_ == CameraMode::kFly)
    camera_.target = camera_.eye + reach;
  else
    camera_.eye = camera_.target - reach;
}

void CameraControl::pan(vec2 pixels, float height) {
  const float distance = length(camera_.target - camera_.eye);
  const float seen = camera_.orthographicHeight > 0.0f
                         ? camera_.orthographicHeight
                         : 2.0f * distance * std::tan(0.5f * camera_.verticalFovDegrees * kPi / 180.0f);
  const Axes a = axes();
  const vec3 step = (a.up * pixels.y - a.right * pixels.x) * (seen / std::max(height, 1.0f));
  camera_.eye += step;
  camera_.target += step;
}

void CameraControl::fly(vec3 way, float seconds, bool fast) {
  const Axes a = axes();
  const vec3 step = (a.right * way.x + upOf(camera_) * way.y + a.forward * way.z) *
                    (speed_ * seconds * (fast ? kFast : 1.0f));
  // Beyond what a float tells from its neighbours, eye and target would fall together.
  const vec3 reach = abs(camera_.eye + step);
  if (!(std::max({reach.x, reach.y, reach.z}) < 1e5f * std::max(scene_.radius(), 1e-6f))) return;
  camera_.eye += step;
  camera_.target += step;
}

void CameraControl::wheel(float notches) {
  const float factor = std::pow(kNotch, std::clamp(notches, -20.0f, 20.0f));
  if (mode_ == CameraMode::kFly) return setSpeed(speed_ * factor);
  const float scale = std::max(scene_.radius(), 1e-6f);
  if (camera_.orthographicHeight > 0.0f) {
    camera_.orthographicHeight = std::clamp(camera_.orthographicHeight / factor, 1e-3f * scale, 1e3f * scale);
    return;
  }
  const vec3 reach = camera_.target - camera_.eye;
  const float distance = std::clamp(length(reach) / factor, 1e-3f * scale, 1e3f * scale);
  camera_.eye = camera_.target - normalize(reach) * distance;
}

void CameraControl::frameScene(float aspect) {
  const vec3 forward = axes().forward;
  const float radius = std::max(scene_.radius(), 1e-6f);
  float distance = 2.0f * radius;
  if (camera_.orthographicHeight > 0.0f) {
    camera_.orthographicHeight = 2.0f * radius / std::min(aspect, 1.0f);
  } else {
    // The sphere around the scene touches the narrower pair of the view's sides.
    const float halfHeight = 0.5f * camera_.verticalFovDegrees * kPi / 180.0f;
    const float halfWidth = std::atan(std::tan(halfHeight) * aspect);
    distance = radius / std::sin(std::min(halfHeight, halfWidth));
  }
  camera_.target = scene_.centre();
  camera_.eye = camera_.target - forward * distance;
}

}  // namespace isophote::viewer

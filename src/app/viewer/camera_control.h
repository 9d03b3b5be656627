// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/bounds.h"
#include "scene/scene.h"

#include <array>

namespace isophote::viewer {

/// Fly: the mouse turns the head. Orbit: it turns the eye about the camera's target.
enum class CameraMode { kFly, kOrbit };

/// What hands on mouse and keys do to a camera. Pointer motions are in pixels, right and down. The horizon
/// stays level: the camera's own up direction as it was given is up for good.
class CameraControl {
 public:
  /// Starts as that camera; the scene's size sets the speed.
  CameraControl(const Camera& camera, const Bounds& scene);

  const Camera& camera() const { return camera_; }
  void setCamera(const Camera& camera);

  CameraMode mode() const { return mode_; }
  void setMode(CameraMode mode) { mode_ = mode; }
  /// How fast fly() moves [m/s].
  float speed() const { return speed_; }
  void setSpeed(float metresPerSecond);

  /// Turns the head, or the eye about the target, as the mode says.
  void turn(vec2 pixels);
  /// Moves eye and target in the picture's plane, so that what is at the target's distance stays beneath the
  /// pointer in a picture of that height [pixels].
  void pan(vec2 pixels, float height);
  /// Moves along right, up and forward [-1, 1 each]; fast: five times as far.
  void fly(vec3 way, float seconds, bool fast);
  /// Notches of the wheel, away from the hand positive: faster in fly mode, closer in orbit mode.
  void wheel(float notches);
  /// Goes back or forth along the view until the whole scene is in a picture of that shape (width / height).
  void frameScene(float aspect);

 private:
  struct Axes {
    vec3 right, up, forward;  ///< Unit.
  };
  Axes axes() const;
  /// Yaw about the up direction, then pitch, of the direction from eye to target.
  vec3 turned(vec2 radians) const;

  Camera camera_;
  Bounds scene_;
  CameraMode mode_ = CameraMode::kFly;
  float speed_ = 1;
};

}  // namespace isophote::viewer

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#ifndef ISOPHOTE_PHYSICS_CAMERA_SHARED_H
#define ISOPHOTE_PHYSICS_CAMERA_SHARED_H

#include "math/shared.h"

SHARED_BEGIN

/// A pinhole (or orthographic) camera, ready to make rays. World space; looks along `forward`.
struct CameraRays {
  vec3 eye;
  float orthographic;  ///< 1: parallel rays from the image plane through `eye`; 0: pinhole.
  vec3 forward;        ///< Unit.
  float pad0;
  vec3 right;  ///< Half the image width at distance 1 (orthographic: half the width in metres).
  float pad1;
  vec3 up;  ///< Half the image height at distance 1 (orthographic: half the height in metres).
  float pad2;
};

/// Point on the image plane: (-1, -1) is the lower left corner, (1, 1) the upper right one.
SHARED_FN vec3 cameraRayOrigin(CameraRays c, vec2 p) {
  return c.eye + c.orthographic * (c.right * p.x + c.up * p.y);
}

/// Unit direction of the ray through image-plane point p (see cameraRayOrigin).
SHARED_FN vec3 cameraRayDirection(CameraRays c, vec2 p) {
  return normalize(c.forward + (1.0f - c.orthographic) * (c.right * p.x + c.up * p.y));
}

/// Image-plane point of pixel position (x, y) in pixels from the upper left corner; pixel centres are at .5.
SHARED_FN vec2 imagePlaneFromPixel(vec2 pixel, vec2 size) {
  return vec2(2.0f * pixel.x / size.x - 1.0f, 1.0f - 2.0f * pixel.y / size.y);
}

SHARED_END

#endif

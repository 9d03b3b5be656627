// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a lat-long environment map shows a direction, and parallel light entering the scene's bounds.
#ifndef ISOPHOTE_PHYSICS_ENVIRONMENT_SHARED_H
#define ISOPHOTE_PHYSICS_ENVIRONMENT_SHARED_H

#include "math/sampling.shared.h"
#include "math/shared.h"
#include "physics/light.shared.h"

SHARED_BEGIN

/// A direction in the map's own frame, in which the map's middle lies towards -z, its top towards +y and what
/// is right of the middle towards +x.
SHARED_FN vec3 mapFromWorld(Light light, vec3 direction) {
  return vec3(dot(direction, light.edgeU), dot(direction, light.edgeV),
              dot(direction, cross(light.edgeU, light.edgeV)));
}

SHARED_FN vec3 worldFromMap(Light light, vec3 direction) {
  return light.edgeU * direction.x + light.edgeV * direction.y +
         cross(light.edgeU, light.edgeV) * direction.z;
}

/// Place on the map, from its upper left corner to (1, 1).
SHARED_FN vec2 mapUv(vec3 direction) {
  float level = sqrt(direction.x * direction.x + direction.z * direction.z);
  return vec2(0.5f + 0.5f * kInvPi * atan(direction.x, -direction.z), kInvPi * atan(level, direction.y));
}

/// Sine of the angle between the map's poles and that height of it: a piece of the map stands for
/// 2 pi^2 times its area times this as solid angle.
SHARED_FN float mapSine(float v) { return max(sin(kPi * v), 0.0f); }

SHARED_FN vec3 mapDirection(vec2 uv) {
  float longitude = 2.0f * kPi * (uv.x - 0.5f);
  float sine = mapSine(uv.y);
  return vec3(sine * sin(longitude), cos(kPi * uv.y), -sine * cos(longitude));
}

/// Areas of a box's faces perpendicular to x, y and z, one each [m^2].
SHARED_FN vec3 boxFaces(vec3 halfSize) {
  return 4.0f * vec3(halfSize.y * halfSize.z, halfSize.x * halfSize.z, halfSize.x * halfSize.y);
}

/// Area of a box as parallel light of that direction sees it [m^2].
SHARED_FN float boxOutline(vec3 direction, vec3 halfSize) { return dot(abs(direction), boxFaces(halfSize)); }

/// A point of a box between -1 and 1, on a face perpendicular to an axis that is chosen by `weights`; `side`
/// has the coordinates of the faces. axis: 1 at the chosen one.
SHARED_FN vec3 pointOnFaces(vec3 weights, vec3 side, vec2 u, OUT(vec3) axis) {
  float at = u.x * (weights.x + weights.y + weights.z);
  float onX = at < weights.x ? 1.0f : 0.0f;
  float onY = at < weights.x + weights.y ? 1.0f - onX : 0.0f;
  axis = vec3(onX, onY, 1.0f - onX - onY);
  float begin = onX > 0.5f ? 0.0f : (onY > 0.5f ? weights.x : weights.x + weights.y);
  float a = 2.0f * clamp((at - begin) / max(dot(axis, weights), 1e-30f), 0.0f, 1.0f) - 1.0f;
  float b = 2.0f * u.y - 1.0f;
  return vec3(onX > 0.5f ? side.x : a, onX > 0.5f ? a : (onY > 0.5f ? side.y : b),
              onX + onY > 0.5f ? b : side.z);
}

/// Where a ray of parallel light starts that enters the box (centre, halfSize): uniform over the box's
/// outline, half a diagonal in front of the face that it enters by.
SHARED_FN vec3 originBeforeBox(vec3 direction, vec3 centre, vec3 halfSize, vec2 u) {
  vec3 axis;
  vec3 side = vec3(direction.x > 0.0f ? -1.0f : 1.0f, direction.y > 0.0f ? -1.0f : 1.0f,
                   direction.z > 0.0f ? -1.0f : 1.0f);
  vec3 p = pointOnFaces(abs(direction) * boxFaces(halfSize), side, u, axis);
  return centre + p * halfSize - direction * (length(halfSize) + 1e-3f);
}

SHARED_END

#endif

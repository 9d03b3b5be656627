// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Pictures taken from a light: where the rays of their pixels run, what solid angle or area each pixel
// stands for, and where a point lies on them.
#ifndef ISOPHOTE_PHYSICS_LIGHT_VIEW_SHARED_H
#define ISOPHOTE_PHYSICS_LIGHT_VIEW_SHARED_H

#include "math/shared.h"
#include "physics/emission.shared.h"

SHARED_BEGIN

/// One planar picture from a light. Its plane is measured in tangents of the angle to `forward` (perspective:
/// point and spot lights) or in metres (orthographic: directional lights), its pixels from (0, 0) at the
/// plane's lower end in both coordinates. 80 bytes.
struct LightView {
  vec3 origin;  ///< Perspective: the light. Orthographic: centre of the rectangle in which rays start [m].
  float halfWidth;  ///< Of the plane, along `right`.
  vec3 right;
  float halfHeight;  ///< Along `up`.
  vec3 up;
  uint width;  ///< [pixels]
  vec3 forward;
  uint height;
  vec2 subpixel;       ///< Where in each pixel its ray runs, [0, 1)^2.
  float orthographic;  ///< 1 or 0.
  uint light;          ///< Index into the scene's lights.
};

/// Point of the plane at a position in pixels (pixel centres lie at halves).
SHARED_FN vec2 lightViewPlane(LightView v, vec2 pixel) {
  return vec2((2.0f * pixel.x / float(v.width) - 1.0f) * v.halfWidth,
              (2.0f * pixel.y / float(v.height) - 1.0f) * v.halfHeight);
}

SHARED_FN vec3 lightViewOrigin(LightView v, vec2 plane) {
  return v.origin + (v.right * plane.x + v.up * plane.y) * v.orthographic;
}

/// Unit.
SHARED_FN vec3 lightViewDirection(LightView v, vec2 plane) {
  vec3 aside = (v.right * plane.x + v.up * plane.y) * (1.0f - v.orthographic);
  return normalize(v.forward + aside);
}

/// Position in pixels (x, y) and depth along `forward` (z) [m] of a point; z <= 0: behind the view.
SHARED_FN vec3 lightViewProject(LightView v, vec3 position) {
  vec3 d = position - v.origin;
  float depth = dot(d, v.forward);
  float scale = v.orthographic > 0.5f ? 1.0f : 1.0f / max(depth, 1e-20f);
  return vec3((dot(d, v.right) * scale / v.halfWidth + 1.0f) * 0.5f * float(v.width),
              (dot(d, v.up) * scale / v.halfHeight + 1.0f) * 0.5f * float(v.height), depth);
}

/// Solid angle of the triangle (a, a + (x, 0), a + (x, y)) or (a, a + (0, y), a + (x, y)) in the plane at
/// distance 1 (van Oosterom and Strackee 1983); the triple product of its corners is x * y there, so that
/// small triangles keep their digits.
SHARED_FN float planarTriangleSolidAngle(vec2 a, vec2 b, vec2 c, float tripleProduct) {
  float la = sqrt(1.0f + dot(a, a));
  float lb = sqrt(1.0f + dot(b, b));
  float lc = sqrt(1.0f + dot(c, c));
  float below = la * lb * lc + (1.0f + dot(a, b)) * lc + (1.0f + dot(b, c)) * la + (1.0f + dot(c, a)) * lb;
  return 2.0f * atan(tripleProduct, below);
}

/// Exact solid angle of a rectangle in the plane at distance 1 [sr].
SHARED_FN float planarRectangleSolidAngle(vec2 lower, vec2 upper) {
  float twiceArea = (upper.x - lower.x) * (upper.y - lower.y);
  vec2 right = vec2(upper.x, lower.y);
  vec2 left = vec2(lower.x, upper.y);
  return planarTriangleSolidAngle(lower, right, upper, twiceArea) +
         planarTriangleSolidAngle(lower, left, upper, twiceArea);
}

/// What the pixel with that lower corner [pixels] stands for: its exact solid angle [sr], or its area [m^2]
/// where the view is orthographic. A planar map's pixels shrink with the cube of the cosine to its axis.
SHARED_FN float lightViewPixelMeasure(LightView v, vec2 pixel) {
  vec2 lower = lightViewPlane(v, pixel);
  vec2 upper = lightViewPlane(v, pixel + vec2(1.0f));
  return v.orthographic > 0.5f ? (upper.x - lower.x) * (upper.y - lower.y)
                               : planarRectangleSolidAngle(lower, upper);
}

/// The photon that the pixel with that lower corner emits, through the pixel's own point, for all that the
/// light sends through the pixel. Powers of a view sum to the light's in it: exactly for points and
/// directional lights, and up to the sampling of its falloff for a spot.
SHARED_FN EmittedPhoton emitThroughPixel(Light light, LightView v, vec2 pixel) {
  EmittedPhoton e;
  vec2 plane = lightViewPlane(v, pixel + v.subpixel);
  e.origin = lightViewOrigin(v, plane);
  e.direction = lightViewDirection(v, plane);
  float falloff = light.type == kLightSpot ? spotFalloff(light, dot(e.direction, light.direction)) : 1.0f;
  e.power = light.colour * (falloff * lightViewPixelMeasure(v, pixel));
  return e;
}

SHARED_END

#endif

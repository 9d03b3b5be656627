// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What a pixel takes of a neighbour's light when irradiance is smoothed.
#ifndef ISOPHOTE_STAGES_IRRADIANCE_BLUR_IRRADIANCE_BLUR_SHARED_H
#define ISOPHOTE_STAGES_IRRADIANCE_BLUR_IRRADIANCE_BLUR_SHARED_H

#include "math/shared.h"

SHARED_BEGIN

/// Distance from the pixel's tangent plane at which a neighbour counts for nothing, over the blur's radius
/// where the pixel is.
SHARED_CONST float kBlurDepthReach = 0.5f;

/// A unit normal in one word, 10 bits a component; 0 where there is no surface.
SHARED_FN uint packBlurNormal(vec3 n) {
  int x = int(floor(n.x * 511.0f + 0.5f));
  int y = int(floor(n.y * 511.0f + 0.5f));
  int z = int(floor(n.z * 511.0f + 0.5f));
  return uint(x & 1023) | (uint(y & 1023) << 10u) | (uint(z & 1023) << 20u);
}

SHARED_CONST float kBlurNormalScale = 1.0f / 511.0f;

/// To be multiplied by kBlurNormalScale.
SHARED_FN vec3 unpackBlurNormal(uint bits) {
  return vec3(float(int(bits << 22u) >> 22), float(int(bits << 12u) >> 22), float(int(bits << 2u) >> 22));
}

/// Weight by the distance on the screen, in units of the blur's reach (a pixel beyond its radius).
SHARED_FN float blurScreenWeight(float distance) { return 1.0f - distance * distance; }

/// Weight of a neighbour by its surface. alike: the dot product of the two geometric normals. off: distance
/// from the pixel's tangent plane, in units of the one at which it counts for nothing.
SHARED_FN float blurSurfaceWeight(float alike, float off) {
  float a2 = alike * alike;
  float a4 = a2 * a2;
  float near = 1.0f - off * off;
  float weight = a4 * a4 * near;
  return min(alike, near) > 0.0f ? weight : 0.0f;
}

SHARED_END

#endif

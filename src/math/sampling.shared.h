// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Warps from the unit square, and their densities.
#ifndef ISOPHOTE_MATH_SAMPLING_SHARED_H
#define ISOPHOTE_MATH_SAMPLING_SHARED_H

#include "math/shared.h"

SHARED_BEGIN

/// An orthonormal basis around unit n (Duff et al. 2017): columns are tangent, bitangent, n.
SHARED_FN mat3 basisAround(vec3 n) {
  float s = n.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (s + n.z);
  float b = n.x * n.y * a;
  return mat3(vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

/// Sine and cosine of 2 pi `turns`, turns in [-1, 1], by polynomials: vectorises where a library call would
/// not. The error is at most 2e-7.
SHARED_FN void sinCosOfTurns(float turns, OUT(float) sine, OUT(float) cosine) {
  // Quarter turns, and the rest in [-1/8, 1/8] of a turn.
  float quarters = float(int(4.0f * turns + (turns < 0.0f ? -0.5f : 0.5f)));
  float x = (turns - 0.25f * quarters) * (2.0f * kPi);
  float x2 = x * x;
  float s =
      x * (1.0f + x2 * (-1.6666667e-1f + x2 * (8.3333310e-3f + x2 * (-1.9840874e-4f + x2 * 2.7525562e-6f))));
  float c = 1.0f + x2 * (-0.5f + x2 * (4.1666638e-2f + x2 * (-1.3888378e-3f + x2 * 2.4760495e-5f)));
  int quadrant = int(quarters) & 3;
  float swappedSine = (quadrant & 1) != 0 ? c : s;
  float swappedCosine = (quadrant & 1) != 0 ? s : c;
  sine = quadrant >= 2 ? -swappedSine : swappedSine;
  cosine = quadrant == 1 || quadrant == 2 ? -swappedCosine : swappedCosine;
}

/// Uniform on the unit disc, area-preserving and without a seam (concentric map).
SHARED_FN vec2 sampleDisc(vec2 u) {
  vec2 p = 2.0f * u - vec2(1.0f);
  float wide = abs(p.x) > abs(p.y) ? 1.0f : 0.0f;
  float r = wide > 0.5f ? p.x : p.y;
  float q = wide > 0.5f ? p.y : p.x;
  float ratio = r != 0.0f ? q / r : 0.0f;
  float s, c;
  sinCosOfTurns(0.125f * ratio, s, c);
  return wide > 0.5f ? vec2(r * c, r * s) : vec2(r * s, r * c);
}

/// Cosine-distributed around +z; density cos(theta) / pi.
SHARED_FN vec3 sampleCosineHemisphere(vec2 u) {
  vec2 d = sampleDisc(u);
  return vec3(d.x, d.y, sqrt(max(0.0f, 1.0f - dot(d, d))));
}

/// Uniform over the unit sphere; density 1 / (4 pi).
SHARED_FN vec3 sampleSphere(vec2 u) {
  float z = 1.0f - 2.0f * u.x;
  float r = sqrt(max(0.0f, 1.0f - z * z));
  float s, c;
  sinCosOfTurns(u.y, s, c);
  return vec3(r * c, r * s, z);
}

/// sampleCone for 1 - cosMax, which keeps its digits where the cone is narrow.
SHARED_FN vec3 sampleNarrowCone(vec2 u, float oneMinusCosMax) {
  float below = u.x * oneMinusCosMax;
  float r = sqrt(max(0.0f, below * (2.0f - below)));
  float s, c;
  sinCosOfTurns(u.y, s, c);
  return vec3(r * c, r * s, 1.0f - below);
}

/// Uniform over the cone of directions around +z with cos(theta) >= cosMax; density 1 / (2 pi (1 - cosMax)).
SHARED_FN vec3 sampleCone(vec2 u, float cosMax) { return sampleNarrowCone(u, 1.0f - cosMax); }

/// Barycentric weights of the second and third vertex, uniform over the triangle's area.
SHARED_FN vec2 sampleTriangle(vec2 u) {
  float s = sqrt(u.x);
  return vec2(s * (1.0f - u.y), s * u.y);
}

/// A number as 16 bits; NaN, which unused lanes of a loop may hold, as 0, since it converts to no integer.
SHARED_FN uint packUnit(float x) { return uint(min(max(0.0f, x), 1.0f) * 65534.0f + 0.5f); }

/// Packs a unit vector into 2 x 16 bits (octahedral map); the error is at most 6.6e-5 radians.
SHARED_FN uint packDirection(vec3 v) {
  float scale = 1.0f / (abs(v.x) + abs(v.y) + abs(v.z));
  float x = v.x * scale;
  float y = v.y * scale;
  float foldedX = (1.0f - abs(y)) * (x >= 0.0f ? 1.0f : -1.0f);
  float foldedY = (1.0f - abs(x)) * (y >= 0.0f ? 1.0f : -1.0f);
  x = v.z >= 0.0f ? x : foldedX;
  y = v.z >= 0.0f ? y : foldedY;
  return packUnit(x * 0.5f + 0.5f) | (packUnit(y * 0.5f + 0.5f) << 16u);
}

/// No direction packs to this.
SHARED_CONST uint kNoDirection = 0xffffffffu;

SHARED_FN vec3 unpackDirection(uint bits) {
  // Signed, since older vector instructions convert no unsigned integers.
  float x = float(int(bits & 0xffffu)) * (2.0f / 65534.0f) - 1.0f;
  float y = float(int(bits >> 16u)) * (2.0f / 65534.0f) - 1.0f;
  float z = 1.0f - abs(x) - abs(y);
  float t = max(-z, 0.0f);
  x += x >= 0.0f ? -t : t;
  y += y >= 0.0f ? -t : t;
  return normalize(vec3(x, y, z));
}

SHARED_END

#endif

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Counter-based random numbers: a number is a pure function of (seed, pass, light, path, bounce, dimension),
// so that the order of work and the number of threads never matter.
#ifndef ISOPHOTE_MATH_RNG_SHARED_H
#define ISOPHOTE_MATH_RNG_SHARED_H

#include "math/shared.h"

SHARED_BEGIN

/// Three well mixed words from three (pcg3d: Jarzynski and Olano 2020, "Hash Functions for GPU Rendering",
/// and a last shift: its low bits alone are bound to those of neighbouring keys, which Owen scrambling would
/// show).
SHARED_FN uvec3 hash3(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v = v ^ (v >> 16u);
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v ^ (v >> 16u);
}

/// 24 random bits to [0, 1).
SHARED_FN float unitFloat(uint bits) { return float(bits >> 8u) * (1.0f / 16777216.0f); }

/// Key of one path: all numbers along it derive from this.
SHARED_FN uint pathKey(uint seed, uint pass, uint light, uint path) {
  uvec3 a = hash3(uvec3(seed, pass, light));
  return hash3(uvec3(a.x, a.y ^ path, a.z)).x;
}

/// Three numbers in [0, 1) of bounce `bounce`; `dimension` tells several triples of one bounce apart.
SHARED_FN vec3 random3(uint key, uint bounce, uint dimension) {
  uvec3 h = hash3(uvec3(key, bounce, dimension));
  return vec3(unitFloat(h.x), unitFloat(h.y), unitFloat(h.z));
}

SHARED_END

#endif

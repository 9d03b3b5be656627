// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Light by octants of direction: what each sends to a surface, by its normal.
#ifndef ISOPHOTE_STAGES_PHOTON_DIRECTIONAL_OCTANTS_SHARED_H
#define ISOPHOTE_STAGES_PHOTON_DIRECTIONAL_OCTANTS_SHARED_H

#include "math/shared.h"

SHARED_BEGIN

SHARED_CONST int kOctants = 8;
SHARED_CONST int kOctantPairs = 4;  ///< Octant i and its opposite, 7 - i.

/// Bit i is set where component i is negative: the octant that a direction lies in.
SHARED_FN uint octantOf(vec3 d) {
  return (d.x < 0.0f ? 1u : 0u) | (d.y < 0.0f ? 2u : 0u) | (d.z < 0.0f ? 4u : 0u);
}

/// -1 or 1 a component.
SHARED_FN vec3 octantSigns(uint octant) {
  return vec3((octant & 1u) != 0u ? -1.0f : 1.0f, (octant & 2u) != 0u ? -1.0f : 1.0f,
              (octant & 4u) != 0u ? -1.0f : 1.0f);
}

/// Integral of dot(w, m) over the directions w of the positive octant.
SHARED_FN float octantBalance(vec3 m) { return (m.x + m.y + m.z) * (0.25f * kPi); }

/// Integral of |dot(w, m)| over the directions w of the positive octant, by the seven directions and weights
/// that fit best (exact where all of the octant lies on one side of m, within 0.033 elsewhere; unit normals
/// give 0.46 to 1.36). It stands for a table over the normal: loops over lanes vectorise with it.
SHARED_FN float octantMagnitude(vec3 m) {
  float sum = m.x + m.y + m.z;
  float inner = sum * 0.05429f;
  float outer = sum * 0.15166f;
  return abs(m.x * 0.17277f + inner) + abs(m.y * 0.17277f + inner) + abs(m.z * 0.17277f + inner) +
         abs(outer - m.x * 0.12224f) + abs(outer - m.y * 0.12224f) + abs(outer - m.z * 0.12224f) +
         abs(sum) * 0.117018164f;
}

/// Integral of max(0, dot(w, n)) over the directions w of an octant: what radiance 1 from there sends to a
/// surface of normal n.
SHARED_FN float octantIrradiance(uint octant, vec3 n) {
  vec3 m = n * octantSigns(octant);
  return 0.5f * (octantMagnitude(m) + octantBalance(m));
}

/// Published weight of an octant, whose middle lies along `middle` (unit), at a surface of normal n.
SHARED_FN float publishedOctantWeight(vec3 n, vec3 middle) { return 2.0f * max(dot(n, middle), 0.0f); }

SHARED_END

#endif

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"
#include "math/simd.h"

#include <cstddef>
#include <cstdint>

namespace isophote::irradiance_blur {

inline constexpr int kGroup = 16;          ///< Pixels of a row that are worked on at once.
inline constexpr int kLargestRadius = 64;  ///< Pixels.
inline constexpr int kMostTaps = 2 * kLargestRadius + 1;

/// What is known of pixels, row by row.
struct Pixels {
  const float* depth;           ///< 1 / depth along the camera's axis; orthographic: depth [m].
  const std::uint32_t* normal;  ///< packBlurNormal
  const float *r, *g, *b;
};

/// How the directions of rays (orthographic: their origins) change on the screen, and when surfaces part.
struct Screen {
  vec3 stepX, stepY;   ///< From pixel to pixel.
  vec3 first;          ///< Of pixel (0, 0), 1 along the axis; orthographic: the axis.
  float inverseReach;  ///< 1 / distance from the tangent plane at which light counts for nothing, at depth 1.
  bool orthographic;
};

/// The neighbours of a pixel along a row or a column.
struct Taps {
  vec3 step;                ///< Screen::stepX or stepY.
  int first = 0, last = 0;  ///< Those to use, `last` not among them.
  std::ptrdiff_t offset[kMostTaps];
  float distance[kMostTaps];  ///< In pixels, signed.
  float weight[kMostTaps];    ///< By distance on the screen.
};

/// Mixes the light of neighbours at kGroup pixels, whose light lies at `light` and the rest at `at` in their
/// arrays and the first of which has the ray `direction`. Taps' offsets hold for both.
struct Mixed {
  float r[kGroup], g[kGroup], b[kGroup];
};
using MixFn = void (*)(const Pixels& pixels, const Screen& screen, const Taps& taps, vec3 direction,
                       Mixed& out);
MixFn mixFor(SimdLevel level);

}  // namespace isophote::irradiance_blur

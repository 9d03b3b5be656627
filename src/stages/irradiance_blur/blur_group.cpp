// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/irradiance_blur/blur_group.h"

#include "stages/irradiance_blur/irradiance_blur.shared.h"

namespace isophote::irradiance_blur {
namespace {

SHARED_FN void mixBody(const Pixels& pixels, const Screen& screen, const Taps& taps, vec3 direction,
                       Mixed& out) {
  // Distance from the tangent plane over its reach: start + distance * slope - scale * depth of a neighbour.
  // Loops without conditions: GCC would branch.
  float start[kGroup], slope[kGroup], scale[kGroup];
  const float parallel = screen.orthographic ? 1.0f : 0.0f, diverging = 1.0f - parallel;
  const vec3 stepX = screen.stepX * diverging;
  float nx[kGroup], ny[kGroup], nz[kGroup];
  for (int i = 0; i < kGroup; ++i) {
    const vec3 n = unpackBlurNormal(pixels.normal[i]) * kBlurNormalScale;
    const float depth = pixels.depth[i];
    const float along = dot(n, direction + stepX * float(i));
    start[i] = screen.inverseReach * along * (diverging - parallel * depth);
    slope[i] = screen.inverseReach * dot(n, taps.step);
    scale[i] = screen.inverseReach * along * (diverging / (depth + 1e-30f) - parallel);
    nx[i] = n.x * kBlurNormalScale;
    ny[i] = n.y * kBlurNormalScale;
    nz[i] = n.z * kBlurNormalScale;
  }
  float r[kGroup] = {}, g[kGroup] = {}, b[kGroup] = {}, sum[kGroup] = {}, weight[kGroup];
  for (int tap = taps.first; tap < taps.last; ++tap) {
    const std::ptrdiff_t at = taps.offset[tap];
    const float distance = taps.distance[tap], screenWeight = taps.weight[tap];
    const std::uint32_t* const normal = pixels.normal + at;
    const float *const depth = pixels.depth + at, *const red = pixels.r + at, *const green = pixels.g + at,
                       *const blue = pixels.b + at;
    for (int i = 0; i < kGroup; ++i) {
      const vec3 n = unpackBlurNormal(normal[i]);
      const float alike = n.x * nx[i] + n.y * ny[i] + n.z * nz[i];
      const float off = start[i] + distance * slope[i] - scale[i] * depth[i];
      weight[i] = screenWeight * blurSurfaceWeight(alike, off);
    }
    for (int i = 0; i < kGroup; ++i) {
      sum[i] += weight[i];
      r[i] += weight[i] * red[i];
      g[i] += weight[i] * green[i];
      b[i] += weight[i] * blue[i];
    }
  }
  for (int i = 0; i < kGroup; ++i) {
    const float inverse = 1.0f / (sum[i] + 1e-20f);
    out.r[i] = r[i] * inverse;
    out.g[i] = g[i] * inverse;
    out.b[i] = b[i] * inverse;
  }
}

ISOPHOTE_SIMD(mixGroup, mixBody,
              (const Pixels& pixels, const Screen& screen, const Taps& taps, vec3 direction, Mixed& out),
              (pixels, screen, taps, direction, out))

}  // namespace

MixFn mixFor(SimdLevel level) { return mixGroupFor(level); }

}  // namespace isophote::irradiance_blur

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <array>
#include <cstddef>

namespace isophote {

namespace detail {

/// x^(1/5) for x in (0, 1], by Newton's method; std::pow is no constant expression.
consteval double fifthRoot(double x) {
  double root = 1.0;
  for (int i = 0; i < 64; ++i)
    root -= (root * root * root * root * root - x) / (5.0 * root * root * root * root);
  return root;
}

consteval std::array<float, 256> makeLinearFrom8(bool srgb) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < 256; ++i) {
    const double c = double(i) / 255.0;
    const double base = (c + 0.055) / 1.055;
    const double base4 = base * base * base * base;
    const double decoded = c <= 0.04045 ? c / 12.92 : fifthRoot(base4 * base4 * base4);  // base^2.4
    table[i] = float(srgb ? decoded : c);
  }
  return table;
}

/// Texel to the left of coordinate u [textures], the one to its right, and the weight of the latter.
struct TexelPair {
  int first;
  int second;
  float weight;
};

/// floor(x) for |x| < 2^31, without the library call that it is on processors' common baseline.
inline float floorOf(float x) {
  const float towardsZero = float(int(x));
  return towardsZero > x ? towardsZero - 1.0f : towardsZero;
}

inline TexelPair texelPair(float u, int size, Wrap wrap, bool nearest) {
  // Beyond 2^24 a float has no fraction left; NaN lands here as well.
  u = abs(u) < 16777216.0f ? u : 0.0f;
  const float period = u - floorOf(u);
  const float mirrored = abs(u - 2.0f * floorOf(0.5f * u + 0.5f));
  const float wrapped = wrap == Wrap::kRepeat   ? period
                        : wrap == Wrap::kMirror ? mirrored
                                                : clamp(u, 0.0f, 1.0f);
  const float x = wrapped * float(size) - (nearest ? 0.0f : 0.5f);
  const float left = floorOf(x);
  const int first = int(left);
  const int last = size - 1;
  const auto inside = [&](int i) {
    return wrap == Wrap::kRepeat ? (i < 0 ? last : i > last ? 0 : i) : (i < 0 ? 0 : i > last ? last : i);
  };
  return {inside(first), inside(first + 1), nearest ? 0.0f : x - left};
}

}  // namespace detail

/// Linear value of an 8-bit one.
inline constexpr std::array<float, 256> kLinearFromSrgb8 = detail::makeLinearFrom8(true);
inline constexpr std::array<float, 256> kLinearFrom8 = detail::makeLinearFrom8(false);

/// Asks for the memory that sampleTexture(texture, uv) will read. Always inlined: GCC 12 takes a function
/// that only prefetches for one without effect and drops the call.
SHARED_FN void prefetchTexels(const Texture& texture, vec2 uv) {
  const detail::TexelPair x = detail::texelPair(uv.x, texture.width, texture.wrapU, texture.nearest);
  const detail::TexelPair y = detail::texelPair(uv.y, texture.height, texture.wrapV, texture.nearest);
  const std::uint8_t* column = texture.rgba.data() + std::size_t(x.first) * 4;
  __builtin_prefetch(column + std::size_t(y.first) * std::size_t(texture.width) * 4);
  __builtin_prefetch(column + std::size_t(y.second) * std::size_t(texture.width) * 4);
}

/// Texture at uv (glTF: v grows downwards) with its wrap modes and filter: linear RGB, and alpha.
inline vec4 sampleTexture(const Texture& texture, vec2 uv) {
  const detail::TexelPair x = detail::texelPair(uv.x, texture.width, texture.wrapU, texture.nearest);
  const detail::TexelPair y = detail::texelPair(uv.y, texture.height, texture.wrapV, texture.nearest);
  const float* decode = texture.srgb ? kLinearFromSrgb8.data() : kLinearFrom8.data();
  const auto texel = [&](int column, int row) {
    const std::uint8_t* t =
        texture.rgba.data() + (std::size_t(row) * std::size_t(texture.width) + std::size_t(column)) * 4;
    return vec4(decode[t[0]], decode[t[1]], decode[t[2]], kLinearFrom8[t[3]]);
  };
  const vec4 upper = mix(texel(x.first, y.first), texel(x.second, y.first), x.weight);
  const vec4 lower = mix(texel(x.first, y.second), texel(x.second, y.second), x.weight);
  return mix(upper, lower, y.weight);
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <array>
#include <cstddef>
#include <cstring>

namespace isophote {

namespace detail {

/// x^(1/5) for x in (0, 1], by Newton's method; std::pow is no constant expression.
consteval double fifthRoot(double x) {
  double root = 1.0;
  for (int i = 0; i < 64; ++i)
    root -= (root * root * root * root * root - x) / (5.0 * root * root * root * root);
  return root;
}

struct LinearFrom8 {
  float values[512];
};

consteval LinearFrom8 makeLinearFrom8() {
  LinearFrom8 table{};
  for (std::size_t i = 0; i < 256; ++i) {
    const double c = double(i) / 255.0;
    const double base = (c + 0.055) / 1.055;
    const double base4 = base * base * base * base;
    table.values[i] = float(c);
    table.values[256 + i] = float(c <= 0.04045 ? c / 12.92 : fifthRoot(base4 * base4 * base4));  // base^2.4
  }
  return table;
}

/// Values of 8-bit numbers, then those of sRGB-encoded ones.
inline constexpr LinearFrom8 kLinearFrom8 = makeLinearFrom8();

/// Texel to the left of coordinate u [textures], the one to its right, and the weight of the latter.
struct TexelPair {
  int first;
  int second;
  float weight;
};

/// floor(x) for |x| < 2^31, without the library call that it is on processors' common baseline.
SHARED_FN float floorOf(float x) {
  const float towardsZero = float(int(x));
  return towardsZero > x ? towardsZero - 1.0f : towardsZero;
}

/// The texture's wrap mode as two masks, -1 or 0; blends is 0 for a nearest filter, else 1. Masks and factors
/// instead of choices, which the compiler would gather into branches: loops over lanes call this.
SHARED_FN TexelPair texelPair(float u, int size, int repeats, int mirrors, float blends) {
  const float period = u - floorOf(u);
  const float mirrored = abs(u - 2.0f * floorOf(0.5f * u + 0.5f));
  const float notRepeated = mirrors != 0 ? mirrored : clamp(u, 0.0f, 1.0f);
  const float wrapped = repeats != 0 ? period : notRepeated;
  const float x = wrapped * float(size) - 0.5f * blends;
  const float left = floorOf(x);
  const int last = size - 1;
  const int first = int(left), second = first + 1;
  // Off the end, a repeated texture goes on at the other one.
  const int below = last & repeats, above = last & ~repeats;
  const int firstAtMost = first > last ? above : first, secondAtMost = second > last ? above : second;
  return {first < 0 ? below : firstAtMost, second < 0 ? below : secondAtMost, (x - left) * blends};
}

}  // namespace detail

/// Linear value of an 8-bit one.
SHARED_FN float linearFrom8(std::uint32_t value, bool srgb) {
  return detail::kLinearFrom8.values[(srgb ? 256u : 0u) + value];
}

/// What sampling reads of a texture.
struct TextureView {
  const std::uint8_t* rgba;
  int width;
  int height;
  int repeatsU;  ///< Masks and factor of detail::texelPair().
  int repeatsV;
  int mirrorsU;
  int mirrorsV;
  float blends;
  int curve;  ///< First of the 256 values of detail::kLinearFrom8 that decode it.
};

inline TextureView viewOf(const Texture& t) {
  return {t.rgba.data(),
          t.width,
          t.height,
          t.wrapU == Wrap::kRepeat ? -1 : 0,
          t.wrapV == Wrap::kRepeat ? -1 : 0,
          t.wrapU == Wrap::kMirror ? -1 : 0,
          t.wrapV == Wrap::kMirror ? -1 : 0,
          t.nearest ? 0.0f : 1.0f,
          t.srgb ? 256 : 0};
}

/// The four texels that a texture is interpolated between at one place.
struct TexelSquare {
  std::uint32_t index[4];  ///< Row by row; 4 bytes each.
  float weightX;
  float weightY;
};

/// uv as texelSquare() takes it: beyond 2^24 a float has no fraction left, and NaN lands there as well.
SHARED_FN vec2 boundedUv(vec2 uv) {
  return vec2(abs(uv.x) < 16777216.0f ? uv.x : 0.0f, abs(uv.y) < 16777216.0f ? uv.y : 0.0f);
}

/// uv: boundedUv().
SHARED_FN TexelSquare texelSquare(const TextureView& texture, vec2 uv) {
  const detail::TexelPair x =
      detail::texelPair(uv.x, texture.width, texture.repeatsU, texture.mirrorsU, texture.blends);
  const detail::TexelPair y =
      detail::texelPair(uv.y, texture.height, texture.repeatsV, texture.mirrorsV, texture.blends);
  const auto width = std::uint32_t(texture.width);
  const std::uint32_t upper = std::uint32_t(y.first) * width, lower = std::uint32_t(y.second) * width;
  const std::uint32_t left = std::uint32_t(x.first), right = std::uint32_t(x.second);
  return {{upper + left, upper + right, lower + left, lower + right}, x.weight, y.weight};
}

/// The bytes R, G, B, A of a texel, R lowest.
SHARED_FN std::uint32_t loadTexel(const std::uint8_t* rgba, std::uint32_t index) {
  std::uint32_t texel;
  std::memcpy(&texel, rgba + std::size_t(index) * 4, 4);
  return texel;
}

/// Interpolates between the texels of a square: linear RGB, and alpha. `curve` is the TextureView's.
SHARED_FN vec4 blendTexels(const TexelSquare& square, std::uint32_t t0, std::uint32_t t1, std::uint32_t t2,
                           std::uint32_t t3, int curve) {
  const auto decode = [&](std::uint32_t t) __attribute__((always_inline)) {
    return vec4(detail::kLinearFrom8.values[curve + int(t & 255u)],
                detail::kLinearFrom8.values[curve + int((t >> 8u) & 255u)],
                detail::kLinearFrom8.values[curve + int((t >> 16u) & 255u)],
                detail::kLinearFrom8.values[int(t >> 24u)]);
  };
  const vec4 upper = mix(decode(t0), decode(t1), square.weightX);
  const vec4 lower = mix(decode(t2), decode(t3), square.weightX);
  return mix(upper, lower, square.weightY);
}

/// Colour of a normal map between the texels of a square, mapped to [-1, 1].
SHARED_FN vec3 blendNormals(const TexelSquare& square, std::uint32_t t0, std::uint32_t t1, std::uint32_t t2,
                            std::uint32_t t3) {
  const auto decode = [](std::uint32_t t) __attribute__((always_inline)) {
    return vec3(float(int(t & 255u)), float(int((t >> 8u) & 255u)), float(int((t >> 16u) & 255u)));
  };
  const vec3 upper = mix(decode(t0), decode(t1), square.weightX);
  const vec3 lower = mix(decode(t2), decode(t3), square.weightX);
  return mix(upper, lower, square.weightY) * (2.0f / 255.0f) - 1.0f;
}

/// Normal map at uv.
inline vec3 sampleNormal(const TextureView& view, vec2 uv) {
  const TexelSquare square = texelSquare(view, boundedUv(uv));
  const auto texel = [&](std::size_t i) { return loadTexel(view.rgba, square.index[i]); };
  return blendNormals(square, texel(0), texel(1), texel(2), texel(3));
}

/// Texture at uv (glTF: v grows downwards) with its wrap modes and filter: linear RGB, and alpha, which is 1
/// for floats.
inline vec4 sampleTexture(const Texture& texture, vec2 uv) {
  const TextureView view = viewOf(texture);
  const TexelSquare square = texelSquare(view, boundedUv(uv));
  if (!texture.floats.empty()) {
    const auto at = [&](std::size_t i) { return texture.floats[square.index[i]]; };
    return vec4(mix(mix(at(0), at(1), square.weightX), mix(at(2), at(3), square.weightX), square.weightY),
                1.0f);
  }
  const auto texel = [&](std::size_t i) { return loadTexel(view.rgba, square.index[i]); };
  return blendTexels(square, texel(0), texel(1), texel(2), texel(3), view.curve);
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace isophote {

namespace {

/// No stone reflects more.
constexpr float kBrightest = 0.8f;

/// Well-mixed bits of two small numbers.
std::uint32_t hash(int x, int y) {
  std::uint32_t h = std::uint32_t(x) * 0x9E3779B1u ^ std::uint32_t(y) * 0x85EBCA77u;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return h ^ (h >> 15);
}

float random(int x, int y) { return float(hash(x, y) >> 8) / 16777216.0f; }

int wrapped(int i, int period) { return (i % period + period) % period; }

/// Smooth noise in [0, 1] that repeats after `period` lattice cells.
float noise(vec2 p, int period) {
  const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
  const vec2 f = p - vec2(float(x), float(y));
  const vec2 s = f * f * (3.0f - 2.0f * f);
  const auto at = [&](int i, int j) { return random(wrapped(i, period), wrapped(j, period)); };
  return mix(mix(at(x, y), at(x + 1, y), s.x), mix(at(x, y + 1), at(x + 1, y + 1), s.x), s.y);
}

/// Three octaves of noise in [0, 1]; `uv` in [0, 1) repeats.
float clouds(vec2 uv, int period) {
  float sum = 0;
  for (int octave = 0; octave < 3; ++octave) {
    sum += noise(uv * float(period << octave), period << octave) / float(2 << octave);
  }
  return sum / 0.875f;
}

/// sRGB code value of a linear colour channel, from a table of the curve.
std::uint8_t encoded(float linear) {
  static const auto table = [] {
    std::array<std::uint8_t, 4096> codes{};
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const float v = float(i) / float(codes.size() - 1);
      const float code = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
      codes[i] = std::uint8_t(code * 255.0f + 0.5f);
    }
    return codes;
  }();
  return table[std::size_t(std::clamp(linear, 0.0f, 1.0f) * 4095.0f + 0.5f)];
}

/// Fills a square texture from colour(uv) -> linear RGB and alpha.
template <class Colour>
Texture makeTexture(std::string name, int size, const Colour& colour) {
  Texture texture;
  texture.name = std::move(name);
  texture.width = texture.height = size;
  texture.rgba.reserve(std::size_t(size) * std::size_t(size) * 4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const vec4 c = colour((vec2(float(x), float(y)) + 0.5f) / float(size));
      for (const float channel : {c.x, c.y, c.z}) texture.rgba.push_back(encoded(channel));
      texture.rgba.push_back(std::uint8_t(std::clamp(c.w, 0.0f, 1.0f) * 255.0f + 0.5f));
    }
  }
  return texture;
}

}  // namespace

Texture stoneSlabs(std::string name, int size, int blocks, vec3 colour, vec3 joint) {
  const int rows = 2 * blocks;
  return makeTexture(std::move(name), size, [=](vec2 uv) {
    const float v = uv.y * float(rows);
    const int row = int(v);
    const float u = uv.x * float(blocks) + (row % 2 == 0 ? 0.0f : 0.5f);
    const int slab = wrapped(int(u), blocks);
    // Distance to the nearest joint, in units of a row's height; edges are a little uneven.
    const float wear = clouds(uv, 24);
    const vec2 inside(u - std::floor(u), v - std::floor(v));
    const float edge =
        min(2.0f * min(inside.x, 1.0f - inside.x), min(inside.y, 1.0f - inside.y)) + 0.02f * (wear - 0.5f);
    const float stone = clamp((edge - 0.018f) / 0.022f, 0.0f, 1.0f);
    const float tone =
        0.84f + 0.26f * random(slab, row) + 0.22f * (clouds(uv, 9) - 0.5f) + 0.12f * (wear - 0.5f);
    const float warmth = 0.10f * (random(slab + 71, row) - 0.5f);
    const vec3 tint(1.0f + warmth, 1.0f, 1.0f - warmth);
    return vec4(min(mix(joint, colour * tint * tone, stone), vec3(kBrightest)), 1.0f);
  });
}

Texture chequer(std::string name, int size, int squares, vec3 light, vec3 dark) {
  return makeTexture(std::move(name), size, [=](vec2 uv) {
    const vec2 p = uv * float(squares);
    const int x = int(p.x), y = int(p.y);
    const vec2 inside(p.x - float(x), p.y - float(y));
    const float edge = min(min(inside.x, 1.0f - inside.x), min(inside.y, 1.0f - inside.y));
    // Veins: thin lines where a cloud passes through its middle, different in every stone.
    const float cloud = clouds(uv + vec2(random(x, y), random(y, x + 9)), 6);
    const float vein = std::exp(-40.0f * std::abs(cloud - 0.5f));
    const bool isLight = (x + y) % 2 == 0;
    const float tone = 0.9f + 0.16f * random(x + 3, y) + (isLight ? -0.25f : 0.5f) * vein;
    const float joint = edge < 0.012f ? 0.55f : 1.0f;
    return vec4((isLight ? light : dark) * (tone * joint), 1.0f);
  });
}

Texture leaves(std::string name, int size, vec3 colour) {
  struct Leaf {
    vec2 foot, along;  ///< Foot; unit direction.
    float length;
  };
  std::array<Leaf, 11> sprig{};
  for (std::size_t i = 0; i < sprig.size(); ++i) {
    const float t = float(i) / float(sprig.size() - 1);
    const float side = i % 2 == 0 ? 1.0f : -1.0f;
    const float angle = i + 1 == sprig.size() ? 0.0f : side * (1.25f - 0.55f * t);
    sprig[i] = {{0.5f, 0.94f - 0.62f * t}, {std::sin(angle), -std::cos(angle)}, 0.36f - 0.10f * t};
  }
  Texture texture = makeTexture(std::move(name), size, [=](vec2 uv) {
    float alpha = std::abs(uv.x - 0.5f) < 0.008f && uv.y > 0.3f ? 1.0f : 0.0f;
    float tone = 0.7f;
    for (const Leaf& leaf : sprig) {
      const vec2 p = uv - leaf.foot;
      const float t = dot(p, leaf.along) / leaf.length;
      const float across = std::abs(p.x * leaf.along.y - p.y * leaf.along.x) / leaf.length;
      if (t < 0.0f || t > 1.0f || across > 0.62f * t * (1.0f - t) + 0.4f * t * (1.0f - t) * (1.0f - t))
        continue;
      alpha = 1.0f;
      tone = (across < 0.012f ? 1.3f : 0.85f + 0.3f * t) * (0.9f + 0.2f * noise(uv * 16.0f, 16));
    }
    return vec4(colour * tone, alpha);
  });
  texture.wrapU = texture.wrapV = Wrap::kClamp;
  return texture;
}

}  // namespace isophote

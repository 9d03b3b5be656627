// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/texture_convert.h"

#include "math/shared.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace isophote {

namespace {

/// Channels of a grey picture that was compressed differ by a few.
constexpr int kGreyTolerance = 24;

bool isGrey(const DecodedImage& image) {
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
    const auto [least, most] = std::minmax({image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]});
    if (most - least > kGreyTolerance) return false;
  }
  return true;
}

std::uint8_t byteOf(float x) { return std::uint8_t(clamp(x, 0.0f, 1.0f) * 255.0f + 0.5f); }

}  // namespace

float roughnessFromExponent(float exponent) { return sqrt(sqrt(2.0f / (exponent + 2.0f))); }

void normalsFromHeights(DecodedImage& image, float height) {
  if (!isGrey(image)) return;
  const int width = image.width, rows = image.height;
  std::vector<float> heights(std::size_t(width) * std::size_t(rows));
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = float(image.rgba[4 * i + 1]) * (height * float(width) / 255.0f);
  // Textures repeat: so do the slopes at their edges.
  const auto at = [&](int x, int y) {
    const int column = (x + width) % width, row = (y + rows) % rows;
    return heights[std::size_t(row) * std::size_t(width) + std::size_t(column)];
  };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < width; ++x) {
      const float alongU = 0.5f * (at(x + 1, y) - at(x - 1, y));
      const float alongV = 0.5f * (at(x, y + 1) - at(x, y - 1));
      // v grows downwards, a normal map's green upwards.
      const vec3 n = normalize(vec3(-alongU, alongV, 1.0f)) * 0.5f + 0.5f;
      std::uint8_t* to = &image.rgba[(std::size_t(y) * std::size_t(width) + std::size_t(x)) * 4];
      for (int k = 0; k < 3; ++k) to[k] = byteOf(n[k]);
    }
}

void roughnessFromExponents(DecodedImage& image, float exponent) {
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
    const float factor = float(image.rgba[i]) / 255.0f;
    image.rgba[i + 1] = byteOf(roughnessFromExponent(exponent * factor));
    image.rgba[i + 2] = 255;
  }
}

}  // namespace isophote

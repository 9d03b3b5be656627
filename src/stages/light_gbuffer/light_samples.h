// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/light_view.shared.h"
#include "trace/trace_scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace isophote {

/// Side of a block of a light view's pixels. Its pixels are numbered along a Morton curve, so that those with
/// consecutive numbers lie close together, and so do their random numbers' strata.
inline constexpr std::uint32_t kLightBlockSide = 32;
inline constexpr std::uint32_t kLightBlockPixels = kLightBlockSide * kLightBlockSide;

/// Up to 32 x 32 pixels of one view; less at its upper borders.
struct LightBlock {
  std::uint32_t view;  ///< Index into LightSamples::views.
  std::uint32_t x, y;  ///< Its lower pixel.
  std::uint32_t width, height;
  std::uint32_t
      firstPath;         ///< Its place in its light's numbering of pixels, a multiple of kLightBlockPixels.
  std::size_t firstHit;  ///< Hits of its pixels, without gaps, in LightSamples::hits.
};

/// All views of one light.
struct LightMap {
  std::uint32_t light;
  std::uint32_t firstBlock, blockCount;
  std::uint32_t photons;  ///< Pixels through which light leaves: the photons that the map emits.
  /// Factor that makes the emitted powers sum to the light's. 1 for points and directional lights, whose
  /// pixels divide all that they emit; corrects the sampling of a spot's falloff.
  float powerScale;
};

/// What each light sees first through every pixel of its views: a G-buffer of which 20 bytes a pixel are
/// kept. surfaceAt() gives position, normals, BSDF and emission at a hit (trace/surface.h), Hit::t is the
/// distance.
struct LightSamples {
  std::vector<LightMap> maps;  ///< By light, those alone that have views.
  std::vector<LightView> views;
  std::vector<LightBlock> blocks;
  std::vector<Hit> hits;
};

/// Column and row of each number along a block's Morton curve.
struct MortonPixel {
  std::uint8_t x, y;
};
inline constexpr std::array<MortonPixel, kLightBlockPixels> kMortonPixels = [] {
  std::array<MortonPixel, kLightBlockPixels> pixels{};
  for (std::uint32_t i = 0; i < kLightBlockPixels; ++i)
    for (std::uint32_t bit = 0; bit < 5; ++bit) {
      pixels[i].x = std::uint8_t(pixels[i].x | ((i >> (2 * bit) & 1u) << bit));
      pixels[i].y = std::uint8_t(pixels[i].y | ((i >> (2 * bit + 1) & 1u) << bit));
    }
  return pixels;
}();

/// Calls visit(number along the curve, pixel's lower corner in its view) for every pixel of the block, in the
/// order of its hits.
template <class Visit>
void forEachPixel(const LightBlock& block, Visit&& visit) {
  for (std::uint32_t i = 0; i < kLightBlockPixels; ++i) {
    const MortonPixel p = kMortonPixels[i];
    if (p.x < block.width && p.y < block.height) visit(i, vec2(float(block.x + p.x), float(block.y + p.y)));
  }
}

}  // namespace isophote

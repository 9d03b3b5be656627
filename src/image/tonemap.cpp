// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/tonemap.h"

#include "base/error.h"
#include "math/simd.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

namespace isophote {

namespace {

constexpr double kMiddleGrey = 0.18;
/// Far above what any curve tells from white, and small enough that its square is finite.
constexpr float kBrightest = 1e18f;
constexpr std::size_t kPixelsPerTask = 4096;

/// Pixels that are worked on together: their numbers fit the first cache.
constexpr std::size_t kBlockPixels = 256;
using Block = std::array<float, 3 * kBlockPixels>;

/// NaN and negative values become 0.
SHARED_FN float cleaned(float value) { return value > 0.0f ? min(value, kBrightest) : 0.0f; }

SHARED_FN float aces(float x) {
  // K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015: a ratio of two parabolas.
  return (x * (x * 2.51f + 0.03f)) / (x * (x * 2.43f + 0.59f) + 0.14f);
}

/// log2 of a normal number: exponent, and 2 artanh(s) / ln 2 with s = (m - 1) / (m + 1) of a mantissa m
/// between the roots of 1/2 and 2, whose series is below half a unit in the last place after these terms.
SHARED_FN float log2Of(float x) {
  constexpr std::int32_t kRootOfHalf = 0x3f3504f3;
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - kRootOfHalf) >> 23;
  const auto m = std::bit_cast<float>(bits - exponent * (1 << 23));
  const float s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  const float series = 1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))));
  return float(exponent) + s * series * 2.88539008f;
}

/// 2^y for y from -100 to 100: the series of exp within half an octave of a whole power.
SHARED_FN float exp2Of(float y) {
  const float whole = floor(y + 0.5f);
  const float x = (y - whole) * 0.693147181f;
  const float low = 1.0f + x * (1.0f + x * (0.5f + x * (1.0f / 6)));
  const float high = 1.0f / 24 + x * (1.0f / 120 + x * (1.0f / 720 + x * (1.0f / 5040)));
  return (low + x * x * x * x * high) * std::bit_cast<float>((std::int32_t(whole) + 127) * (1 << 23));
}

SHARED_FN float srgbCurve(float linear) {
  constexpr float kLinearTo = 0.0031308f;
  const float curved = 1.055f * exp2Of(log2Of(max(linear, kLinearTo)) * (1.0f / 2.4f)) - 0.055f;
  return linear <= kLinearTo ? 12.92f * linear : +curved;
}

/// What so many pixels look like, sRGB-encoded.
SHARED_FN void displayBody(const vec3* pixels, std::size_t count, float scale, ToneMap toneMap,
                           Block& __restrict out) {
  const float* const in = &pixels->x;
  for (std::size_t i = 0; i < 3 * count; ++i) out[i] = cleaned(in[i] * scale);
  if (toneMap == ToneMap::kAces) {
    for (std::size_t i = 0; i < 3 * count; ++i) out[i] = aces(out[i]);
  } else if (toneMap == ToneMap::kReinhard) {
    for (std::size_t i = 0; i < count; ++i) {
      float* const p = &out[3 * i];
      const float over = 1.0f + luminanceOf(vec3(p[0], p[1], p[2]));
      p[0] /= over;
      p[1] /= over;
      p[2] /= over;
    }
  }
  for (std::size_t i = 0; i < 3 * count; ++i) out[i] = srgbCurve(min(out[i], 1.0f));
}

SHARED_FN std::uint32_t byteOf(float encoded) { return std::uint32_t(std::int32_t(encoded * 255.0f + 0.5f)); }

SHARED_FN void rgbBody(const Block& block, std::size_t count, std::uint8_t* __restrict out) {
  for (std::size_t i = 0; i < 3 * count; ++i) out[i] = std::uint8_t(byteOf(block[i]));
}

SHARED_FN void rgbaBody(const Block& block, std::size_t count, std::uint32_t* __restrict out) {
  for (std::size_t i = 0; i < count; ++i)
    out[i] =
        byteOf(block[3 * i]) | byteOf(block[3 * i + 1]) << 8 | byteOf(block[3 * i + 2]) << 16 | 0xff000000u;
}

ISOPHOTE_SIMD(display, displayBody,
              (const vec3* pixels, std::size_t count, float scale, ToneMap toneMap, Block& out),
              (pixels, count, scale, toneMap, out))
ISOPHOTE_SIMD(packRgb, rgbBody, (const Block& block, std::size_t count, std::uint8_t* out),
              (block, count, out))
ISOPHOTE_SIMD(packRgba, rgbaBody, (const Block& block, std::size_t count, std::uint32_t* out),
              (block, count, out))

/// Calls store(first, count, block) for each block of pixels, from several threads.
template <class Store>
void forEachDisplayed(const Image& image, const DisplayOptions& options, const Store& store) {
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  const float ev = options.exposureEv + (options.autoExposure ? autoExposureEv(image) : 0.0f);
  const float scale = std::exp2(ev);
  const auto displayBlock = displayFor(bestSimdLevel());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, image.pixels.size(), kPixelsPerTask),
                    [&](const auto& range) {
                      Block block;
                      for (std::size_t i = range.begin(); i < range.end(); i += kBlockPixels) {
                        const std::size_t count = std::min(kBlockPixels, range.end() - i);
                        displayBlock(&image.pixels[i], count, scale, options.toneMap, block);
                        store(i, count, block);
                      }
                    });
}

std::array<float, 256> makeTable() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = linearFromSrgb(float(i) / 255.0f);
  return table;
}

}  // namespace

void parseExposure(std::string_view text, DisplayOptions& options) {
  if (text == "auto") {
    options.autoExposure = true;
    return;
  }
  float ev = 0.0f;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), ev);
  if (problem != std::errc() || end != text.data() + text.size() || !(std::abs(ev) <= 100.0f)) {
    failUsage("--exposure", "\"{}\" is not a number of EV from -100 to 100 and not \"auto\"", text);
  }
  options.exposureEv = ev;
  options.autoExposure = false;
}

float autoExposureEv(const Image& image) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const vec3& pixel : image.pixels) {
    const float luminance = luminanceOf(pixel);
    if (!(luminance > 0.0f && luminance <= std::numeric_limits<float>::max())) continue;
    sum += std::log2(double(luminance));
    ++count;
  }
  return count == 0 ? 0.0f : float(std::log2(kMiddleGrey) - sum / double(count));
}

float srgbFromLinear(float linear) { return srgbCurve(linear); }

float linearFromSrgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

const std::array<float, 256>& linearFromSrgb8() {
  static const std::array<float, 256> table = makeTable();
  return table;
}

Image displayed(const Image& image, const DisplayOptions& options) {
  Image result(image.width, image.height);
  forEachDisplayed(image, options, [&](std::size_t first, std::size_t count, const Block& block) {
    std::copy_n(block.data(), 3 * count, &result.pixels[first].x);
  });
  return result;
}

std::vector<std::uint8_t> displayedBytes(const Image& image, const DisplayOptions& options) {
  std::vector<std::uint8_t> bytes(image.pixels.size() * 3);
  const auto pack = packRgbFor(bestSimdLevel());
  forEachDisplayed(image, options, [&](std::size_t first, std::size_t count, const Block& block) {
    pack(block, count, &bytes[3 * first]);
  });
  return bytes;
}

void displayedRgba(const Image& image, const DisplayOptions& options, std::vector<std::uint32_t>& rgba) {
  rgba.resize(image.pixels.size());
  const auto pack = packRgbaFor(bestSimdLevel());
  forEachDisplayed(image, options, [&](std::size_t first, std::size_t count, const Block& block) {
    pack(block, count, &rgba[first]);
  });
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/tonemap.h"

#include "base/error.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <charconv>
#include <cmath>
#include <limits>

namespace isophote {

namespace {

constexpr double kMiddleGrey = 0.18;
/// Far above what any curve tells from white, and small enough that its square is finite.
constexpr float kBrightest = 1e18f;
constexpr std::size_t kPixelsPerTask = 4096;

/// NaN and negative values become 0.
float cleaned(float value) { return value > 0.0f ? std::min(value, kBrightest) : 0.0f; }

vec3 aces(vec3 x) {
  // K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015: a ratio of two parabolas.
  return (x * (x * 2.51f + 0.03f)) / (x * (x * 2.43f + 0.59f) + 0.14f);
}

vec3 toneMapped(vec3 colour, ToneMap toneMap) {
  switch (toneMap) {
    case ToneMap::kNone:
      return colour;
    case ToneMap::kAces:
      return aces(colour);
    case ToneMap::kReinhard:
      return colour / (1.0f + luminanceOf(colour));
  }
  return colour;
}

vec3 displayedPixel(vec3 colour, float scale, ToneMap toneMap) {
  const vec3 exposed(cleaned(colour.x * scale), cleaned(colour.y * scale), cleaned(colour.z * scale));
  const vec3 mapped = clamp(toneMapped(exposed, toneMap), 0.0f, 1.0f);
  return vec3(srgbFromLinear(mapped.x), srgbFromLinear(mapped.y), srgbFromLinear(mapped.z));
}

/// Calls store(i, encoded colour) for each pixel, from several threads.
template <class Store>
void forEachDisplayed(const Image& image, const DisplayOptions& options, const Store& store) {
  const float ev = options.exposureEv + (options.autoExposure ? autoExposureEv(image) : 0.0f);
  const float scale = std::exp2(ev);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, image.pixels.size(), kPixelsPerTask),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        store(i, displayedPixel(image.pixels[i], scale, options.toneMap));
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

float srgbFromLinear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linearFromSrgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

const std::array<float, 256>& linearFromSrgb8() {
  static const std::array<float, 256> table = makeTable();
  return table;
}

Image displayed(const Image& image, const DisplayOptions& options) {
  Image result(image.width, image.height);
  forEachDisplayed(image, options, [&](std::size_t i, vec3 colour) { result.pixels[i] = colour; });
  return result;
}

std::vector<std::uint8_t> displayedBytes(const Image& image, const DisplayOptions& options) {
  std::vector<std::uint8_t> bytes(image.pixels.size() * 3);
  forEachDisplayed(image, options, [&](std::size_t i, vec3 colour) {
    bytes[3 * i] = std::uint8_t(colour.x * 255.0f + 0.5f);
    bytes[3 * i + 1] = std::uint8_t(colour.y * 255.0f + 0.5f);
    bytes[3 * i + 2] = std::uint8_t(colour.z * 255.0f + 0.5f);
  });
  return bytes;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"
#include "settings/visit.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace isophote {

enum class ToneMap {
  kNone,     ///< Values above 1 are cut off.
  kAces,     ///< Narkowicz's fit of the ACES filmic curve (2015), channel by channel.
  kReinhard  ///< L / (1 + L) of the luminance L, hue kept (Reinhard et al. 2002, equation 3).
};

template <>
struct EnumNames<ToneMap> {
  static constexpr std::array<std::string_view, 3> names{"none", "aces", "reinhard"};
};

/// How linear radiance becomes a picture on a screen: scale by 2^exposure, tone map, clamp to [0, 1], sRGB
/// curve.
struct DisplayOptions {
  float exposureEv = 0.0f;
  bool autoExposure = false;
  ToneMap toneMap = ToneMap::kNone;

  void visit(auto&& v) {
    v("exposureEv", exposureEv,
      {.help = "Brightens the picture by 2^EV.", .unit = "EV", .min = -100, .max = 100});
    v("autoExposure", autoExposure,
      {.help = "Adds the exposure that brings the picture's average to middle grey."});
    v("toneMap", toneMap, {.help = "Curve that brings bright values into the screen's range."});
  }
};

/// Reads what --exposure takes, a number of EV or `auto`, into `options`; anything else throws
/// Error(kBadUsage).
void parseExposure(std::string_view text, DisplayOptions& options);

/// Luminance of linear Rec.709.
SHARED_FN float luminanceOf(vec3 colour) { return dot(colour, vec3(0.2126f, 0.7152f, 0.0722f)); }

/// The exposure [EV] that brings the log-average luminance of all pixels that are finite and brighter than 0
/// to middle grey, 0.18; 0 where no pixel is.
float autoExposureEv(const Image& image);

/// The sRGB curve (IEC 61966-2-1), linear [0, 1] to encoded [0, 1], and its inverse.
float srgbFromLinear(float linear);
float linearFromSrgb(float encoded);

/// linearFromSrgb(i / 255) for each i: for textures.
const std::array<float, 256>& linearFromSrgb8();

/// The picture as it is shown: every channel in [0, 1], sRGB-encoded. NaN and negative values are shown as 0,
/// infinity as the brightest value that the tone map gives.
Image displayed(const Image& image, const DisplayOptions& options);

/// displayed() rounded to 8 bits, 3 * width * height bytes.
std::vector<std::uint8_t> displayedBytes(const Image& image, const DisplayOptions& options);
/// The same bytes with an opaque alpha behind them, red lowest, a word a pixel: for a window. Reuses memory.
void displayedRgba(const Image& image, const DisplayOptions& options, std::vector<std::uint32_t>& rgba);

}  // namespace isophote

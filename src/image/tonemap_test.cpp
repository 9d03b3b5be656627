// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/tonemap.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace isophote {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Image onePixel(vec3 colour) { return Image(1, 1, colour); }

vec3 shown(vec3 colour, const DisplayOptions& options = {}) {
  return displayed(onePixel(colour), options).at(0, 0);
}

TEST(ToneMap, SrgbCurveHasTheStandardsValues) {
  // 1.055 * 0.18^(1/2.4) - 0.055 with 0.18^(1/2.4) = exp(-1.714798 / 2.4) = 0.489437.
  EXPECT_NEAR(srgbFromLinear(0.18f), 0.461356f, 1e-5f);
  EXPECT_NEAR(srgbFromLinear(0.5f), 0.735357f, 1e-5f);
  EXPECT_NEAR(srgbFromLinear(0.002f), 0.02584f, 1e-7f);
  EXPECT_NEAR(srgbFromLinear(1.0f), 1.0f, 1e-6f);
  for (int i = 0; i < 256; ++i) {
    const float linear = linearFromSrgb8()[std::size_t(i)];
    EXPECT_EQ(int(srgbFromLinear(linear) * 255.0f + 0.5f), i);
  }
  EXPECT_EQ(linearFromSrgb8()[0], 0.0f);
  EXPECT_EQ(linearFromSrgb8()[255], 1.0f);
}

TEST(ToneMap, SrgbCurveIsThatOfDoublePrecision) {
  double worst = 0;
  for (int i = 0; i <= 100'000; ++i) {
    const float linear = float(i) / 100'000.0f;
    const double exact =
        linear <= 0.0031308f ? 12.92 * double(linear) : 1.055 * std::pow(double(linear), 1.0 / 2.4) - 0.055;
    worst = std::max(worst, std::abs(double(srgbFromLinear(linear)) - exact));
  }
  EXPECT_LT(worst, 5e-7);
}

TEST(ToneMap, BytesAndWordsAreTheRoundedPicture) {
  Image image(67, 9);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = vec3(float(i) / 300.0f, float(i % 17) / 15.0f, std::exp2(float(i % 23) - 20.0f));
  for (const ToneMap toneMap : {ToneMap::kNone, ToneMap::kAces, ToneMap::kReinhard}) {
    const DisplayOptions options{.exposureEv = -0.3f, .toneMap = toneMap};
    const Image picture = displayed(image, options);
    const std::vector<std::uint8_t> bytes = displayedBytes(image, options);
    std::vector<std::uint32_t> rgba;
    displayedRgba(image, options, rgba);
    ASSERT_EQ(rgba.size(), image.pixels.size());
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto rounded = std::uint8_t(picture.pixels[i][int(c)] * 255.0f + 0.5f);
        EXPECT_EQ(bytes[3 * i + c], rounded);
        EXPECT_EQ(rgba[i] >> 8 * c & 0xffu, rounded);
      }
      EXPECT_EQ(rgba[i] >> 24, 255u);
    }
  }
}

TEST(ToneMap, CurvesHaveTheirFormulasValues) {
  // ACES of 1 is (2.51 + 0.03) / (2.43 + 0.59 + 0.14) = 2.54 / 3.16 = 0.803797.
  EXPECT_NEAR(shown(vec3(1.0f), {.toneMap = ToneMap::kAces}).x, srgbFromLinear(0.803797f), 1e-5f);
  // Luminance of (1, 0, 0) is 0.2126: Reinhard gives 1 / 1.2126 = 0.824674, and green stays 0.
  const vec3 red = shown(vec3(1.0f, 0.0f, 0.0f), {.toneMap = ToneMap::kReinhard});
  EXPECT_NEAR(red.x, srgbFromLinear(0.824674f), 1e-5f);
  EXPECT_EQ(red.y, 0.0f);
  EXPECT_NEAR(shown(vec3(3.0f), {.toneMap = ToneMap::kReinhard}).x, srgbFromLinear(0.75f), 1e-5f);
  EXPECT_NEAR(shown(vec3(3.0f)).x, 1.0f, 1e-6f);
}

TEST(ToneMap, ExposureIsAPowerOfTwo) {
  EXPECT_NEAR(shown(vec3(0.125f), {.exposureEv = 2.0f}).x, srgbFromLinear(0.5f), 1e-6f);
  EXPECT_NEAR(shown(vec3(0.5f), {.exposureEv = -1.0f}).x, srgbFromLinear(0.25f), 1e-6f);
}

TEST(ToneMap, AutoExposureBringsTheGeometricMeanToMiddleGrey) {
  Image image(2, 1);
  image.pixels = {vec3(0.09f), vec3(0.36f)};  // sqrt(0.09 * 0.36) = 0.18
  EXPECT_NEAR(autoExposureEv(image), 0.0f, 1e-5f);
  EXPECT_NEAR(autoExposureEv(onePixel(vec3(0.045f))), 2.0f, 1e-5f);
  image = Image(5, 1);
  image.pixels = {vec3(0.0f), vec3(kNan), vec3(kInfinity), vec3(-1.0f), vec3(0.72f)};
  EXPECT_NEAR(autoExposureEv(image), -2.0f, 1e-5f);
  EXPECT_EQ(autoExposureEv(onePixel(vec3(0.0f))), 0.0f);
  // Compensation comes on top: middle grey twice as bright is 0.36.
  const vec3 brighter = shown(vec3(0.01f), {.exposureEv = 1.0f, .autoExposure = true});
  EXPECT_NEAR(brighter.x, srgbFromLinear(0.36f), 1e-5f);
}

TEST(ToneMap, ImpossibleRadianceIsBlackOrWhite) {
  for (const ToneMap toneMap : {ToneMap::kNone, ToneMap::kAces, ToneMap::kReinhard}) {
    const DisplayOptions options{.toneMap = toneMap};
    EXPECT_EQ(shown(vec3(kNan, -1.0f, -kInfinity), options), vec3(0.0f));
    const vec3 bright = shown(vec3(kInfinity, 1e38f, 1e38f), options);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(bright[c], 1.0f, 1e-5f);
  }
  EXPECT_EQ(displayedBytes(onePixel(vec3(kNan, 0.18f, kInfinity)), {}),
            (std::vector<std::uint8_t>{0, 118, 255}));
}

TEST(ToneMap, ExposureIsReadFromText) {
  DisplayOptions options;
  parseExposure("-1.5", options);
  EXPECT_EQ(options.exposureEv, -1.5f);
  parseExposure("auto", options);
  EXPECT_TRUE(options.autoExposure);
  parseExposure("0", options);
  EXPECT_FALSE(options.autoExposure);
  for (const char* bad : {"", "bright", "1x", "nan", "1e9"}) {
    try {
      parseExposure(bad, options);
      ADD_FAILURE() << bad << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadUsage);
    }
  }
}

}  // namespace
}  // namespace isophote

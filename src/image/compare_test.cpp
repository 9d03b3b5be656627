// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/compare.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace isophote {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A grey that is shown as `value`.
vec3 shownAs(float value) { return vec3(linearFromSrgb(value)); }

std::string errorOf(const auto& call) {
  try {
    call();
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(Compare, EqualPicturesAreEqual) {
  Image image(16, 12);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = vec3(float(i) / 192.0f, 0.5f, 0.1f);
  const Comparison same = compareImages(image, image);
  EXPECT_EQ(same.psnr, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(same.ssim, 1.0, 1e-12);
  EXPECT_EQ(same.relMse, 0.0);
  EXPECT_EQ(same.meanRatio, 1.0);
}

TEST(Compare, PsnrOfAConstantDifference) {
  // Shown values differ by 0.1 everywhere: 10 log10(1 / 0.01) = 20 dB.
  EXPECT_NEAR(compareImages(Image(4, 3, shownAs(0.6f)), Image(4, 3, shownAs(0.5f))).psnr, 20.0, 1e-4);
  // One channel of one pixel of four differs by 1: mean squared difference 1 / 12, 10.7918 dB.
  Image black(2, 2), red(2, 2);
  red.at(1, 0).x = 1.0f;
  EXPECT_NEAR(compareImages(black, red).psnr, 10.7918, 1e-4);
  // Beyond white nothing differs.
  EXPECT_EQ(compareImages(Image(2, 2, vec3(1.0f)), Image(2, 2, vec3(7.0f))).psnr,
            std::numeric_limits<double>::infinity());
}

TEST(Compare, SsimOfConstants) {
  // No variance: (2 * 0 + C1) / (0.1^2 + C1) with C1 = 0.0001, that is 0.0001 / 0.0101.
  const double expected = 0.0001 / 0.0101;
  EXPECT_NEAR(compareImages(Image(20, 15), Image(20, 15, shownAs(0.1f))).ssim, expected, 1e-7);
  EXPECT_NEAR(compareImages(Image(1, 1), Image(1, 1, shownAs(0.1f))).ssim, expected, 1e-7);
  EXPECT_NEAR(compareImages(Image(40, 2), Image(40, 2, shownAs(0.1f))).ssim, expected, 1e-7);
}

TEST(Compare, SsimOfADotInOneWindow) {
  // 11 x 11: the Gaussian's weights are exp(-x^2 / 4.5) over their sum, 1 + 2 (0.800737 + 0.411112 + 0.135335
  // + 0.028566 + 0.003866) = 3.759232. A white dot in the middle weighs w = 1 / 3.759232^2 = 0.0707623: that
  // is its mean and its mean square, so its variance is w - w^2 = 0.0657550. Against black the similarity is
  // C1 / (w^2 + C1) * C2 / (variance + C2) = 0.0195798 * 0.0135024.
  Image dot(11, 11);
  dot.at(5, 5) = vec3(1.0f);
  EXPECT_NEAR(compareImages(dot, Image(11, 11)).ssim, 2.64374e-4, 2e-8);
  // In 4 x 3 there are two windows of 3 x 3, with weights 0.307801, 0.384397, 0.307801. The dot at (1, 1) is
  // in the middle of the first, w = 0.147761: 0.0001 / 0.0219333 * 0.0009 / 0.126828 = 3.23538e-5; and at the
  // left edge of the second, w = 0.307801 * 0.384397 = 0.118318: 0.0001 / 0.0140991 * 0.0009 / 0.105219
  // = 6.06682e-5.
  dot = Image(4, 3);
  dot.at(1, 1) = vec3(1.0f);
  EXPECT_NEAR(compareImages(dot, Image(4, 3)).ssim, 0.5 * (3.23538e-5 + 6.06682e-5), 1e-9);
}

TEST(Compare, SsimFallsWithContrastAndStructure) {
  // A checkerboard and its negative have the covariance of opposite sign.
  Image a(24, 24), b(24, 24);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      a.at(x, y) = vec3(float((x + y) % 2));
      b.at(x, y) = vec3(float((x + y + 1) % 2));
    }
  }
  EXPECT_LT(compareImages(a, b).ssim, -0.9);
}

TEST(Compare, LinearMeasures) {
  // (0.2 - 0.1)^2 / (0.1^2 + 0.01) = 0.5 in one of three channels; sums 0.2 and 0.1.
  const Comparison result =
      compareImages(Image(1, 1, vec3(0.2f, 0.0f, 0.0f)), Image(1, 1, vec3(0.1f, 0.0f, 0.0f)));
  EXPECT_NEAR(result.relMse, 0.5 / 3.0, 1e-6);
  EXPECT_NEAR(result.meanRatio, 2.0, 1e-6);
  // Values beyond white count: (6 - 2)^2 / (4 + 0.01).
  EXPECT_NEAR(compareImages(Image(2, 2, vec3(6.0f)), Image(2, 2, vec3(2.0f))).relMse, 16.0 / 4.01, 1e-6);
  EXPECT_EQ(compareImages(Image(2, 2), Image(2, 2)).meanRatio, 1.0);
}

TEST(Compare, NonFinitePixelsAreCountedAndLeftOut) {
  Image a(3, 1, vec3(0.5f)), b(3, 1, vec3(0.25f));
  a.at(0, 0).y = kNan;
  a.at(1, 0).z = std::numeric_limits<float>::infinity();
  b.at(1, 0).x = kNan;
  const Comparison result = compareImages(a, b);
  EXPECT_EQ(result.nonFiniteA, 2u);
  EXPECT_EQ(result.nonFiniteB, 1u);
  EXPECT_EQ(result.meanRatio, 2.0);
  EXPECT_TRUE(std::isfinite(result.psnr));
  EXPECT_TRUE(std::isfinite(result.ssim));
}

TEST(Compare, RefusesDifferentSizes) {
  EXPECT_EQ(errorOf([] { compareImages(Image(3, 2), Image(2, 3)); }),
            "pictures of 3 x 2 and 2 x 3 pixels cannot be compared; render both at one size");
  EXPECT_NE(errorOf([] { compareImages(Image(), Image()); }), "");
}

TEST(Compare, JsonHasNullForInfinity) {
  const auto json = nlohmann::json::parse(toJson(compareImages(Image(2, 2), Image(2, 2))));
  EXPECT_TRUE(json.at("psnr").is_null());
  EXPECT_EQ(json.at("ssim").get<double>(), 1.0);
  EXPECT_EQ(json.at("nonFiniteB").get<int>(), 0);
}

TEST(Compare, SelectsLayers) {
  Film film;
  film.colour = Image(1, 1, vec3(1.0f));
  EXPECT_EQ(errorOf([&] { selectLayer(film, "direct", "a.exr"); }),
            "a.exr: has no layer \"direct\"; it holds the picture alone");
  film.layers["direct"] = Image(1, 1, vec3(2.0f));
  film.layers["indirect"] = Image(1, 1, vec3(3.0f));
  EXPECT_EQ(selectLayer(film, "", "a.exr").at(0, 0).x, 1.0f);
  EXPECT_EQ(selectLayer(film, "indirect", "a.exr").at(0, 0).x, 3.0f);
  EXPECT_EQ(errorOf([&] { selectLayer(film, "indirekt", "a.exr"); }),
            "a.exr: has no layer \"indirekt\" (did you mean \"indirect\"?); its layers are direct, indirect");
}

}  // namespace
}  // namespace isophote

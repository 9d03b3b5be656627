// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/flip.h"

#include "image/error_colour.h"
#include "image/lab.h"
#include "image/tonemap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isophote {
namespace {

double meanOf(const std::vector<float>& errors) {
  return std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size());
}

void expectNear(vec3 actual, vec3 expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], tolerance) << c;
}

/// A grey picture whose columns are 0 up to `edge` and 1 from there.
Image step(int width, int height, int edge) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = edge; x < width; ++x) image.at(x, y) = vec3(1.0f);
  return image;
}

Image stripes(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at(x, y) = vec3(float(x / 3 % 2), float(y / 2 % 2), 0.5f);
  return image;
}

/// Each pixel the mean of the 3 x 3 around it.
Image boxBlurred(const Image& image) {
  Image result(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int i = 0; i < 9; ++i) {
        result.at(x, y) += image.at(std::clamp(x + i % 3 - 1, 0, image.width - 1),
                                    std::clamp(y + i / 3 - 1, 0, image.height - 1)) /
                           9.0f;
      }
    }
  }
  return result;
}

TEST(Lab, HasTheStandardsValues) {
  expectNear(relativeXyzFromLinear(vec3(1.0f)), vec3(1.0f), 1e-6f);
  expectNear(labFromLinear(vec3(1.0f)), vec3(100.0f, 0.0f, 0.0f), 1e-4f);
  expectNear(labFromLinear(vec3(0.0f)), vec3(0.0f), 1e-4f);
  // L* of 18 % grey is 116 * 0.18^(1/3) - 16 = 49.496.
  expectNear(labFromLinear(vec3(0.18f)), vec3(49.496f, 0.0f, 0.0f), 1e-3f);
  // The primaries, as tables of colours list them.
  expectNear(labFromLinear({1, 0, 0}), vec3(53.24f, 80.09f, 67.20f), 0.02f);
  expectNear(labFromLinear({0, 1, 0}), vec3(87.73f, -86.18f, 83.18f), 0.02f);
  expectNear(labFromLinear({0, 0, 1}), vec3(32.30f, 79.19f, -107.86f), 0.02f);
}

TEST(Lab, ConversionsHaveInverses) {
  for (const vec3 colour : {vec3(0.2f, 0.7f, 0.05f), vec3(0.001f, 0.0f, 0.002f), vec3(1.0f, 0.5f, 0.9f)}) {
    expectNear(linearFromLab(labFromLinear(colour)), colour, 1e-5f);
    expectNear(linearFromYcxcz(ycxczFromLinear(colour)), colour, 1e-5f);
  }
}

TEST(Flip, EqualPicturesDoNotDiffer) {
  const Image image = stripes(40, 30);
  for (const float error : flipErrors(image, image)) EXPECT_EQ(error, 0.0f);
}

TEST(Flip, ConstantPicturesHaveTheFormulasValue) {
  // Filters leave constants alone, and there is neither edge nor point: only the colours count.
  // Black and white: HyAB is 100, and 100^0.7 = 25.1189. Green, Hunt-adjusted, is (87.736, -75.612, 72.984),
  // blue (32.301, 25.581, -34.838): HyAB = 55.435 + sqrt(101.193^2 + 107.822^2) = 203.305, to the power of
  // 0.7 41.277, of which the knee is 0.4, 16.511. 0.95 + 0.05 (25.1189 - 16.511) / (41.277 - 16.511) =
  // 0.96738.
  for (const float error : flipErrors(Image(25, 20), Image(25, 20, vec3(1.0f))))
    EXPECT_NEAR(error, 0.96738f, 2e-5f);
  // Green and blue are the largest difference that there is.
  for (const float error : flipErrors(Image(9, 9, {0, 1, 0}), Image(9, 9, {0, 0, 1})))
    EXPECT_NEAR(error, 1.0f, 1e-4f);
  // Grey encoded as 0.5 is 0.214041 in linear light, L* = 53.3890; 0.6 is 0.318547, L* = 63.2226. The
  // difference to the power of 0.7 is 4.95336; times 0.95 / 16.511 it is 0.28501.
  const std::vector<float> greys = flipErrors(Image(12, 7, vec3(0.5f)), Image(12, 7, vec3(0.6f)));
  for (const float error : greys) EXPECT_NEAR(error, 0.28501f, 1e-5f);
}

TEST(Flip, IsSymmetric) {
  const Image a = stripes(33, 21), b = boxBlurred(a);
  EXPECT_EQ(flipErrors(a, b), flipErrors(b, a));
}

TEST(Flip, MirroredPicturesHaveMirroredErrors) {
  const Image a = step(41, 20, 15), b = step(41, 20, 18);
  const Image aMirrored = step(41, 20, 41 - 15), bMirrored = step(41, 20, 41 - 18);
  // Mirrored columns swap black and white; complement them by swapping which is compared.
  Image aFlipped(41, 20), bFlipped(41, 20);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 41; ++x) {
      aFlipped.at(x, y) = vec3(1.0f) - aMirrored.at(x, y);
      bFlipped.at(x, y) = vec3(1.0f) - bMirrored.at(x, y);
    }
  }
  // Rounding of a* and b*, 500 times that of the roots that they come from, is up to 1e-4 beside errors of 0:
  // 0.0575 (2e-4)^0.7 = 1.5e-4 in either.
  const std::vector<float> errors = flipErrors(a, b), mirrored = flipErrors(aFlipped, bFlipped);
  for (std::size_t y = 0; y < 20; ++y)
    for (std::size_t x = 0; x < 41; ++x) EXPECT_NEAR(errors[y * 41 + x], mirrored[y * 41 + 40 - x], 3e-4f);
}

TEST(Flip, AnEdgeAndItsTransposeScoreAlike) {
  const Image across = step(24, 24, 12), none(24, 24, vec3(0.5f));
  Image down(24, 24);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) down.at(x, y) = across.at(y, x);
  const std::vector<float> a = flipErrors(across, none), b = flipErrors(down, none);
  for (std::size_t y = 0; y < 24; ++y)
    for (std::size_t x = 0; x < 24; ++x) EXPECT_NEAR(a[y * 24 + x], b[x * 24 + y], 1e-5f);
}

TEST(Flip, AnEdgeRaisesTheErrorAsItsStrengthSays) {
  // A step from 0 to 1 lies between pixels 31 and 32. The detector of edges, cut off at radius r = ceil(3
  // sigma) with sigma = 0.041 * 67 = 2.747, gives the pixel 32 the sum of the weights of 0 ... r on one side:
  // those of one sign sum to 1, so its strength is 1 there and on pixel 31 too. The detector of points gives
  // less. So against black of no edge the feature error of both pixels is sqrt(1 / sqrt(2)) = 0.840896, and
  // the error is that of the colours to the power 1 - 0.840896 = 0.159104.
  const Image edge = step(64, 9, 32), black(64, 9);
  const std::vector<float> errors = flipErrors(edge, black);
  // Pixel 32 keeps of the white, blurred with Gaussian weights exp(-i^2 / (2 s^2)), s = 67 sqrt(0.0047 / (2
  // pi^2)) = 1.03386: 0.5 + 0.5 / (1 + 2 (0.626401 + 0.153966 + 0.014849 + 0.000562 + 0.000008)) = 0.693092.
  // Grey has Cx = Cz = 0 throughout, so this is its linear value; L* = 116 * 0.884970 - 16 = 86.6565.
  // 86.6565^0.7 = 22.7200; 0.95 + 0.05 (22.7200 - 16.511) / 24.767 = 0.962535, to the power 0.159104:
  // 0.993943.
  EXPECT_NEAR(errors[4 * 64 + 32], 0.993943f, 5e-5f);
  // Far from the edge there is black on one side, and no feature on either.
  EXPECT_NEAR(errors[4 * 64 + 5], 0.0f, 1e-6f);
  EXPECT_NEAR(errors[4 * 64 + 60], 0.96738f, 2e-5f);
}

TEST(Flip, GrowsWithBlur) {
  // Blurred again and again, as a Gaussian blurs: no frequency grows back.
  const Image sharp = stripes(48, 36);
  Image blurred = sharp;
  double last = 0.0;
  for (int times = 1; times <= 6; ++times) {
    blurred = boxBlurred(blurred);
    const double error = meanOf(flipErrors(sharp, blurred));
    EXPECT_GT(error, last) << times;
    last = error;
  }
  EXPECT_GT(last, 0.05);
}

TEST(Flip, FineDetailVanishesWithDistance) {
  // A checkerboard of single pixels against the grey of the same light.
  Image board(60, 60);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) board.at(x, y) = vec3(float((x + y) % 2));
  const Image grey(60, 60, vec3(srgbFromLinear(0.5f)));
  const auto middle = [](const std::vector<float>& errors) { return errors[30 * 60 + 30]; };
  EXPECT_LT(middle(flipErrors(board, grey, 300.0f)), 0.01f);
  EXPECT_GT(middle(flipErrors(board, grey, 20.0f)), 0.5f);
}

TEST(Flip, SurvivesTinyPicturesAndExtremeDistances) {
  for (const float pixelsPerDegree : {1.0f, 67.0f, 1000.0f}) {
    for (const float error : flipErrors(Image(1, 1), Image(1, 1, vec3(1.0f)), pixelsPerDegree))
      EXPECT_NEAR(error, 0.96738f, 2e-5f);
    for (const float error : flipErrors(step(3, 2, 1), Image(3, 2), pixelsPerDegree)) {
      EXPECT_GE(error, 0.0f);
      EXPECT_LE(error, 1.0f);
    }
  }
}

TEST(ErrorColour, IsAsLightAsTheErrorIsLarge) {
  for (int i = 0; i <= 255; ++i) {
    const vec3 colour = errorColour(float(i) / 255.0f);
    EXPECT_NEAR(labFromLinear(colour).x, 97.0f * float(i) / 255.0f, 0.05f) << i;
  }
  expectNear(errorColour(-1.0f), vec3(0.0f), 1e-6f);
  expectNear(errorColour(2.0f), errorColour(1.0f), 0.0f);
  const std::vector<float> errors{0.0f, 1.0f};
  expectNear(errorPicture(2, 1, errors).at(1, 0), errorColour(1.0f), 0.0f);
}

}  // namespace
}  // namespace isophote

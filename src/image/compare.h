// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/flip.h"
#include "image/image.h"
#include "image/tonemap.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// How pictures are judged.
struct CompareOptions {
  DisplayOptions display{};  ///< How they are shown. With autoExposure both get the exposure of the second.
  float pixelsPerDegree = kDefaultPixelsPerDegree;  ///< For flip; 1 to 1000.
};

/// How close a picture `a` is to a reference `b`. psnr, ssim and flip judge the pictures as shown
/// (displayed(), by default exposure 0, no tone map, clamped, sRGB); relMse and meanRatio the linear values.
struct Comparison {
  /// 10 log10(1 / mean squared difference over R, G, B) [dB]; infinity where the shown pictures are equal.
  double psnr = 0.0;
  /// Mean structural similarity of luma (Wang et al. 2004): Gaussian window of 11 x 11 with sigma 1.5, K1 =
  /// 0.01, K2 = 0.03, windows inside the picture only. A smaller picture takes the largest odd window that
  /// fits.
  double ssim = 0.0;
  /// Mean of flipErrors().
  double flip = 0.0;
  /// Mean of (a - b)^2 / (b^2 + 0.01) over the channels of all pixels that are finite in both.
  double relMse = 0.0;
  /// Sum of a over sum of b, over the channels of all pixels that are finite in both; 1 where both sums are
  /// 0.
  double meanRatio = 1.0;
  /// Pixels with a channel that is NaN or infinite. They are shown as black or white, and left out of linear
  /// measures.
  std::size_t nonFiniteA = 0;
  std::size_t nonFiniteB = 0;
  /// flipErrors(): one for each pixel.
  std::vector<float> flipErrors;
};

/// Comparison::psnr of pictures as shown, of the same size.
double psnrOf(const Image& shownA, const Image& shownB);

/// Throws Error(kBadInput) where the sizes differ or there are no pixels.
Comparison compareImages(const Image& a, const Image& b, const CompareOptions& options = {});

/// Keys psnr, ssim, relMse, flip, meanRatio, nonFiniteA, nonFiniteB; a number that is not finite, such as the
/// psnr of equal pictures, is null.
std::string toJson(const Comparison& comparison);

/// The layer of that name, or the picture itself for "". Throws Error(kBadInput) that names `subject` (the
/// film's file) and lists what there is.
const Image& selectLayer(const Film& film, std::string_view name, std::string_view subject);

}  // namespace isophote

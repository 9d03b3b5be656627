// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/suite.h"
#include "image/compare.h"
#include "image/error_colour.h"
#include "image/png.h"

#include <algorithm>

namespace isophote::bench {
namespace {

struct Window {
  int x = 0, y = 0, width = 0, height = 0;
};

Image cut(const Image& image, const Window& window) {
  Image part(window.width, window.height);
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x) part.at(x, y) = image.at(window.x + x, window.y + y);
  return part;
}

/// The window of a fifth of the picture's sides where the errors are greatest together, of those on a grid of
/// half its size.
Window worstWindow(int width, int height, const std::vector<float>& errors) {
  Window worst{0, 0, std::max(width / 5, std::min(width, 8)), std::max(height / 5, std::min(height, 8))};
  Window window = worst;
  double most = -1;
  for (window.y = 0; window.y + window.height <= height; window.y += std::max(window.height / 2, 1))
    for (window.x = 0; window.x + window.width <= width; window.x += std::max(window.width / 2, 1)) {
      double sum = 0;
      for (int y = window.y; y < window.y + window.height; ++y)
        for (int x = window.x; x < window.x + window.width; ++x)
          sum += double(errors[std::size_t(y) * std::size_t(width) + std::size_t(x)]);
      if (sum <= most) continue;
      most = sum;
      worst = window;
    }
  return worst;
}

/// Half as wide and high, as often as a page needs.
Image reduced(const Image& image) {
  constexpr int kWidest = 1000;
  if (image.width <= kWidest) return image;
  Image half(image.width / 2, std::max(image.height / 2, 1));
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x) {
      const int below = std::min(2 * y + 1, image.height - 1);
      half.at(x, y) = 0.25f * (image.at(2 * x, 2 * y) + image.at(2 * x + 1, 2 * y) + image.at(2 * x, below) +
                               image.at(2 * x + 1, below));
    }
  return reduced(half);
}

}  // namespace

ShownPicture shownPicture(const std::string& name, const Image& full, const DisplayOptions& display) {
  const Image picture = reduced(full);
  return {name, picture.width, picture.height,
          encodePng(picture.width, picture.height, displayedBytes(picture, display))};
}

JudgedPicture judgedPicture(const std::string& name, const Image& picture, const Image& reference,
                            const DisplayOptions& display) {
  const Comparison comparison = compareImages(picture, reference, {.display = display});
  const Image errors = errorPicture(picture.width, picture.height, comparison.flipErrors);
  const Window window = worstWindow(picture.width, picture.height, comparison.flipErrors);
  return {.picture = shownPicture(name, picture, display),
          .psnr = comparison.psnr,
          .flip = comparison.flip,
          .meanRatio = comparison.meanRatio,
          .error = shownPicture("error", errors),
          .zoom = {shownPicture("reference", cut(reference, window), display),
                   shownPicture(name, cut(picture, window), display),
                   shownPicture("error", cut(errors, window))}};
}

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/compare.h"

#include "base/error.h"
#include "settings/suggest.h"

#include <tbb/parallel_for.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace isophote {

namespace {

constexpr int kWindow = 11;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;
/// Keeps the relative error of dark pixels bounded.
constexpr double kRelativeFloor = 0.01;

bool isFinite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Weighted means within a window of the two pictures, their squares and their product.
struct Moments {
  double a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;

  void add(double weight, const Moments& m) {
    a += weight * m.a;
    b += weight * m.b;
    aa += weight * m.aa;
    bb += weight * m.bb;
    ab += weight * m.ab;
  }
};

double similarity(const Moments& m) {
  const double varianceA = m.aa - m.a * m.a, varianceB = m.bb - m.b * m.b, covariance = m.ab - m.a * m.b;
  return ((2.0 * m.a * m.b + kC1) * (2.0 * covariance + kC2)) /
         ((m.a * m.a + m.b * m.b + kC1) * (varianceA + varianceB + kC2));
}

std::vector<double> gaussian(int size) {
  std::vector<double> weights(std::size_t(size), 0.0);
  const int middle = (size - 1) / 2;
  for (int i = 0; i < size; ++i) {
    const double x = i - middle;
    weights[std::size_t(i)] = std::exp(-x * x / (2.0 * kSigma * kSigma));
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Sum of the similarity over the row of windows whose top is at y: the window's Gaussian is applied down the
/// columns, then along the row.
double similarityOfRow(const Image& a, const Image& b, int y, const std::vector<double>& weights) {
  const int size = int(weights.size());
  std::vector<Moments> columns(std::size_t(a.width));
  for (int dy = 0; dy < size; ++dy) {
    for (int x = 0; x < a.width; ++x) {
      const double lumaA = luminanceOf(a.at(x, y + dy)), lumaB = luminanceOf(b.at(x, y + dy));
      columns[std::size_t(x)].add(weights[std::size_t(dy)],
                                  {lumaA, lumaB, lumaA * lumaA, lumaB * lumaB, lumaA * lumaB});
    }
  }
  double sum = 0.0;
  for (int x = 0; x + size <= a.width; ++x) {
    Moments window;
    for (int dx = 0; dx < size; ++dx) window.add(weights[std::size_t(dx)], columns[std::size_t(x + dx)]);
    sum += similarity(window);
  }
  return sum;
}

double ssimOf(const Image& a, const Image& b) {
  const int smallest = std::min({kWindow, a.width, a.height});
  const int size = smallest % 2 == 1 ? smallest : smallest - 1;
  const std::vector<double> weights = gaussian(size);
  std::vector<double> rows(std::size_t(a.height - size + 1));
  tbb::parallel_for(0, int(rows.size()),
                    [&](int y) { rows[std::size_t(y)] = similarityOfRow(a, b, y, weights); });
  const double sum = std::accumulate(rows.begin(), rows.end(), 0.0);
  return sum / (double(rows.size()) * double(a.width - size + 1));
}

void compareLinear(const Image& a, const Image& b, Comparison& result) {
  double sumA = 0.0, sumB = 0.0, relative = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const bool finiteA = isFinite(a.pixels[i]), finiteB = isFinite(b.pixels[i]);
    result.nonFiniteA += !finiteA;
    result.nonFiniteB += !finiteB;
    if (!finiteA || !finiteB) continue;
    ++count;
    for (int c = 0; c < 3; ++c) {
      const double valueA = double(a.pixels[i][c]), valueB = double(b.pixels[i][c]),
                   difference = valueA - valueB;
      sumA += valueA;
      sumB += valueB;
      relative += difference * difference / (valueB * valueB + kRelativeFloor);
    }
  }
  result.relMse = count == 0 ? 0.0 : relative / (3.0 * double(count));
  result.meanRatio = sumA == 0.0 && sumB == 0.0 ? 1.0 : sumA / sumB;
}

}  // namespace

double psnrOf(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double difference = double(a.pixels[i][c]) - double(b.pixels[i][c]);
      sum += difference * difference;
    }
  }
  return -10.0 * std::log10(sum / (3.0 * double(a.pixels.size())));
}

Comparison compareImages(const Image& a, const Image& b, const CompareOptions& options) {
  if (a.width != b.width || a.height != b.height) {
    failInput("", "pictures of {} x {} and {} x {} pixels cannot be compared; render both at one size",
              a.width, a.height, b.width, b.height);
  }
  if (a.pixels.empty()) failInput("", "pictures without pixels cannot be compared");
  Comparison result;
  compareLinear(a, b, result);
  DisplayOptions display = options.display;
  if (display.autoExposure) display.exposureEv += autoExposureEv(b);
  display.autoExposure = false;
  const Image shownA = displayed(a, display), shownB = displayed(b, display);
  result.psnr = psnrOf(shownA, shownB);
  result.ssim = ssimOf(shownA, shownB);
  result.flipErrors = flipErrors(shownA, shownB, options.pixelsPerDegree);
  const double sum = std::accumulate(result.flipErrors.begin(), result.flipErrors.end(), 0.0);
  result.flip = sum / double(result.flipErrors.size());
  return result;
}

std::string toJson(const Comparison& comparison) {
  // The library writes numbers that are not finite as null.
  nlohmann::ordered_json json;
  json["psnr"] = comparison.psnr;
  json["ssim"] = comparison.ssim;
  json["relMse"] = comparison.relMse;
  json["flip"] = comparison.flip;
  json["meanRatio"] = comparison.meanRatio;
  json["nonFiniteA"] = comparison.nonFiniteA;
  json["nonFiniteB"] = comparison.nonFiniteB;
  return json.dump(2);
}

const Image& selectLayer(const Film& film, std::string_view name, std::string_view subject) {
  if (name.empty()) return film.colour;
  const auto found = film.layers.find(std::string(name));
  if (found != film.layers.end()) return found->second;
  if (film.layers.empty()) failInput(subject, "has no layer \"{}\"; it holds the picture alone", name);
  std::vector<std::string_view> names;
  for (const auto& [layer, image] : film.layers) names.push_back(layer);
  failInput(subject, "has no layer \"{}\"{}; its layers are {}", name, suggestion(name, names),
            fmt::join(names, ", "));
}

}  // namespace isophote

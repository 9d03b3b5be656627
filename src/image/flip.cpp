// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/flip.h"

#include "image/lab.h"
#include "image/tonemap.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>

namespace isophote {

namespace {

constexpr double kPiSquared = 9.869604401089358;

/// A contrast sensitivity function as the sum of Gaussians of the frequency f [cycles a degree]: each is
/// height exp(-width f^2).
struct Sensitivity {
  struct Term {
    double height, width;
  };
  std::array<Term, 2> terms;
};

// Achromatic, red-green and blue-yellow, for Yy, Cx and Cz. A height of 0 means that there is one term.
constexpr std::array<Sensitivity, 3> kSensitivities{
    {{{{{1.0, 0.0047}, {0.0, 1e-5}}}}, {{{{1.0, 0.0053}, {0.0, 1e-5}}}}, {{{{34.1, 0.04}, {13.5, 0.025}}}}}};
constexpr double kWidestTerm = 0.04;

// Colour differences to this power; the largest possible one, and what part of it is most of the scale.
constexpr float kColourPower = 0.7f;
constexpr float kKnee = 0.4f;
constexpr float kErrorAtKnee = 0.95f;
/// Width of the detectors of edges and points [degrees], twice their standard deviation.
constexpr double kFeatureDegrees = 0.082;

/// One channel of a picture.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  Plane(int w, int h) : width(w), height(h), values(std::size_t(w) * std::size_t(h), 0.0f) {}
  std::span<float> row(int y) { return {&values[std::size_t(y) * std::size_t(width)], std::size_t(width)}; }
  std::span<const float> row(int y) const {
    return {&values[std::size_t(y) * std::size_t(width)], std::size_t(width)};
  }
};

/// Weights of the pixels -radius ... radius.
struct Kernel {
  std::vector<float> weights;
  /// They sum to 0. Then they weigh how far pixels are from the middle one, so that where a picture is
  /// constant the result is 0 exactly: the root in featureError() would make much of a little.
  bool isDerivative = false;

  std::size_t radius() const { return weights.size() / 2; }
};

Plane alongRows(const Plane& plane, const Kernel& kernel) {
  const std::size_t radius = kernel.radius();
  Plane result(plane.width, plane.height);
  tbb::parallel_for(0, plane.height, [&](int y) {
    const std::span<const float> from = plane.row(y);
    std::vector<float> padded(from.size() + 2 * radius);
    std::fill_n(padded.begin(), radius, from.front());
    std::copy(from.begin(), from.end(), padded.begin() + std::ptrdiff_t(radius));
    std::fill_n(padded.rbegin(), radius, from.back());
    const std::span<float> to = result.row(y);
    const float base = kernel.isDerivative ? 1.0f : 0.0f;
    for (std::size_t k = 0; k < kernel.weights.size(); ++k)
      for (std::size_t x = 0; x < to.size(); ++x)
        to[x] += kernel.weights[k] * (padded[x + k] - base * from[x]);
  });
  return result;
}

Plane alongColumns(const Plane& plane, const Kernel& kernel) {
  const int radius = int(kernel.radius());
  Plane result(plane.width, plane.height);
  tbb::parallel_for(0, plane.height, [&](int y) {
    const std::span<const float> middle = plane.row(y);
    const std::span<float> to = result.row(y);
    const float base = kernel.isDerivative ? 1.0f : 0.0f;
    for (int k = -radius; k <= radius; ++k) {
      const float weight = kernel.weights[std::size_t(k + radius)];
      const std::span<const float> from = plane.row(std::clamp(y + k, 0, plane.height - 1));
      for (std::size_t x = 0; x < to.size(); ++x) to[x] += weight * (from[x] - base * middle[x]);
    }
  });
  return result;
}

/// height exp(-pi^2 (x / pixelsPerDegree)^2 / width) is the transform of the sensitivity's term.
std::vector<double> spatialTerm(double width, double pixelsPerDegree) {
  const int radius = int(std::ceil(3.0 * std::sqrt(kWidestTerm / (2.0 * kPiSquared)) * pixelsPerDegree));
  std::vector<double> values;
  for (int i = -radius; i <= radius; ++i) {
    const double degrees = i / pixelsPerDegree;
    values.push_back(std::exp(-kPiSquared * degrees * degrees / width));
  }
  return values;
}

/// The channel as the eye resolves it. The filter over a square is a sum of terms that are each a product of
/// a row and a column, scaled such that all weights sum to 1.
Plane filtered(const Plane& plane, const Sensitivity& sensitivity, double pixelsPerDegree) {
  struct Part {
    double weight;
    Kernel kernel;
  };
  std::vector<Part> parts;
  double total = 0.0;
  for (const auto [height, width] : sensitivity.terms) {
    if (height == 0.0) continue;
    const std::vector<double> values = spatialTerm(width, pixelsPerDegree);
    double sum = 0.0;
    for (const double value : values) sum += value;
    Part& part = parts.emplace_back(Part{height * std::sqrt(1.0 / width) * sum * sum, {}});
    for (const double value : values) part.kernel.weights.push_back(float(value / sum));
    total += part.weight;
  }
  Plane result(plane.width, plane.height);
  for (const Part& part : parts) {
    const Plane term = alongColumns(alongRows(plane, part.kernel), part.kernel);
    const float share = float(part.weight / total);
    for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] += share * term.values[i];
  }
  return result;
}

std::array<Plane, 3> ycxczPlanes(const Image& shown) {
  const Plane empty(shown.width, shown.height);
  std::array<Plane, 3> planes{empty, empty, empty};
  tbb::parallel_for(0, shown.height, [&](int y) {
    for (int x = 0; x < shown.width; ++x) {
      const vec3 pixel = shown.at(x, y);
      const vec3 c =
          ycxczFromLinear(vec3(linearFromSrgb(pixel.x), linearFromSrgb(pixel.y), linearFromSrgb(pixel.z)));
      for (int k = 0; k < 3; ++k) planes[std::size_t(k)].row(y)[std::size_t(x)] = c[k];
    }
  });
  return planes;
}

/// L*a*b* with the chroma scaled by lightness: colours are more vivid where there is more light (Hunt
/// effect).
vec3 huntLab(vec3 linear) {
  const vec3 lab = labFromLinear(linear);
  return vec3(lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z);
}

/// Distance for large differences: lightness apart from colour.
float hyab(vec3 a, vec3 b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

/// The largest distance that a screen can show: from green to blue.
float largestColourDifference() {
  static const float kLargest = std::pow(hyab(huntLab({0, 1, 0}), huntLab({0, 0, 1})), kColourPower);
  return kLargest;
}

/// The difference as [0, 1], most of it for what is below the knee: larger ones all look large.
float colourError(vec3 labA, vec3 labB) {
  const float difference = std::pow(hyab(labA, labB), kColourPower);
  const float largest = largestColourDifference(), knee = kKnee * largest;
  if (difference < knee) return difference * (kErrorAtKnee / knee);
  return std::min(kErrorAtKnee + (difference - knee) / (largest - knee) * (1.0f - kErrorAtKnee), 1.0f);
}

/// A Gaussian and its two derivatives along one axis. The Gaussian's weights sum to 1; of the derivatives',
/// those above 0 sum to 1 and those below to -1.
struct FeatureKernels {
  Kernel gaussian, edge, point;
};

FeatureKernels featureKernels(double pixelsPerDegree) {
  const double sigma = 0.5 * kFeatureDegrees * pixelsPerDegree;
  const int radius = int(std::ceil(3.0 * sigma));
  std::array<std::vector<double>, 3> values;
  std::array<double, 3> above{}, below{};
  for (int x = -radius; x <= radius; ++x) {
    const double g = std::exp(-x * x / (2.0 * sigma * sigma));
    const std::array<double, 3> at{g, -x * g, (x * x / (sigma * sigma) - 1.0) * g};
    for (std::size_t i = 0; i < at.size(); ++i) {
      values[i].push_back(at[i]);
      (at[i] > 0.0 ? above : below)[i] += std::abs(at[i]);
    }
  }
  std::array<Kernel, 3> kernels;
  kernels[1].isDerivative = kernels[2].isDerivative = true;
  for (std::size_t i = 0; i < kernels.size(); ++i)
    for (const double value : values[i])
      kernels[i].weights.push_back(float(value / (value > 0.0 ? above[i] : below[i])));
  return {kernels[0], kernels[1], kernels[2]};
}

/// Strength of edges and of points (and thin lines) at each pixel.
struct Features {
  Plane edges, points;
};

Plane lengths(Plane a, const Plane& b) {
  for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] = std::hypot(a.values[i], b.values[i]);
  return a;
}

Features findFeatures(Plane luma, const FeatureKernels& kernels) {
  for (float& value : luma.values) value = (value + 16.0f) / 116.0f;  // Yy as [0, 1]
  const Plane blurred = alongRows(luma, kernels.gaussian);
  return {lengths(alongColumns(alongRows(luma, kernels.edge), kernels.gaussian),
                  alongColumns(blurred, kernels.edge)),
          lengths(alongColumns(alongRows(luma, kernels.point), kernels.gaussian),
                  alongColumns(blurred, kernels.point))};
}

/// What of a picture is compared.
struct Seen {
  std::array<Plane, 3> filtered;
  Features features;

  vec3 lab(std::size_t i) const {
    const vec3 ycxcz(filtered[0].values[i], filtered[1].values[i], filtered[2].values[i]);
    return huntLab(clamp(linearFromYcxcz(ycxcz), 0.0f, 1.0f));
  }
};

Seen see(const Image& shown, double pixelsPerDegree) {
  const std::array<Plane, 3> planes = ycxczPlanes(shown);
  return {{filtered(planes[0], kSensitivities[0], pixelsPerDegree),
           filtered(planes[1], kSensitivities[1], pixelsPerDegree),
           filtered(planes[2], kSensitivities[2], pixelsPerDegree)},
          findFeatures(planes[0], featureKernels(pixelsPerDegree))};
}

float featureError(const Features& a, const Features& b, std::size_t i) {
  const float edges = std::abs(a.edges.values[i] - b.edges.values[i]);
  const float points = std::abs(a.points.values[i] - b.points.values[i]);
  return std::sqrt(std::max(edges, points) * std::sqrt(0.5f));
}

}  // namespace

std::vector<float> flipErrors(const Image& shownA, const Image& shownB, float pixelsPerDegree) {
  assert(shownA.width == shownB.width && shownA.height == shownB.height && !shownA.pixels.empty());
  const Seen a = see(shownA, pixelsPerDegree), b = see(shownB, pixelsPerDegree);
  std::vector<float> errors(shownA.pixels.size());
  tbb::parallel_for(0, shownA.height, [&](int y) {
    const std::size_t begin = std::size_t(y) * std::size_t(shownA.width);
    for (std::size_t i = begin; i < begin + std::size_t(shownA.width); ++i)
      errors[i] = std::pow(colourError(a.lab(i), b.lab(i)),
                           1.0f - std::min(featureError(a.features, b.features, i), 1.0f));
  });
  return errors;
}

}  // namespace isophote

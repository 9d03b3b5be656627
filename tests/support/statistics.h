// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Tests of random samples whose tolerances are computed: chi-square against a density, z-tests of means.
// A test that compares `tests` such numbers says so, so that the whole raises a false alarm as rarely as one
// does (Sidak). Seeds are fixed: what passes once passes always.
#pragma once

#include "math/rng.shared.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <vector>

namespace isophote {

/// Chance of a false alarm of one test of the suite.
inline constexpr double kFalseAlarm = 1e-3;

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kUnderSanitizers = true;
#else
inline constexpr bool kUnderSanitizers = false;
#endif

/// Sample counts of the tests: fewer where the sanitizers make each ten times as slow.
constexpr std::uint32_t testSamples(std::uint32_t n) { return kUnderSanitizers ? n / 10 : n; }

/// Chance of a false alarm that each of `tests` comparisons may have so that all have kFalseAlarm (Sidak).
inline double significance(int tests) { return -std::expm1(std::log1p(-kFalseAlarm) / tests); }

/// Regularised upper incomplete gamma function Q(a, x), a > 0: its series below a + 1, above it its continued
/// fraction (evaluated by Lentz's method).
inline double upperGamma(double a, double x) {
  if (x <= 0) return 1;
  const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; term > sum * 1e-15; ++n) sum += term *= x / n;
    return 1 - scale * sum;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, fraction = d;
  for (int i = 1; i < 100000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    fraction *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return scale * fraction;
}

/// Chance that a sum of squared deviations is at least this large where nothing is wrong.
inline double chiSquarePValue(double statistic, int degreesOfFreedom) {
  return upperGamma(0.5 * degreesOfFreedom, 0.5 * statistic);
}

/// How many standard deviations a normal variable exceeds, up or down, with that chance.
inline double zScore(double chance) {
  double low = 0, high = 40;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::sqrt(2.0)) > chance ? low : high) = middle;
  }
  return high;
}

/// Chi-square test of counts against expected ones; cells that expect few are pooled, the rarest first.
inline testing::AssertionResult countsMatch(const std::vector<double>& observed,
                                            const std::vector<double>& expected, int tests = 1) {
  std::vector<std::size_t> order(observed.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return expected[a] < expected[b]; });
  constexpr double kFewest = 8;
  double statistic = 0, pooledObserved = 0, pooledExpected = 0;
  int cells = 0;
  const auto close = [&] {
    const double deviation = pooledObserved - pooledExpected;
    statistic += deviation * deviation / std::max(pooledExpected, 1e-9);
    pooledObserved = pooledExpected = 0;
    ++cells;
  };
  for (const std::size_t i : order) {
    pooledObserved += observed[i];
    pooledExpected += expected[i];
    if (pooledExpected >= kFewest) close();
  }
  // What never reached the least number: samples where next to none may be.
  if (pooledObserved > 0 || pooledExpected > 1) close();
  const double p = cells > 1 ? chiSquarePValue(statistic, cells - 1) : 1;
  if (p >= significance(tests)) return testing::AssertionSuccess();
  return testing::AssertionFailure() << fmt::format(
             "chi-square {:.1f} over {} cells: p = {:.3g} is below {:.3g}", statistic, cells, p,
             significance(tests));
}

/// Sum, mean and spread of numbers.
class Moments {
 public:
  void add(double x) {
    ++count_;
    const double delta = x - mean_;
    mean_ += delta / double(count_);
    squares_ += delta * (x - mean_);
  }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1 ? squares_ / double(count_ - 1) : 0; }
  /// Standard deviation of the mean.
  double error() const { return std::sqrt(variance() / double(std::max<std::uint64_t>(count_, 1))); }

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0;
  double squares_ = 0;
};

/// z-test of a mean against a known one. `rounding`: relative error of the numbers themselves.
inline testing::AssertionResult hasMean(const Moments& m, double expected, int tests = 1,
                                        double rounding = 1e-5) {
  const double tolerance = zScore(significance(tests)) * m.error() + rounding * std::abs(expected);
  if (std::abs(m.mean() - expected) <= tolerance) return testing::AssertionSuccess();
  return testing::AssertionFailure() << fmt::format("the mean {:.6g} differs from {:.6g} by more than {:.2g}",
                                                    m.mean(), expected, tolerance);
}

/// z-test of two means estimated apart.
inline testing::AssertionResult sameMean(const Moments& a, const Moments& b, int tests = 1,
                                         double rounding = 1e-5) {
  const double tolerance =
      zScore(significance(tests)) * std::hypot(a.error(), b.error()) + rounding * std::abs(b.mean());
  if (std::abs(a.mean() - b.mean()) <= tolerance) return testing::AssertionSuccess();
  return testing::AssertionFailure() << fmt::format("the means {:.6g} and {:.6g} differ by more than {:.2g}",
                                                    a.mean(), b.mean(), tolerance);
}

/// What samples lie on, as the unit square under an area-preserving map.
struct SampleDomain {
  vec3 (*fromSquare)(double u, double v);
  void (*toSquare)(vec3 p, double& u, double& v);
  double measure;  ///< Area, or solid angle.
};

namespace detail {
inline double turnsOf(vec3 p) {
  const double turns = std::atan2(double(p.y), double(p.x)) / (2 * M_PI);
  return turns < 0 ? turns + 1 : turns;
}
inline vec3 onSphere(double z, double turns) {
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return vec3(r * std::cos(2 * M_PI * turns), r * std::sin(2 * M_PI * turns), z);
}
}  // namespace detail

/// [0, 1)^2 in x and y.
inline const SampleDomain kSquareDomain{
    [](double u, double v) { return vec3(u, v, 0); },
    [](vec3 p, double& u, double& v) { u = double(p.x), v = double(p.y); }, 1};
/// The unit disc in x and y.
inline const SampleDomain kDiscDomain{
    [](double u, double v) {
      return vec3(std::sqrt(u) * std::cos(2 * M_PI * v), std::sqrt(u) * std::sin(2 * M_PI * v), 0);
    },
    [](vec3 p, double& u, double& v) { u = double(dot(p, p)), v = detail::turnsOf(p); }, M_PI};
inline const SampleDomain kSphereDomain{
    [](double u, double v) { return detail::onSphere(1 - 2 * u, v); },
    [](vec3 p, double& u, double& v) { u = 0.5 - 0.5 * double(p.z), v = detail::turnsOf(p); }, 4 * M_PI};
/// Directions of the unit sphere with z >= 0.
inline const SampleDomain kHemisphereDomain{
    [](double u, double v) { return detail::onSphere(1 - u, v); },
    [](vec3 p, double& u, double& v) { u = 1 - double(p.z), v = detail::turnsOf(p); }, 2 * M_PI};

namespace detail {

/// Integral of f over a rectangle of the square: 9 points a cell, halved where halving changes the value.
template <class F>
double integrate(const F& f, double u, double v, double width, double height, int leastDepth, int mostDepth) {
  const auto gauss = [&](double u0, double v0, double w, double h) {
    constexpr double kAt[] = {0.1127016653792583, 0.5, 0.8872983346207417};
    constexpr double kWeight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum += kWeight[i] * kWeight[j] * f(u0 + w * kAt[i], v0 + h * kAt[j]);
    return sum * w * h;
  };
  const double w = 0.5 * width, h = 0.5 * height;
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += gauss(u + w * (i & 1), v + h * (i >> 1), w, h);
  if (leastDepth <= 0 && (mostDepth <= 0 || std::abs(sum - gauss(u, v, width, height)) < 1e-7)) return sum;
  sum = 0;
  for (int i = 0; i < 4; ++i)
    sum += integrate(f, u + w * (i & 1), v + h * (i >> 1), w, h, leastDepth - 1, mostDepth - 1);
  return sum;
}

}  // namespace detail

/// Integral of a function over a domain.
template <std::invocable<vec3> F>
double integrateOver(const SampleDomain& domain, F&& f) {
  const auto g = [&](double u, double v) { return double(f(domain.fromSquare(u, v))); };
  return domain.measure * detail::integrate(g, 0, 0, 1, 1, 4, 11);
}

struct SampleTest {
  std::uint32_t samples = testSamples(200'000);
  int tests = 1;  ///< Of how many comparisons this is one.
  int depth = 1;  ///< Halvings of a cell that the density's integral starts with: more for one with corners.
};

/// The samples follow the density: chi-square over 16 x 32 cells of equal measure. `sample(i)` is the i-th
/// sample, or nothing where the sampler gave up; as many are expected to be nothing as the density's integral
/// falls short of 1.
template <class Sample, class Pdf>
testing::AssertionResult samplesFollow(const SampleDomain& domain, Sample&& sample, Pdf&& pdf,
                                       const SampleTest& test = {}) {
  constexpr int kRows = 16, kColumns = 32, kCells = kRows * kColumns;
  std::vector<double> observed(kCells + 1), expected(kCells + 1);
  for (std::uint32_t i = 0; i < test.samples; ++i) {
    const std::optional<vec3> p = sample(i);
    if (!p) {
      ++observed[kCells];
      continue;
    }
    double u = 0, v = 0;
    domain.toSquare(*p, u, v);
    if (!(u >= -1e-6 && u <= 1 + 1e-6 && v >= -1e-6 && v <= 1 + 1e-6))
      return testing::AssertionFailure()
             << fmt::format("sample {} = ({}, {}, {}) lies outside of the domain", i, p->x, p->y, p->z);
    const int row = std::clamp(int(u * kRows), 0, kRows - 1);
    const int column = std::clamp(int(v * kColumns), 0, kColumns - 1);
    ++observed[std::size_t(row * kColumns + column)];
  }
  double found = 0;
  const auto density = [&](double u, double v) { return double(pdf(domain.fromSquare(u, v))); };
  for (int cell = 0; cell < kCells; ++cell) {
    const double u = double(cell / kColumns) / kRows, v = double(cell % kColumns) / kColumns;
    const double part = domain.measure * detail::integrate(density, u, v, 1.0 / kRows, 1.0 / kColumns,
                                                           test.depth, test.depth + 6);
    found += part;
    expected[std::size_t(cell)] = part * test.samples;
  }
  if (found > 1.001)
    return testing::AssertionFailure() << fmt::format("the density integrates to {:.6g}", found);
  expected[kCells] = std::max(1 - found, 0.0) * test.samples;
  return countsMatch(observed, expected, test.tests);
}

/// Independent random numbers for tests: the i-th triple of a stream.
inline vec3 randomTriple(std::uint32_t stream, std::uint32_t i) { return random3(0x5eed, stream, i); }

}  // namespace isophote

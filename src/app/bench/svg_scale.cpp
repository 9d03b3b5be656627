// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/svg_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isophote::bench {
namespace {

/// 1, 2 or 5 times a power of ten, about a sixth of the range.
double roundStep(double range) {
  const double rough = range / 6;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= rough) return factor * decade;
  return 10 * decade;
}

/// "0.5", "2,000" would be wide: "2k", "1.5M".
std::string labelOf(double value) {
  const double size = std::abs(value);
  if (size >= 1e6) return fmt::format("{:g}M", value / 1e6);
  if (size >= 1e4) return fmt::format("{:g}k", value / 1e3);
  return fmt::format("{:g}", size < 1e-12 ? 0.0 : value);
}

}  // namespace

Scale::Scale(std::span<const double> values, bool logarithmic, bool fromZero) : logarithmic_(logarithmic) {
  bool any = false;
  for (const double value : values) {
    if (!holds(value)) continue;
    low_ = any ? std::min(low_, value) : value;
    high_ = any ? std::max(high_, value) : value;
    any = true;
  }
  if (!any) {
    low_ = logarithmic_ ? 0.1 : 0;
    high_ = 1;
  }
  if (logarithmic_) {
    // A little room on both sides.
    low_ /= 1.15;
    high_ *= 1.15;
    return;
  }
  if (fromZero) low_ = std::min(low_, 0.0);
  if (high_ <= low_) high_ = low_ + std::max(1.0, std::abs(low_));
  step_ = roundStep(high_ - low_);
  low_ = std::floor(low_ / step_ + 1e-9) * step_;
  high_ = std::ceil(high_ / step_ - 1e-9) * step_;
}

bool Scale::holds(double value) const { return std::isfinite(value) && (!logarithmic_ || value > 0); }

double Scale::place(double value) const {
  if (logarithmic_) return std::log(value / low_) / std::log(high_ / low_);
  return (value - low_) / (high_ - low_);
}

std::vector<Tick> Scale::ticks() const { return logarithmic_ ? logarithmicTicks() : linearTicks(); }

std::vector<Tick> Scale::linearTicks() const {
  std::vector<Tick> ticks;
  const int count = int(std::round((high_ - low_) / step_));
  for (int i = 0; i <= count; ++i) {
    // Rounded to the step, so that 0.3 is not told as 0.30000000000000004.
    const double value = std::round((low_ + i * step_) / step_) * step_;
    ticks.push_back({value, labelOf(std::stod(fmt::format("{:.9g}", value)))});
  }
  return ticks;
}

std::vector<Tick> Scale::logarithmicTicks() const {
  const int first = int(std::floor(std::log10(low_))), last = int(std::ceil(std::log10(high_)));
  std::vector<Tick> ticks;
  for (int decade = first; decade <= last; ++decade)
    for (const double factor : {1.0, 2.0, 5.0}) {
      // Of many decades only their beginnings.
      if (factor > 1 && last - first > 4) continue;
      const double value = factor * std::pow(10.0, decade);
      if (value >= low_ && value <= high_) ticks.push_back({value, labelOf(value)});
    }
  return ticks;
}

}  // namespace isophote::bench

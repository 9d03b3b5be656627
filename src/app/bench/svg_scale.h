// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace isophote::bench {

struct Tick {
  double value = 0;
  std::string label;
};

/// An axis: from values to places in [0, 1], and round numbers along it.
class Scale {
 public:
  /// Holds all finite values; a logarithmic one those above 0. `fromZero`: a linear one begins at 0.
  Scale(std::span<const double> values, bool logarithmic, bool fromZero);

  double low() const { return low_; }
  double high() const { return high_; }
  double place(double value) const;
  /// Whether a value can be shown at all.
  bool holds(double value) const;
  std::vector<Tick> ticks() const;

 private:
  std::vector<Tick> linearTicks() const;
  std::vector<Tick> logarithmicTicks() const;

  bool logarithmic_;
  double low_ = 0, high_ = 1;
  double step_ = 1;  ///< Between ticks of a linear axis.
};

}  // namespace isophote::bench

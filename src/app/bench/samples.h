// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace isophote::bench {

/// Repeated measurements of one quantity. What is told of them is the median, and as spread the quartiles,
/// which one disturbed run does not move.
class Samples {
 public:
  void add(double value) { values_.push_back(value); }
  void clear() { values_.clear(); }
  std::size_t size() const { return values_.size(); }
  bool empty() const { return values_.empty(); }

  /// NaN where nothing was measured, as for the quartiles.
  double median() const { return quantile(0.5); }
  double low() const { return quantile(0.25); }
  double high() const { return quantile(0.75); }

 private:
  /// Between neighbours linear.
  double quantile(double part) const;

  std::vector<double> values_;
};

}  // namespace isophote::bench

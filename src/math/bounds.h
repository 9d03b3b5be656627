// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <limits>

namespace isophote {

/// Axis-aligned box; empty as constructed.
struct Bounds {
  vec3 lower{std::numeric_limits<float>::max()};
  vec3 upper{std::numeric_limits<float>::lowest()};

  bool empty() const { return lower.x > upper.x; }
  vec3 centre() const { return 0.5f * (lower + upper); }
  vec3 size() const { return upper - lower; }
  /// Radius of the sphere around centre() that holds the box.
  float radius() const { return 0.5f * length(size()); }
  void extend(vec3 p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  void extend(const Bounds& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
};

}  // namespace isophote

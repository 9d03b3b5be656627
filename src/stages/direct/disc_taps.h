// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace isophote::direct {

/// A place on the unit disc where a tap looks.
struct DiscTap {
  float x, y;
  float radius;
};

/// Taps along a spiral of golden angles (Vogel 1979), no two in line: evenly over the disc, or, for searches,
/// evenly in radius, so that what is near is found as well as what is far.
inline void spiralTaps(std::uint32_t count, bool evenInRadius, std::vector<DiscTap>& taps) {
  constexpr double kGoldenAngle = 2.399963229728653;
  taps.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double part = (double(i) + 0.5) / double(count);
    const double radius = evenInRadius ? part : std::sqrt(part);
    taps[i] = {float(radius * std::cos(kGoldenAngle * i)), float(radius * std::sin(kGoldenAngle * i)),
               float(radius)};
  }
}

}  // namespace isophote::direct

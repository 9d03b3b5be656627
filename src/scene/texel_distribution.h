// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/large_pages.h"
#include "math/shared.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace isophote {

/// Points of the unit square whose density is a picture, interpolated bilinearly: what is looked up between
/// the texels is sampled exactly. The picture repeats from left to right and ends at its top and bottom. A
/// point is continuous in the two random numbers but for the borders of texels, so that stratified numbers
/// give stratified points.
class TexelDistribution {
 public:
  struct Point {
    vec2 uv;
    float density;  ///< Per area of the unit square; 0 where all weights are.
  };

  TexelDistribution() = default;
  /// fillRow(y, weights) writes the weights, none negative, of a row; it is called for many rows at once.
  TexelDistribution(int width, int height, const std::function<void(int y, float* weights)>& fillRow);

  bool empty() const { return !(total_ > 0.0); }
  /// Sum of all weights.
  double total() const { return total_; }
  std::uint64_t bytes() const { return (rows_.size() + columns_.size()) * sizeof(float); }

  Point sample(vec2 u) const;
  /// sample()'s density at a point.
  float density(vec2 uv) const;

 private:
  float probability(int x, int y) const;

  int width_ = 0;
  int height_ = 0;
  double total_ = 0;
  std::vector<float> rows_;     ///< Part of the weight above each row, and 1.
  LargeVector<float> columns_;  ///< For each row: part of its weight left of each texel, and 1.
};

/// The texels between which a bilinear lookup at uv interpolates, left and right, above and below, and the
/// weights of those right and below: repeated from left to right, held at top and bottom.
struct MapTexels {
  int x[2];
  int y[2];
  vec2 weight;

  MapTexels(vec2 uv, int width, int height);
};

}  // namespace isophote

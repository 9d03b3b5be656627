// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/texel_distribution.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;

/// Turns weights into the parts of their sum that lie before each of them, and 1 behind the last. Returns the
/// sum; where it is 0 all parts are, so that nothing is ever chosen.
double accumulate(const float* weights, int count, float* parts) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += double(weights[i]);
  const double scale = sum > 0 ? 1.0 / sum : 0.0;
  double before = 0;
  for (int i = 0; i < count; ++i) {
    const double weight = double(weights[i]);
    parts[i] = float(before * scale);
    before += weight;
  }
  parts[count] = sum > 0 ? 1.0f : 0.0f;
  return sum;
}

struct Choice {
  int index;
  float rest;  ///< Where within its part u lies, in [0, 1).
};

Choice choose(const float* parts, int count, float u) {
  // The first part that ends behind u: parts of no width are never chosen.
  const float* const end = std::upper_bound(parts + 1, parts + count, u);
  const int index = int(end - parts) - 1;
  const float width = parts[index + 1] - parts[index];
  return {index, std::clamp((u - parts[index]) / std::max(width, 1e-38f), 0.0f, kBelowOne)};
}

/// A hat of width 2 around 0.
float sampleHat(float u) { return u < 0.5f ? std::sqrt(2.0f * u) - 1.0f : 1.0f - std::sqrt(2.0f - 2.0f * u); }

}  // namespace

MapTexels::MapTexels(vec2 uv, int width, int height) {
  const float across = uv.x * float(width) - 0.5f, down = uv.y * float(height) - 0.5f;
  const float left = std::floor(across), upper = std::floor(down);
  weight = vec2(across - left, down - upper);
  const int x0 = int(left) % width, y0 = int(upper);
  x[0] = x0 < 0 ? x0 + width : x0;
  x[1] = x[0] + 1 < width ? x[0] + 1 : 0;
  y[0] = std::clamp(y0, 0, height - 1);
  y[1] = std::clamp(y0 + 1, 0, height - 1);
}

TexelDistribution::TexelDistribution(int width, int height,
                                     const std::function<void(int y, float* weights)>& fillRow)
    : width_(width), height_(height), columns_(std::size_t(width + 1) * std::size_t(height)) {
  std::vector<double> sums(std::size_t(height), 0.0);
  tbb::parallel_for(0, height, [&](int y) {
    float* const parts = columns_.data() + std::size_t(y) * std::size_t(width + 1);
    std::vector<float> weights(std::size_t(width), 0.0f);
    fillRow(y, weights.data());
    sums[std::size_t(y)] = accumulate(weights.data(), width, parts);
  });
  for (const double sum : sums) total_ += sum;
  std::vector<float> rowWeights(sums.size(), 0.0f);
  // Relative to the total: sums of huge weights leave the range of floats.
  for (std::size_t y = 0; y < sums.size(); ++y) rowWeights[y] = total_ > 0 ? float(sums[y] / total_) : 0.0f;
  rows_.resize(std::size_t(height) + 1);
  accumulate(rowWeights.data(), height, rows_.data());
}

float TexelDistribution::probability(int x, int y) const {
  const float* const parts = columns_.data() + std::size_t(y) * std::size_t(width_ + 1);
  return (parts[x + 1] - parts[x]) * (rows_[std::size_t(y) + 1] - rows_[std::size_t(y)]);
}

float TexelDistribution::density(vec2 uv) const {
  if (empty()) return 0.0f;
  const MapTexels t(uv, width_, height_);
  const float upper = mix(probability(t.x[0], t.y[0]), probability(t.x[1], t.y[0]), t.weight.x);
  const float lower = mix(probability(t.x[0], t.y[1]), probability(t.x[1], t.y[1]), t.weight.x);
  return mix(upper, lower, t.weight.y) * float(width_) * float(height_);
}

TexelDistribution::Point TexelDistribution::sample(vec2 u) const {
  if (empty()) return {vec2(0.5f), 0.0f};
  const Choice row = choose(rows_.data(), height_, u.y);
  const Choice column =
      choose(columns_.data() + std::size_t(row.index) * std::size_t(width_ + 1), width_, u.x);
  const float x = float(column.index) + 0.5f + sampleHat(column.rest);
  // The hats of the first and last row are held at 1 towards the edge.
  float down = sampleHat(row.rest);
  if (row.index == 0 && row.rest < 0.5f) down = row.rest - 0.5f;
  if (row.index == height_ - 1 && row.rest >= 0.5f) down = row.rest - 0.5f;
  const float y = float(row.index) + 0.5f + down;
  float across = x / float(width_);
  across -= std::floor(across);
  const vec2 uv(std::min(across, kBelowOne), std::clamp(y / float(height_), 0.0f, kBelowOne));
  return {uv, density(uv)};
}

}  // namespace isophote

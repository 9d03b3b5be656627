// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// How automaticRadius() estimates: at a few hundred photons, spread evenly over the map, it finds the
// distance to the k-th nearest of an even subset of all photons, counting only those that lie near the
// photon's tangent plane and were received on the same side. With n photons, m of them in the subset, and
// photons spread evenly around a point, the squared distance to the k-th grows as k * n / m, so each gives a
// squared radius for `photonsPerEstimate`. The median is the answer: caustics and lone photons do not move
// it. Nor does a crevice, such as a lamp that also shines into the gap between it and the ceiling, although
// most photons may be caught there.
#include "math/sampling.shared.h"
#include "stages/photon_trace/photon_trace.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace isophote {

namespace {

constexpr std::size_t kQueries = 256;
constexpr std::size_t kSubset = 8192;
/// Fewest neighbours that a distance is taken to: below it single distances scatter too much.
constexpr std::size_t kFewestNeighbours = 6;
/// Cosine to the tangent plane's normal up to which a neighbour counts as lying in the plane.
constexpr float kTangentCosine = 0.5f;
/// How many times denser photons lie in a crevice than on the densest of all other surfaces.
constexpr float kCreviceDensity = 9.0f;

struct Neighbour {
  vec3 position;
  vec3 normal;
};

/// The i-th of `count` indices that are spread evenly over [0, size).
std::size_t evenIndex(std::size_t i, std::size_t count, std::size_t size) { return i * size / count; }

/// Squared distance to the k-th nearest of `subset`, itself not counted; infinity where there are fewer.
float kthDistance2(const std::vector<Neighbour>& subset, const Photon& at, std::size_t k,
                   std::vector<float>& nearest) {
  const vec3 normal = unpackDirection(at.normal);
  nearest.assign(k + 1, std::numeric_limits<float>::infinity());  // a max-heap
  std::size_t self = 0;
  for (const Neighbour& n : subset) {
    const vec3 d = n.position - at.position;
    const float distance2 = dot(d, d);
    if (distance2 >= nearest.front()) continue;
    const float along = dot(d, normal);
    if (along * along > kTangentCosine * kTangentCosine * distance2 || dot(n.normal, normal) <= 0.0f)
      continue;
    self += distance2 == 0.0f ? 1 : 0;
    std::pop_heap(nearest.begin(), nearest.end());
    nearest.back() = distance2;
    std::push_heap(nearest.begin(), nearest.end());
  }
  // The photon itself, where the subset holds it, takes one place of the k + 1.
  std::sort(nearest.begin(), nearest.end());
  return nearest[self > 0 ? k : k - 1];
}

/// For how many photons of one power each photon counts, judged by its noise: (sum p)^2 / (n sum p^2). 1
/// where all carry the same, as traced ones of one light do; those of a bounce map differ up to 5:1, which
/// makes it 0.86. Few strong ones among many do not show in the rest's noise: not below a quarter.
double effectivePart(const PhotonMap& map) {
  double sum = 0, squares = 0;
  for (const Photon& photon : map.photons) {
    const double power = double(meanOf(photon.power));
    sum += power;
    squares += power * power;
  }
  return squares > 0 ? std::clamp(sum * sum / (double(map.photons.size()) * squares), 0.25, 1.0) : 1.0;
}

/// The median, as of those beyond a crevice where there is one: densities on surfaces that light reaches
/// freely go over into each other, those in a crevice lie apart from nearly all others.
float typical(std::vector<float>& radius2) {
  std::sort(radius2.begin(), radius2.end());
  const std::size_t n = radius2.size();
  const std::size_t between = n / 16;  // at its rim
  const std::size_t last = n - n / 8;  // what lies beyond more is strays
  std::size_t first = 0;
  for (std::size_t i = between + 1; i < last; ++i)
    if (radius2[i] > kCreviceDensity * radius2[i - between - 1]) first = i;
  return radius2[first + (n - first) / 2];
}

}  // namespace

float automaticRadius(const PhotonMap& map, float photonsPerEstimate) {
  const std::size_t n = map.photons.size();
  if (n < 2 || !(photonsPerEstimate > 0.0f)) return 0.0f;
  const std::size_t subsetSize = std::min(n, kSubset);
  std::vector<Neighbour> subset(subsetSize);
  for (std::size_t i = 0; i < subsetSize; ++i) {
    const Photon& photon = map.photons[evenIndex(i, subsetSize, n)];
    subset[i] = {photon.position, unpackDirection(photon.normal)};
  }
  // The expected number of the subset's photons in the disc that is looked for.
  const double expected = double(photonsPerEstimate) / effectivePart(map) * double(subsetSize) / double(n);
  std::size_t k = std::clamp(std::size_t(std::lround(expected)), std::min(kFewestNeighbours, subsetSize - 1),
                             subsetSize - 1);

  const std::size_t queries = std::min(n, kQueries);
  std::vector<float> radius2;
  // Where no surface holds k photons, as in a map of very few, fewer must do.
  for (;; k /= 2) {
    if (k == 0) return 0.0f;
    radius2.assign(queries, 0.0f);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, queries, 16), [&](const auto& range) {
      std::vector<float> nearest;
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        radius2[i] = kthDistance2(subset, map.photons[evenIndex(i, queries, n)], k, nearest);
    });
    std::erase_if(radius2, [](float r2) { return !std::isfinite(r2); });
    if (!radius2.empty()) break;
  }
  return float(std::sqrt(double(typical(radius2)) * expected / double(k)));
}

}  // namespace isophote

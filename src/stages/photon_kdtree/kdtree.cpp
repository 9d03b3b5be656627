// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_kdtree/kdtree.h"

#include "base/stop_check.h"
#include "math/bounds.h"
#include "math/lanes.h"

#include <immintrin.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace isophote {
namespace {

constexpr std::uint32_t kLanes = 16;

/// The points of a range, and how many of them have been found.
struct Scan {
  const float *x, *y, *z;  ///< Of the first.
  std::uint32_t count, place;
  vec3 centre;
  float distance2;
};

SHARED_FN void scanBody(const Scan& scan, NeighbourKey* out, std::size_t& found) {
  for (std::uint32_t first = 0; first < scan.count; first += kLanes) {
    float d2[kLanes];
    std::uint32_t within = 0;
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const vec3 d = vec3(scan.x[first + i], scan.y[first + i], scan.z[first + i]) - scan.centre;
      d2[i] = dot(d, d);
      within |= detail::kBits[i] & (0u - std::uint32_t(d2[i] < scan.distance2));
    }
    if (scan.count - first < kLanes) within &= (1u << (scan.count - first)) - 1u;
    for (; within != 0; within &= within - 1) {
      const std::uint32_t i = std::uint32_t(std::countr_zero(within));
      out[found++] = std::uint64_t(std::bit_cast<std::uint32_t>(d2[i])) << 32 | (scan.place + first + i);
    }
  }
}

ISOPHOTE_SIMD(scanWith, scanBody, (const Scan& scan, NeighbourKey* out, std::size_t& found),
              (scan, out, found))

/// scanBody by hand: GCC finds neither masks nor compression in it.
__attribute__((target("avx512f"))) void scanAvx512(const Scan& scan, NeighbourKey* out, std::size_t& found) {
  const __m512 x = _mm512_set1_ps(scan.centre.x), y = _mm512_set1_ps(scan.centre.y),
               z = _mm512_set1_ps(scan.centre.z), limit = _mm512_set1_ps(scan.distance2);
  const __m512i ascending = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (std::uint32_t first = 0; first < scan.count; first += kLanes) {
    const __m512 dx = _mm512_loadu_ps(scan.x + first) - x;
    const __m512 dy = _mm512_loadu_ps(scan.y + first) - y;
    const __m512 dz = _mm512_loadu_ps(scan.z + first) - z;
    const __m512 d2 = dx * dx + dy * dy + dz * dz;
    std::uint32_t within = _mm512_cmp_ps_mask(d2, limit, _CMP_LT_OQ);
    if (scan.count - first < kLanes) within &= (1u << (scan.count - first)) - 1u;
    if (within == 0) continue;
    const __m512i place =
        _mm512_maskz_add_epi32(0xffff, ascending, _mm512_set1_epi32(int(scan.place + first)));
    const __m512i keptDistance = _mm512_maskz_compress_epi32(__mmask16(within), _mm512_castps_si512(d2));
    const __m512i keptPlace = _mm512_maskz_compress_epi32(__mmask16(within), place);
    // Key i: place i below distance i.
    const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const __m512i high = _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    _mm512_storeu_si512(out + found, _mm512_permutex2var_epi32(keptPlace, low, keptDistance));
    _mm512_storeu_si512(out + found + 8, _mm512_permutex2var_epi32(keptPlace, high, keptDistance));
    found += std::size_t(std::popcount(within));
  }
}

}  // namespace

void Kdtree::build(std::span<const vec3> points, const Job& job) {
  order_.resize(points.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::size_t leaves = 1;
  while (leaves * kLeafPoints < points.size()) leaves *= 2;
  nodes_.assign(2 * leaves, {});
  buildNode(points, 1, 0, std::uint32_t(points.size()), job);
  for (std::vector<float>* component : {&x_, &y_, &z_}) component->assign(points.size() + kLanes, 0.0f);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
    job.throwIfStopped();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const vec3 p = points[order_[i]];
      x_[i] = p.x;
      y_[i] = p.y;
      z_[i] = p.z;
    }
  });
}

void Kdtree::buildNode(std::span<const vec3> points, std::uint32_t node, std::uint32_t begin,
                       std::uint32_t end, const Job& job) {
  if (end - begin <= kLeafPoints) return;
  Bounds bounds;
  for (std::uint32_t i = begin; i < end; ++i) bounds.extend(points[order_[i]]);
  const vec3 size = bounds.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  StopCheck check(job);
  // Equal coordinates are told apart by index, so that the halves do not depend on the sort's whims.
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     check();
                     const float pa = points[a][axis];
                     const float pb = points[b][axis];
                     return pa != pb ? pa < pb : a < b;
                   });
  nodes_[node] = {points[order_[middle]][axis], std::uint32_t(axis)};
  const auto left = [&] { buildNode(points, 2 * node, begin, middle, job); };
  const auto right = [&] { buildNode(points, 2 * node + 1, middle, end, job); };
  if (end - begin > 4096) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

void Kdtree::rangesWithin(vec3 centre, float distance2, std::vector<Range>& ranges) const {
  ranges.clear();
  std::array<Pending, kMostPending> stack;
  std::size_t depth = 0;
  stack[depth++] = {1, {0, std::uint32_t(order_.size())}, vec3(0.0f), 0.0f};
  while (depth > 0) {
    Pending at = stack[--depth];
    while (at.range.end - at.range.begin > kLeafPoints) {
      const Pending far = descend(at, centre);
      if (far.distance2 >= distance2) continue;
      stack[depth++] = far;
      if (far.range.begin < at.range.begin) std::swap(at, stack[depth - 1]);
    }
    if (!ranges.empty() && ranges.back().end == at.range.begin)
      ranges.back().end = at.range.end;
    else
      ranges.push_back(at.range);
  }
}

void Kdtree::appendWithin(Range range, vec3 centre, float distance2, SimdLevel simd,
                          std::vector<NeighbourKey>& found) const {
  std::size_t count = found.size();
  found.resize(count + (range.end - range.begin) + kLanes);
  const Scan scan{x_.data() + range.begin,
                  y_.data() + range.begin,
                  z_.data() + range.begin,
                  range.end - range.begin,
                  range.begin,
                  centre,
                  distance2};
  (simd == SimdLevel::kAvx512 ? scanAvx512 : scanWithFor(simd))(scan, found.data(), count);
  found.resize(count);
}

}  // namespace isophote

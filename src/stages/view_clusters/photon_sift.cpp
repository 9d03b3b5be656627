// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/view_clusters/photon_sift.h"

#include "math/lanes.h"

#include <immintrin.h>

namespace isophote::view_clusters {
namespace {

constexpr std::uint32_t kLanes = PhotonColumns::kLanes;

SHARED_FN std::uint32_t maskOf(bool holds) { return 0u - std::uint32_t(holds); }

/// A bit each of kLanes photons.
struct Meeting {
  std::uint32_t touching, enclosing, accepted;
};

struct Limits {
  float reach2, hold2;  ///< Of squared distances; the margins are wider than rounding.
  explicit Limits(float radius2) : reach2(radius2 * 1.0001f), hold2(radius2 * 0.9999f) {}
};

SHARED_FN Meeting meet(const Node& node, Limits limits, const PhotonColumns& from, std::uint32_t first) {
  const float* const x = from.components[0].data() + first;
  const float* const y = from.components[1].data() + first;
  const float* const z = from.components[2].data() + first;
  const float* const toX = from.components[3].data() + first;
  const float* const toY = from.components[4].data() + first;
  const float* const toZ = from.components[5].data() + first;
  std::uint32_t touching = 0, enclosing = 0, accepted = 0;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const vec3 p(x[i], y[i], z[i]);
    const vec3 below = node.bounds.lower - p, above = p - node.bounds.upper;
    const vec3 outside = max(max(below, above), vec3(0.0f));
    const vec3 farthest = min(below, above);
    const float facing = dot(node.axis, vec3(toX[i], toY[i], toZ[i]));
    const std::uint32_t bit = detail::kBits[i];
    const float near2 = dot(outside, outside), far2 = dot(farthest, farthest);
    touching |= bit & maskOf(near2 <= limits.reach2) & maskOf(facing >= -node.reject);
    enclosing |= bit & maskOf(far2 <= limits.hold2);
    accepted |= bit & maskOf(facing > node.accept);
  }
  return {touching, enclosing, accepted};
}

/// Of the photons of a block that a node meets: which go where.
SHARED_FN Meeting sorted(Meeting m, bool divides, std::uint32_t left) {
  const std::uint32_t touching = left < kLanes ? m.touching & ((1u << left) - 1u) : m.touching;
  const std::uint32_t held = touching & m.enclosing;
  const std::uint32_t accepted = held & m.accepted;
  const std::uint32_t enclosing = divides ? 0u : held & ~accepted;
  return {touching & ~(accepted | enclosing), enclosing, accepted};
}

SHARED_FN void siftBody(const Node& node, float radius2, const PhotonColumns& from, bool columns,
                        Sifted& to) {
  std::uint32_t touching = 0, enclosing = 0, accepted = 0;
  const Limits limits(radius2);
  for (std::uint32_t first = 0; first < from.count; first += kLanes) {
    const Meeting m = sorted(meet(node, limits, from, first), node.divides != 0, from.count - first);
    for (std::uint32_t bits = m.touching; bits != 0; bits &= bits - 1) {
      const std::uint32_t i = first + std::uint32_t(std::countr_zero(bits));
      if (columns)
        for (std::size_t c = 0; c < from.used(); ++c)
          to.touching.components[c][touching] = from.components[c][i];
      to.touching.ids[touching++] = from.ids[i];
    }
    for (std::uint32_t bits = m.enclosing; bits != 0; bits &= bits - 1)
      to.enclosing[enclosing++] = from.ids[first + std::uint32_t(std::countr_zero(bits))];
    for (std::uint32_t bits = m.accepted; bits != 0; bits &= bits - 1)
      to.accepted[accepted++] = from.ids[first + std::uint32_t(std::countr_zero(bits))];
  }
  to.touching.count = touching;
  to.enclosingCount = enclosing;
  to.acceptedCount = accepted;
}

ISOPHOTE_SIMD(siftWith, siftBody,
              (const Node& node, float radius2, const PhotonColumns& from, bool columns, Sifted& to),
              (node, radius2, from, columns, to))

/// siftBody by hand: GCC finds neither masks nor compression in it, which makes this three times as fast.
__attribute__((target("avx512f"))) void siftAvx512(const Node& node, float radius2, const PhotonColumns& from,
                                                   bool columns, Sifted& to) {
  constexpr __mmask16 kAll = 0xffff;
  const Limits limits(radius2);
  const __m512 reach2 = _mm512_set1_ps(limits.reach2), hold2 = _mm512_set1_ps(limits.hold2);
  const __m512 reject = _mm512_set1_ps(-node.reject), accept = _mm512_set1_ps(node.accept);
  const __m512 zero = _mm512_setzero_ps();
  __m512 lower[3], upper[3], axis[3];
  for (int c = 0; c < 3; ++c) {
    lower[c] = _mm512_set1_ps(node.bounds.lower[c]);
    upper[c] = _mm512_set1_ps(node.bounds.upper[c]);
    axis[c] = _mm512_set1_ps(node.axis[c]);
  }
  std::uint32_t touching = 0, enclosing = 0, accepted = 0;
  for (std::uint32_t first = 0; first < from.count; first += kLanes) {
    __m512 near2 = zero, far2 = zero, facing = zero;
    for (int c = 0; c < 3; ++c) {
      const __m512 p = _mm512_loadu_ps(from.components[c].data() + first);
      const __m512 wi = _mm512_loadu_ps(from.components[3 + c].data() + first);
      const __m512 below = lower[c] - p, above = p - upper[c];
      // GCC 12 takes the forms without a mask for reads of uninitialised memory.
      const __m512 outside = _mm512_maskz_max_ps(kAll, _mm512_maskz_max_ps(kAll, below, above), zero);
      const __m512 farthest = _mm512_maskz_min_ps(kAll, below, above);
      near2 += outside * outside;
      far2 += farthest * farthest;
      facing += axis[c] * wi;
    }
    Meeting m;
    m.touching =
        _mm512_mask_cmp_ps_mask(_mm512_cmp_ps_mask(near2, reach2, _CMP_LE_OQ), facing, reject, _CMP_GE_OQ);
    if (m.touching == 0) continue;
    m.enclosing = _mm512_cmp_ps_mask(far2, hold2, _CMP_LE_OQ);
    m.accepted = _mm512_cmp_ps_mask(facing, accept, _CMP_GT_OQ);
    m = sorted(m, node.divides != 0, from.count - first);
    const __m512i ids = _mm512_loadu_si512(from.ids.data() + first);
    const auto append = [&](std::uint32_t mask, std::uint32_t * list, std::uint32_t & count)
        __attribute__((always_inline, target("avx512f"))) {
      _mm512_storeu_si512(list + count, _mm512_maskz_compress_epi32(__mmask16(mask), ids));
      count += std::uint32_t(std::popcount(mask));
    };
    if (columns)
      for (std::size_t c = 0; c < from.used(); ++c)
        _mm512_storeu_ps(to.touching.components[c].data() + touching,
                         _mm512_maskz_compress_ps(__mmask16(m.touching),
                                                  _mm512_loadu_ps(from.components[c].data() + first)));
    append(m.touching, to.touching.ids.data(), touching);
    append(m.enclosing, to.enclosing.data(), enclosing);
    append(m.accepted, to.accepted.data(), accepted);
  }
  to.touching.count = touching;
  to.enclosingCount = enclosing;
  to.acceptedCount = accepted;
}

}  // namespace

SiftFn siftFor(SimdLevel level) { return level == SimdLevel::kAvx512 ? siftAvx512 : siftWithFor(level); }

void PhotonColumns::reserve(std::size_t photons, bool withPower) {
  const std::size_t room = photons + 2 * kLanes;
  hasPower = withPower;
  for (std::size_t c = 0; c < used(); ++c)
    if (components[c].size() < room) components[c].resize(room);
  if (ids.size() < room) ids.resize(room);
}

void Sifted::reserve(std::size_t photons, bool withPower) {
  touching.reserve(photons, withPower);
  const std::size_t room = photons + 2 * PhotonColumns::kLanes;
  if (enclosing.size() >= room) return;
  enclosing.resize(room);
  accepted.resize(room);
}

}  // namespace isophote::view_clusters

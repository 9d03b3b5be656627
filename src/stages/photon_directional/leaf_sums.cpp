// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_directional/leaf_sums.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace isophote::photon_directional {
namespace {

using view_clusters::PhotonColumns;

constexpr std::uint32_t kLanes = PhotonColumns::kLanes;

/// All bits where it holds, else none: GCC branches otherwise instead of vectorising.
SHARED_FN std::uint32_t maskOf(bool holds) { return 0u - std::uint32_t(holds); }

SHARED_FN void sumPhotonsBody(const LeafShape& leaf, float radius2, const PhotonColumns& from, LeafSum& out) {
  float r[kLanes] = {}, g[kLanes] = {}, b[kLanes] = {};
  std::uint32_t felt[kLanes] = {};
  const vec3 middle = leaf.middle, axis = leaf.axis;
  const float nearness = leaf.nearness, facing = leaf.facing;
  const float inside = 0.5f + radius2 * nearness;
  // Where the axis does not matter, nothing lies behind.
  const float front = facing > 0.0f ? 0.5f : 1.0f;
  for (std::uint32_t first = 0; first < from.count; first += kLanes) {
    const float* const x = from.components[0].data() + first;
    const float* const y = from.components[1].data() + first;
    const float* const z = from.components[2].data() + first;
    const float* const toX = from.components[3].data() + first;
    const float* const toY = from.components[4].data() + first;
    const float* const toZ = from.components[5].data() + first;
    const float* const powerR = from.components[6].data() + first;
    const float* const powerG = from.components[7].data() + first;
    const float* const powerB = from.components[8].data() + first;
    const std::int32_t left = std::int32_t(from.count - first);
    for (std::int32_t i = 0; i < std::int32_t(kLanes); ++i) {
      const vec3 d = vec3(x[i], y[i], z[i]) - middle;
      const float near = min(max(inside - dot(d, d) * nearness, 0.0f), 1.0f);
      const float faces = min(max(front + dot(axis, vec3(toX[i], toY[i], toZ[i])) * facing, 0.0f), 1.0f);
      const std::uint32_t counts = maskOf(i < left);
      const float weight = std::bit_cast<float>(std::bit_cast<std::uint32_t>(near * faces) & counts);
      r[i] += weight * powerR[i];
      g[i] += weight * powerG[i];
      b[i] += weight * powerB[i];
      felt[i] -= maskOf(weight > 0.0f);
    }
  }
  for (std::uint32_t width = kLanes / 2; width > 0; width /= 2)
    for (std::uint32_t i = 0; i < width; ++i) {
      r[i] += r[i + width];
      g[i] += g[i + width];
      b[i] += b[i + width];
      felt[i] += felt[i + width];
    }
  out = {vec3(r[0], g[0], b[0]), felt[0]};
}

ISOPHOTE_SIMD(sumPhotons, sumPhotonsBody,
              (const LeafShape& leaf, float radius2, const PhotonColumns& from, LeafSum& out),
              (leaf, radius2, from, out))

}  // namespace

LeafSumFn leafSumFor(SimdLevel level) { return sumPhotonsFor(level); }

LeafShape leafShape(const view_clusters::Node& node, const view_clusters::Cone& cone, bool transmits,
                    float radius) {
  // Half a leaf's width, as a square of that diagonal has it; a photon's radius at most.
  const float half = 0.35f * length(node.bounds.size());
  const float ramp = std::clamp(2.0f * radius * half, 1e-4f * radius * radius, radius * radius);
  const float spread = std::sin(std::clamp(cone.angle, 1e-3f, 0.5f * kPi));
  return {node.bounds.centre(), 0.5f / ramp, cone.axis, transmits ? 0.0f : 0.5f / spread};
}

}  // namespace isophote::photon_directional

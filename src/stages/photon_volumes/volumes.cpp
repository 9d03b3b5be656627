// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/volumes.h"

#include "base/error.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

namespace isophote::photon_volumes {
namespace {

using photon_estimate::BoundsNode;

/// A lower bound of ellipsoidDistance2 over each box: the squared distance of the box and, along the normal,
/// that of the slab around it, as if one point had both. The slack covers the rounding of this function and
/// of ellipsoidDistance2.
SHARED_FN void touchBody(const BoundsNode& node, const PhotonVolume& photon, std::uint64_t& mask) {
  const vec3 p = photon.position;
  const vec3 n = photon.normal;
  const float slack = 1e-6f * (abs(p.x) + abs(p.y) + abs(p.z) + photon.radius);
  mask = bitsWhere([&](int slot) __attribute__((always_inline)) {
    const vec3 lower = node.lower[slot], upper = node.upper[slot];
    const vec3 outside = max(max(lower - p, p - upper), vec3(0.0f));
    const vec3 offset = (lower + upper) * 0.5f - p;
    const vec3 extent = (upper - lower) * 0.5f;
    const float reach = abs(n.x) * extent.x + abs(n.y) * extent.y + abs(n.z) * extent.z;
    const float along = max(abs(dot(n, offset)) - (reach * 1.00001f + slack), 0.0f);
    return dot(outside, outside) * photon.inverseRadius2 + along * along * photon.normalTerm <= 1.0001f;
  });
}

ISOPHOTE_SIMD(touchNode, touchBody, (const BoundsNode& node, const PhotonVolume& photon, std::uint64_t& mask),
              (node, photon, mask))

}  // namespace

photon_estimate::TouchFn<PhotonVolume> touchFor(SimdLevel level) { return touchNodeFor(level); }

void makeVolumes(const PhotonMap& map, float radius, const PhotonVolumesSettings& settings,
                 std::vector<PhotonVolume>& volumes) {
  volumes.resize(map.photons.size());
  if (volumes.empty()) return;
  if (!(radius > 0.0f) || !std::isfinite(radius))
    failUsage("photon_volumes.radius", "the radius is {} m; it must be a positive number", radius);
  const auto range = tbb::blocked_range<std::size_t>(0, volumes.size(), 4096);
  tbb::parallel_for(range, [&](const tbb::blocked_range<std::size_t>& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      const Photon& photon = map.photons[i];
      const float r = photonRadius(photon.pathDensity, radius, settings.densityReference,
                                   settings.radiusMin * radius, settings.radiusMax * radius);
      volumes[i] = photonVolume(photon, uint(settings.kernel), r, settings.flatness);
    }
  });
}

}  // namespace isophote::photon_volumes

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_quads/quads.h"

#include "base/error.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace isophote::photon_quads {
namespace {

using photon_estimate::BoundsNode;

/// A quad lies within a sphere and, along its normal, within a slab: a point whose line of sight meets it at
/// most a * radius from the middle and b * depth away, a^2 + b^2 <= 1, is no farther than the root of the sum
/// of both squares. The slack covers the rounding of this function and of quadDistance2.
template <bool kCorners>
SHARED_FN void touchBody(const BoundsNode& node, const PhotonQuad& photon, std::uint64_t& mask) {
  mask = 0;
  if (photon.inverseRadius2 == 0.0f) return;  // Culled.
  const vec3 p = photon.position;
  const vec3 n = photon.normal;
  const float depth2 = 1.0f / photon.inverseDepth2;
  const float radius2 = 1.0f / photon.inverseRadius2;
  const float height2 = kCorners ? max(depth2, 1.0f / (photon.normalTerm + photon.inverseRadius2)) : depth2;
  const float reach2 = (radius2 + depth2) * 1.001f;
  const float slack = 1e-6f * (abs(p.x) + abs(p.y) + abs(p.z) + sqrt(reach2));
  const float height = sqrt(height2) * 1.001f + slack;
  mask = bitsWhere([&](int slot) __attribute__((always_inline)) {
    const vec3 lower = node.lower[slot], upper = node.upper[slot];
    const vec3 outside = max(max(lower - p, p - upper) - slack, vec3(0.0f));
    const vec3 offset = (lower + upper) * 0.5f - p;
    const vec3 extent = (upper - lower) * 0.5f;
    const float half = abs(n.x) * extent.x + abs(n.y) * extent.y + abs(n.z) * extent.z;
    const bool near = dot(outside, outside) <= reach2;
    return near & (abs(dot(n, offset)) <= half * 1.00001f + height);
  });
}

ISOPHOTE_SIMD(touchQuad, touchBody<false>,
              (const BoundsNode& node, const PhotonQuad& photon, std::uint64_t& mask), (node, photon, mask))
ISOPHOTE_SIMD(touchCorner, touchBody<true>,
              (const BoundsNode& node, const PhotonQuad& photon, std::uint64_t& mask), (node, photon, mask))

/// Whether quads that the eye sees from behind are seen from behind by every sample: only primary ones.
bool eyeAloneSees(const ViewSamples& view) {
  return view.tiles.size() == view.primaryTiles &&
         std::ranges::none_of(view.tiles, [](const ViewTile& tile) { return tile.transmits != 0; });
}

/// Whether no sample that the eye sees directly faces it: none within `depth` of its plane.
bool seenFromBehind(const CameraRays& camera, vec3 position, vec3 normal, float depth) {
  if (camera.orthographic > 0.5f) return dot(camera.forward, normal) > 1e-5f;
  const float magnitude = length(camera.eye) + length(position);
  return dot(camera.eye - position, normal) < -1.001f * depth - 1e-5f * magnitude;
}

}  // namespace

std::size_t makeQuads(const PhotonQuads::In& in, const PhotonQuadsSettings& settings,
                      std::vector<PhotonQuad>& quads) {
  const std::vector<Photon>& photons = in.map.photons;
  quads.resize(photons.size());
  if (quads.empty()) return 0;
  if (!(in.radius > 0.0f) || !std::isfinite(in.radius))
    failUsage("photon_quads.radius", "the radius is {} m; it must be a positive number", in.radius);
  const bool culls = !settings.corners && eyeAloneSees(in.view);
  const auto range = tbb::blocked_range<std::size_t>(0, quads.size(), 4096);
  const auto make = [&](const tbb::blocked_range<std::size_t>& part, std::size_t culled) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      const Photon& photon = photons[i];
      const float r = photonRadius(photon.pathDensity, in.radius, settings.densityReference,
                                   settings.radiusMin * in.radius, settings.radiusMax * in.radius);
      quads[i] = photonQuad(photon, uint(settings.falloff), r, settings.depth, settings.flatness);
      if (culls && seenFromBehind(in.view.camera, quads[i].position, quads[i].normal, settings.depth * r)) {
        quads[i].inverseRadius2 = 0.0f;
        ++culled;
      }
    }
    return culled;
  };
  return tbb::parallel_reduce(range, std::size_t(0), make, std::plus<>());
}

photon_estimate::TouchFn<PhotonQuad> touchFor(bool corners, SimdLevel level) {
  return corners ? touchCornerFor(level) : touchQuadFor(level);
}

}  // namespace isophote::photon_quads

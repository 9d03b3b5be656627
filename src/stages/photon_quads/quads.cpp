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

/// How far what feels a photon may be from it: in any direction and along its normal; and where the eye sees
/// it directly, along the normal and along two directions perpendicular to the line of sight.
struct QuadReach {
  float distance2, height, slack;
  vec3 across, upward;
  float heightInSight, acrossReach, upwardReach;
};

/// A point whose line of sight meets the quad a * radius from the middle and b * depth away, a^2 + b^2 <= 1,
/// is no farther than the root of the sum of both squares; and so along any direction with both lengths times
/// their cosines with it. Across the line of sight the quad is foreshortened and the depth is all but gone.
/// The ellipsoid in corners lies within a sphere of the radius and its height. The slack covers the rounding
/// of this function, its caller and quadDistance2.
template <bool kCorners>
SHARED_FN QuadReach reachOf(const PhotonQuad& photon) {
  const float depth2 = 1.0f / photon.inverseDepth2;
  const float radius2 = 1.0f / photon.inverseRadius2;
  const PhotonSight sight = unpackSight(photon.sight);
  const float spread = sight.spread;
  const float facing = min(abs(dot(sight.direction, photon.normal)) + spread, 1.0f);
  const float corner2 = kCorners ? radius2 : 0.0f;
  const float cornerHeight2 = kCorners ? 1.0f / (photon.normalTerm + photon.inverseRadius2) : 0.0f;
  const float spread2 = depth2 * spread * spread;
  QuadReach r;
  r.distance2 = (radius2 + depth2) * 1.001f;
  const vec3 p = photon.position;
  r.slack = 1e-6f * (abs(p.x) + abs(p.y) + abs(p.z) + sqrt(r.distance2));
  r.height = sqrt(max(depth2, cornerHeight2)) * 1.001f + r.slack;
  r.heightInSight = sqrt(max(depth2 * facing * facing, cornerHeight2)) * 1.001f + r.slack;
  const vec3 aside = cross(photon.normal, sight.direction);
  const float aside2 = dot(aside, aside);
  r.across = aside2 > 1e-6f ? aside * inversesqrt(aside2) : basisAround(sight.direction)[0];
  r.upward = cross(sight.direction, r.across);
  r.acrossReach = sqrt(radius2 + spread2) * 1.001f + r.slack;
  // Head on, `across` may be any direction, and the plane is hardly foreshortened.
  r.upwardReach = sqrt(max(radius2 * facing * facing + spread2, corner2)) * 1.001f + r.slack;
  return r;
}

/// Whether a box, of that middle and half its sides, has points whose coordinate along n is at most `reach`.
SHARED_FN bool isWithin(vec3 n, vec3 offset, vec3 extent, float reach) {
  const float half = abs(n.x) * extent.x + abs(n.y) * extent.y + abs(n.z) * extent.z;
  return abs(dot(n, offset)) <= half * 1.00001f + reach;
}

template <bool kCorners>
SHARED_FN void touchBody(const BoundsNode& node, const PhotonQuad& photon, std::uint64_t& mask) {
  mask = 0;
  if (photon.inverseRadius2 == 0.0f) return;  // Culled.
  const vec3 p = photon.position;
  const vec3 n = photon.normal;
  const QuadReach reach = reachOf<kCorners>(photon);
  mask = bitsWhere([&](int slot) __attribute__((always_inline)) {
    const vec3 lower = node.lower[slot], upper = node.upper[slot];
    const vec3 outside = max(max(lower - p, p - upper) - reach.slack, vec3(0.0f));
    const bool near = dot(outside, outside) <= reach.distance2;
    const bool along = isWithin(n, (lower + upper) * 0.5f - p, (upper - lower) * 0.5f, reach.height);
    return near & along;
  });
  if (mask == 0 || photon.sight == kNoSight) return;
  const std::uint64_t inSight = bitsWhere([&](int slot) __attribute__((always_inline)) {
    const vec3 lower = node.lower[slot], upper = node.upper[slot];
    const vec3 offset = (lower + upper) * 0.5f - p, extent = (upper - lower) * 0.5f;
    const bool along = isWithin(n, offset, extent, reach.heightInSight);
    const bool across = isWithin(reach.across, offset, extent, reach.acrossReach);
    const bool upward = isWithin(reach.upward, offset, extent, reach.upwardReach);
    return along & across & upward;
  });
  mask &= inSight | ~node.seenDirectly;
}

ISOPHOTE_SIMD(touchQuad, touchBody<false>,
              (const BoundsNode& node, const PhotonQuad& photon, std::uint64_t& mask), (node, photon, mask))
ISOPHOTE_SIMD(touchCorner, touchBody<true>,
              (const BoundsNode& node, const PhotonQuad& photon, std::uint64_t& mask), (node, photon, mask))

/// The lines of sight to what feels a photon of that radius, for samples that the eye sees directly.
uint sightOf(const CameraRays& camera, vec3 position, float radius) {
  if (camera.orthographic > 0.5f) return photonSight({-camera.forward, 0.0f});
  const vec3 toEye = camera.eye - position;
  const float distance = length(toEye);
  // Seen from the eye, the quad's rim is no farther from its middle than the arc sine of this.
  return distance > radius ? photonSight({toEye / distance, radius / distance}) : kNoSight;
}

/// Whether quads that the eye sees from behind are seen from behind by every sample: only primary ones.
bool eyeAloneSees(const ViewSamples& view) {
  return view.tiles.size() == view.directTiles &&
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
      quads[i].sight = sightOf(in.view.camera, quads[i].position, r);
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

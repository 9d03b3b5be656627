// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_estimate/sphere_loops.h"

#include "base/error.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace isophote::photon_estimate {
namespace {

#define ISOPHOTE_SPHERE_LOOP(name, body, ...)                                                  \
  ISOPHOTE_SIMD(name, body,                                                                    \
                (const ViewTile& tile, const PhotonSphere* spheres, const std::uint32_t* list, \
                 std::uint32_t count, int lanes, RadianceTile& sums, PairCounts& counts),      \
                (tile, spheres, list, count, __VA_ARGS__))

ISOPHOTE_SPHERE_LOOP(lambertianWithin, estimateLambertianBody<WithinSphere>, kKernelConstant, lanes, sums,
                     counts)
ISOPHOTE_SPHERE_LOOP(lambertianEnclosed, estimateLambertianBody<Everywhere>, kKernelConstant, lanes, sums,
                     counts)
ISOPHOTE_SPHERE_LOOP(flatWithin, estimateFlatBody<WithinSphere>, lanes, sums, counts)
ISOPHOTE_SPHERE_LOOP(flatEnclosed, estimateFlatBody<Everywhere>, lanes, sums, counts)
ISOPHOTE_SPHERE_LOOP(glossyWithin, estimateGlossyBody<WithinSphere>, kKernelConstant, lanes, sums, counts)

#undef ISOPHOTE_SPHERE_LOOP

template <class Footprint>
void transmitting(const ViewTile& tile, const PhotonSphere* spheres, const std::uint32_t* list,
                  std::uint32_t count, int lanes, RadianceTile& sums, PairCounts& counts) {
  estimateTransmittingBody<Footprint>(tile, spheres, list, count, kKernelConstant, lanes, sums, counts);
}

}  // namespace

SphereLoop sphereLoopFor(SphereLoopKind kind, bool enclosed, SimdLevel level) {
  if (kind.transmits) return enclosed ? transmitting<Everywhere> : transmitting<WithinSphere>;
  // To test distances all the same costs little beside the BSDF; without it, GCC does not vectorise the loop.
  if (!kind.lambertian) return glossyWithinFor(level);
  if (kind.flat) return enclosed ? flatEnclosedFor(level) : flatWithinFor(level);
  return enclosed ? lambertianEnclosedFor(level) : lambertianWithinFor(level);
}

void runSphereLoop(SphereLoop loop, const ViewTile& tile, const PhotonSphere* spheres,
                   std::span<const std::uint32_t> list, int lanes, RadianceTile& sums, PairCounts& counts) {
  for (std::size_t i = 0; i < list.size(); i += kSpheresPerCall) {
    const std::size_t count = std::min<std::size_t>(kSpheresPerCall, list.size() - i);
    loop(tile, spheres, list.data() + i, std::uint32_t(count), lanes, sums, counts);
  }
}

bool isFlat(const ViewTile& tile) {
  float largest = 0.0f;
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const vec3 d = nsOf(tile, lane) - ngOf(tile, lane);
    largest = max(largest, tile.pixel[lane] != kNoPixel ? dot(d, d) : 0.0f);
  }
  return isFlat(largest);
}

void makeSpheres(std::span<const Photon> photons, float radius, std::string_view setting,
                 std::vector<PhotonSphere>& spheres) {
  // No more than it takes, and nothing that it holds is needed.
  if (spheres.capacity() < photons.size()) spheres = {};
  spheres.resize(photons.size());
  if (spheres.empty()) return;
  if (!(radius > 0.0f) || !std::isfinite(radius))
    failUsage(std::string(setting), "the radius is {} m; it must be a positive number", radius);
  const auto range = tbb::blocked_range<std::size_t>(0, spheres.size(), 4096);
  tbb::parallel_for(range, [&](const tbb::blocked_range<std::size_t>& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) spheres[i] = photonSphere(photons[i], radius);
  });
}

}  // namespace isophote::photon_estimate

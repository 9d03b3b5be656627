// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_bvh/ellipsoids.h"

#include "base/error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace isophote {

namespace photon_bvh {
namespace {

constexpr std::size_t kChunk = 4096;
constexpr std::size_t kAhead = 12;
/// Automatic limits, in middle radii.
constexpr float kLeastRadius = 0.05f, kMostRadius = 4.0f;
/// Photons whose radii stand for all.
constexpr std::size_t kSamples = 2048;
/// What no footprint may fall below, in its larger axis: thinner ones miss the rounding of positions.
constexpr float kLeastSlimness = 1e-3f;

FootprintSmoothing smoothingOf(const PhotonBvhSettings& settings, float scattered, float caustic) {
  return {scattered, caustic, settings.compression, settings.referenceLength};
}

FootprintAxes limited(FootprintAxes a, const FootprintShape& shape, const PhotonFootprint& f) {
  for (float* radius : {&a.majorRadius, &a.minorRadius})
    *radius = std::clamp(smoothedRadius(shape.smoothing, *radius, f.spacing, f.scattered), shape.radiusMin,
                         shape.radiusMax);
  a.minorRadius = std::max(a.minorRadius, kLeastSlimness * a.majorRadius);
  return a;
}

}  // namespace

FootprintShape shapeFor(const PhotonBvh::In& in, const PhotonBvhSettings& s) {
  const float ofOne = middleRadius(in.map, s, 1.0f);
  const float scattered = ofOne > 0.0f ? in.radius / ofOne : 1.0f;
  FootprintShape shape;
  shape.smoothing = smoothingOf(s, scattered, s.smoothingCaustic * in.shrink);
  shape.radiusMin = s.radiusMin > 0.0f ? s.radiusMin * in.shrink : kLeastRadius * in.radius;
  shape.radiusMax = s.radiusMax > 0.0f ? s.radiusMax * in.shrink : kMostRadius * in.radius;
  shape.radiusMin = std::min(shape.radiusMin, shape.radiusMax);
  shape.flatness = s.flatness;
  shape.kernel = uint(s.kernel);
  return shape;
}

void Ellipsoids::resize(std::size_t count) {
  photons.resize(count);
  for (std::vector<float>& column : columns) column.resize(count);
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis].resize(count);
    upper[axis].resize(count);
  }
}

Bounds Ellipsoids::bounds(std::size_t i) const {
  return {vec3(lower[0][i], lower[1][i], lower[2][i]), vec3(upper[0][i], upper[1][i], upper[2][i])};
}

double makeEllipsoids(const PhotonMap& map, const FootprintShape& shape, const LargeVector<KeyedIndex>& order,
                      Ellipsoids& out, const Job& job) {
  out.resize(order.size());
  std::vector<double> areas((order.size() + kChunk - 1) / kChunk, 0.0);
  tbb::parallel_for(std::size_t(0), areas.size(), [&](std::size_t chunk) {
    job.throwIfStopped();
    for (std::size_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, order.size()); ++i) {
      // Photons that come one after the other lie apart in the map.
      const std::uint32_t ahead = order[std::min(i + kAhead, order.size() - 1)].index;
      __builtin_prefetch(&map.photons[ahead]);
      __builtin_prefetch(&map.photons[ahead].bounce);
      __builtin_prefetch(&map.footprints[ahead]);
      const Photon& photon = map.photons[order[i].index];
      const PhotonFootprint& footprint = map.footprints[order[i].index];
      const vec3 n = unpackDirection(photon.normal);
      const FootprintAxes axes = limited(footprintAxes(footprint, n), shape, footprint);
      out.photons[i] = photonEllipsoid(photon, shape.kernel, axes, n, shape.flatness);
      // What rounding adds to a position and takes from a distance stays inside of the box.
      const vec3 reach = ellipsoidReach(axes, n, shape.flatness) * 1.0001f + 1e-6f * abs(photon.position);
      for (int axis = 0; axis < 3; ++axis) {
        out.lower[axis][i] = photon.position[axis] - reach[axis];
        out.upper[axis][i] = photon.position[axis] + reach[axis];
      }
      const PhotonEllipsoid& e = out.photons[i];
      const float radius = max(axes.majorRadius, shape.flatness * axes.minorRadius) * 1.0001f +
                           1e-6f * length(photon.position);
      const float columns[kEllipsoidColumns] = {
          e.position.x, e.position.y, e.position.z, radius * radius, e.xx,          e.yy,         e.zz,
          e.xy,         e.xz,         e.yz,         e.direction.x,   e.direction.y, e.direction.z};
      for (std::uint32_t k = 0; k < kEllipsoidColumns; ++k) out.columns[k][i] = columns[k];
      areas[chunk] += double(kPi * axes.majorRadius * axes.minorRadius);
    }
  });
  double sum = 0;
  for (const double area : areas) sum += area;
  return sum;
}

}  // namespace photon_bvh

float middleRadius(const PhotonMap& map, const PhotonBvhSettings& settings, float smoothing) {
  const FootprintSmoothing s = photon_bvh::smoothingOf(settings, smoothing, 1.0f);
  const std::size_t n = map.footprints.size(), samples = std::min(n, 4 * photon_bvh::kSamples);
  std::vector<float> radii;
  for (std::size_t i = 0; i < samples && radii.size() < photon_bvh::kSamples; ++i) {
    const std::size_t at = i * n / samples;
    const PhotonFootprint& f = map.footprints[at];
    if (f.scattered == 0u) continue;
    const FootprintAxes a = footprintAxes(f, unpackDirection(map.photons[at].normal));
    radii.push_back(std::sqrt(smoothedRadius(s, a.majorRadius, f.spacing, 1u) *
                              smoothedRadius(s, a.minorRadius, f.spacing, 1u)));
  }
  if (radii.empty()) return 0.0f;
  const auto middle = radii.begin() + std::ssize(radii) / 2;
  std::ranges::nth_element(radii, middle);
  return *middle;
}

}  // namespace isophote

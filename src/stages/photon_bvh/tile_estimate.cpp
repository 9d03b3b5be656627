// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_bvh/tile_estimate.h"

#include "stages/photon_estimate/photon_loops.h"

#include <algorithm>
#include <bit>

namespace isophote::photon_bvh {

namespace {

using namespace photon_estimate;

#define ISOPHOTE_FOOTPRINT_LOOP(name, body)                                                                  \
  ISOPHOTE_SIMD(                                                                                             \
      name, body,                                                                                            \
      (const ViewTile& tile, const PhotonEllipsoid* photons, const std::uint32_t* list, std::uint32_t count, \
       uint kernel, int begin, int end, RadianceTile& sums, PairCounts& counts),                             \
      (tile, photons, list, count, kernel, end, sums, counts, begin))

ISOPHOTE_FOOTPRINT_LOOP(lambertianLoop, estimateLambertianBody<WithinFootprint>)
ISOPHOTE_FOOTPRINT_LOOP(glossyLoop, estimateGlossyBody<WithinFootprint>)

#undef ISOPHOTE_FOOTPRINT_LOOP

void transmittingLoop(const ViewTile& tile, const PhotonEllipsoid* photons, const std::uint32_t* list,
                      std::uint32_t count, uint kernel, int begin, int end, RadianceTile& sums,
                      PairCounts& counts) {
  estimateTransmittingBody<WithinFootprint>(tile, photons, list, count, kernel, end, sums, counts, begin);
}

/// The first bits, 64 at most.
std::uint64_t lowest(int bits) { return bits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1; }

/// A loop over photons against the lanes from `begin` to `end` of a tile.
using Loop = void (*)(const ViewTile& tile, const PhotonEllipsoid* photons, const std::uint32_t* list,
                      std::uint32_t count, uint kernel, int begin, int end, RadianceTile& sums,
                      PairCounts& counts);

Loop loopFor(const ViewTile& tile, SimdLevel level) {
  if (tile.transmits != 0) return transmittingLoop;
  return tile.lambertian != 0 ? lambertianLoopFor(level) : glossyLoopFor(level);
}

SampleBox boxOf(const ViewTile& tile, std::uint64_t lanes) {
  SampleBox box{};
  Bounds bounds;
  vec3 sum(0.0f);
  for (std::uint64_t left = lanes; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    bounds.extend(positionOf(tile, lane));
    sum += ngOf(tile, lane);
    ++box.count;
  }
  if (box.count == 0) return box;
  box.centre = bounds.centre();
  box.extent = 0.5f * bounds.size() * 1.0001f + 1e-6f * abs(box.centre);  // For what rounding moves.
  box.normal = sum * inversesqrt(max(dot(sum, sum), 1e-12f));
  float least = 1.0f;
  for (std::uint64_t left = lanes; left != 0; left &= left - 1)
    least = min(least, dot(box.normal, ngOf(tile, std::countr_zero(left))));
  // Where normals lie within an angle a of the middle one, light comes from within 90 degrees + a of it.
  const bool anyFront = tile.transmits != 0 || least <= 0.0f;
  box.leastFacing = anyFront ? -2.0f : -sqrt(max(1.0f - least * least, 0.0f)) - 1e-3f;
  return box;
}

/// 1 where an ellipsoid, and the sphere around it, may reach into the samples' box and its photon meets the
/// front of one of them. As the ellipsoid measures, the box is no nearer than its centre less the farthest
/// that a point of it can be from there.
SHARED_FN void meetBody(const float* const* columns, std::uint32_t first, std::uint32_t count,
                        const SampleBox& box, std::uint32_t* __restrict out) {
  const float* __restrict column[kEllipsoidColumns];
  for (std::uint32_t k = 0; k < kEllipsoidColumns; ++k) column[k] = columns[k] + first;
  const vec3 centre = box.centre, extent = box.extent, normal = box.normal;
  const float leastFacing = box.leastFacing;
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 d = centre - vec3(column[kCentreX][i], column[kCentreY][i], column[kCentreZ][i]);
    const float xx = column[kQxx][i], yy = column[kQyy][i], zz = column[kQzz][i];
    const float distance2 = d.x * (xx * d.x + column[kQxy][i] * d.y + column[kQxz][i] * d.z) +
                            d.y * (yy * d.y + column[kQyz][i] * d.z) + zz * d.z * d.z;
    const float reach = 1.001f + 1.0001f * (extent.x * sqrt(xx) + extent.y * sqrt(yy) + extent.z * sqrt(zz));
    const float facing = column[kDirectionX][i] * normal.x + column[kDirectionY][i] * normal.y +
                         column[kDirectionZ][i] * normal.z;
    const vec3 outside = max(abs(d) - extent, vec3(0.0f));
    const bool near = (distance2 <= reach * reach) & (dot(outside, outside) <= column[kRadius2][i]);
    out[i] = (near & (facing >= leastFacing)) ? 1u : 0u;
  }
}

ISOPHOTE_SIMD(meet, meetBody,
              (const float* const* columns, std::uint32_t first, std::uint32_t count, const SampleBox& box,
               std::uint32_t* out),
              (columns, first, count, box, out))

}  // namespace

void TileEstimate::grow(std::uint32_t size) {
  if (list_.size() >= size) return;
  size += size / 2;
  list_.resize(size);
  group_.resize(size);
  met_.resize(size);
  for (std::vector<float>& column : columns_) column.resize(size);
}

void TileEstimate::find(const In& in, const SampleBox& box) {
  const float* columns[kEllipsoidColumns];
  for (std::uint32_t k = 0; k < kEllipsoidColumns; ++k) columns[k] = in.ellipsoids.columns[k].data();
  const auto meets = meetFor(in.simd);
  found_ = 0;
  in.hierarchy.forEachLeaf(box.bounds(), [&](std::uint32_t first, std::uint32_t count) {
    grow(found_ + count);
    meets(columns, first, count, box, met_.data());
    std::uint32_t found = found_;
    for (std::uint32_t i = 0; i < count; ++i) {
      list_[found] = first + i;
      found += met_[i];
    }
    for (std::uint32_t k = 0; k < kEllipsoidColumns; ++k)
      for (std::uint32_t i = found_; i < found; ++i) columns_[k][i] = columns[k][list_[i]];
    found_ = found;
  });
}

std::uint32_t TileEstimate::filter(const SampleBox& box, SimdLevel simd) {
  const float* columns[kEllipsoidColumns];
  for (std::uint32_t k = 0; k < kEllipsoidColumns; ++k) columns[k] = columns_[k].data();
  meetFor(simd)(columns, 0, found_, box, met_.data());
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < found_; ++i) {
    group_[kept] = list_[i];
    kept += met_[i];
  }
  return kept;
}

/// Samples that lie close together.
std::uint64_t TileEstimate::estimate(const In& in, const ViewTile& tile, std::uint64_t lanes,
                                     const SampleBox& box, RadianceTile& out, PairCounts& counts) {
  find(in, box);
  if (found_ == 0) return 0;
  samples_.pack(tile, lanes, {.lambertian = tile.lambertian != 0, .transmits = tile.transmits != 0});
  const ViewTile& packed = samples_.tile();
  const std::uint64_t used = tile.transmits != 0 ? lanes : lowest(int(box.count));
  const Loop loop = loopFor(tile, in.simd);
  std::uint64_t tested = 0;
  for (int begin = 0; begin < samples_.lanes(); begin += kGroupLanes) {
    const std::uint64_t group = used & (lowest(kGroupLanes) << begin);
    if (group == 0) continue;
    const std::uint32_t kept = group == used ? found_ : filter(boxOf(packed, group), in.simd);
    loop(packed, in.ellipsoids.photons.data(), group == used ? list_.data() : group_.data(), kept,
         uint(in.kernel), begin, begin + kGroupLanes, samples_.sums(), counts);
    tested += std::uint64_t(kept) * kGroupLanes;
  }
  samples_.addTo(out);
  return tested;
}

/// Halves what lies far apart.
std::uint64_t TileEstimate::part(const In& in, const ViewTile& tile, std::uint64_t lanes, RadianceTile& out,
                                 PairCounts& counts) {
  const SampleBox box = boxOf(tile, lanes);
  if (box.count == 1 || tile.transmits != 0 || length(box.extent) <= in.reach)
    return estimate(in, tile, lanes, box, out, counts);
  const vec3 e = box.extent;
  const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  const float middle = box.centre[axis];
  std::uint64_t below = 0;
  for (std::uint64_t left = lanes; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    if (positionOf(tile, lane)[axis] < middle) below |= std::uint64_t(1) << lane;
  }
  if (below == 0 || below == lanes) return estimate(in, tile, lanes, box, out, counts);
  return part(in, tile, below, out, counts) + part(in, tile, lanes & ~below, out, counts);
}

std::uint64_t TileEstimate::run(const In& in, const ViewTile& tile, RadianceTile& out, PairCounts& counts) {
  out = {};
  std::uint64_t lanes = 0;
  for (int lane = 0; lane < kTileLanes; ++lane)
    if (tile.pixel[lane] != kNoPixel) lanes |= std::uint64_t(1) << lane;
  if (lanes == 0) return 0;
  const std::uint64_t tested = part(in, tile, lanes, out, counts);
  if (tile.lambertian != 0) lambertianRadiance(tile, out);
  return tested;
}

}  // namespace isophote::photon_bvh

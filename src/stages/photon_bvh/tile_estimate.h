// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/photon_bvh/hierarchy.h"
#include "stages/photon_estimate/packed_samples.h"

#include <cstdint>
#include <vector>

namespace isophote::photon_bvh {

/// Some view samples of a tile as the tests against ellipsoids see them.
struct SampleBox {
  vec3 centre, extent;
  vec3 normal;        ///< In the middle of their geometric normals,
  float leastFacing;  ///< and the least cosine to it at which light meets the front of any of them.
  std::uint32_t count;

  Bounds bounds() const { return {centre - extent, centre + extent}; }
};

/// Finds the photons of one tile after the other and adds them up. The samples of a tile that spans a gap in
/// depth are parted first. The hierarchy says which leaves meet the box around samples, tests of all their
/// photons which ellipsoids may reach into it, and these are tested again for every sixteen samples, which
/// share one vector. One object a thread.
class TileEstimate {
 public:
  struct In {
    const Hierarchy& hierarchy;
    const Ellipsoids& ellipsoids;
    float reach;  ///< Samples in a larger box than this are parted: half its diagonal [m].
    Kernel kernel;
    SimdLevel simd;
  };
  /// Radiance at the tile's samples, overwritten. Returns the pairs of a photon and a lane that were tested;
  /// adds to counts.contributing those where the photon adds light.
  std::uint64_t run(const In& in, const ViewTile& tile, RadianceTile& out,
                    photon_estimate::PairCounts& counts);

 private:
  std::uint64_t part(const In& in, const ViewTile& tile, std::uint64_t lanes, RadianceTile& out,
                     photon_estimate::PairCounts& counts);
  std::uint64_t estimate(const In& in, const ViewTile& tile, std::uint64_t lanes, const SampleBox& box,
                         RadianceTile& out, photon_estimate::PairCounts& counts);
  void find(const In& in, const SampleBox& box);
  /// Of the photons found, those that the samples in the box may feel, into group_; returns how many.
  std::uint32_t filter(const SampleBox& box, SimdLevel simd);
  void grow(std::uint32_t size);

  std::uint32_t found_ = 0;                        ///< Photons,
  std::vector<std::uint32_t> list_;                ///< their indices,
  std::vector<float> columns_[kEllipsoidColumns];  ///< and those of Ellipsoids.
  std::vector<std::uint32_t> group_, met_;
  photon_estimate::PackedSamples samples_;
};

}  // namespace isophote::photon_bvh

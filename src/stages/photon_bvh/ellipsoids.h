// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/keyed_sort.h"
#include "math/bounds.h"
#include "stages/photon_bvh/photon_bvh.h"
#include "stages/photon_estimate/photon_ellipsoid.shared.h"

#include <cstdint>
#include <vector>

namespace isophote::photon_bvh {

/// What the settings mean for one map.
struct FootprintShape {
  FootprintSmoothing smoothing;
  float radiusMin, radiusMax;  ///< [m]
  float flatness;
  uint kernel;
};
FootprintShape shapeFor(const PhotonBvh::In& in, const PhotonBvhSettings& settings);

/// What tests against boxes ask of an ellipsoid: a number an array, so that they run at full width.
enum EllipsoidColumn : std::uint32_t {
  kCentreX,  ///< The photon.
  kCentreY,
  kCentreZ,
  kRadius2,  ///< Of the sphere around the ellipsoid.
  kQxx,      ///< As PhotonEllipsoid.
  kQyy,
  kQzz,
  kQxy,
  kQxz,
  kQyz,
  kDirectionX,  ///< Towards where the photon came from.
  kDirectionY,
  kDirectionZ,
  kEllipsoidColumns
};

/// Photons in the order of the hierarchy.
struct Ellipsoids {
  LargeVector<PhotonEllipsoid> photons;
  std::vector<float> lower[3], upper[3];  ///< Of the boxes around them.
  std::vector<float> columns[kEllipsoidColumns];

  std::size_t size() const { return photons.size(); }
  void resize(std::size_t count);
  Bounds bounds(std::size_t i) const;
  std::uint64_t bytes() const {
    return photons.size() * (sizeof(PhotonEllipsoid) + (6 + kEllipsoidColumns) * sizeof(float));
  }
};

/// Ellipsoid i of `out` is that of photon order[i].index. Returns the sum of the areas of their sections with
/// the photons' planes [m^2].
double makeEllipsoids(const PhotonMap& map, const FootprintShape& shape, const LargeVector<KeyedIndex>& order,
                      Ellipsoids& out, const Job& job = {});

}  // namespace isophote::photon_bvh

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "stages/view_clusters/cluster_tree.h"
#include "stages/view_clusters/photon_sift.h"

#include <cstdint>

namespace isophote::photon_directional {

/// How a leaf feels photons: ramps about the distance and the direction up to which it does.
struct LeafShape {
  vec3 middle;
  float nearness;  ///< Of the ramp over squared distances [1/m^2].
  vec3 axis;       ///< Of its normals.
  float facing;    ///< Of the ramp over the cosine with the axis; 0 where photons from behind count too.
};
LeafShape leafShape(const view_clusters::Node& node, const view_clusters::Cone& cone, bool transmits,
                    float radius);

struct LeafSum {
  vec3 flux;  ///< Weighted power of the photons, each as far as it is felt.
  std::uint32_t felt;
};

/// Sums up the photons of a list that a leaf feels. The same bytes at every SimdLevel.
using LeafSumFn = void (*)(const LeafShape& leaf, float radius2, const view_clusters::PhotonColumns& from,
                           LeafSum& out);
LeafSumFn leafSumFor(SimdLevel level);

}  // namespace isophote::photon_directional

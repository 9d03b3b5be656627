// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "math/lanes.h"
#include "math/simd.h"
#include "physics/light_view.shared.h"
#include "stages/direct/disc_taps.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/raster.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote {

namespace direct {
using FloatLanes = Lanes<float, kTileLanes>;
}

/// How shadow maps are made and looked up. Biases are measured in texels: what a texel covers where the
/// shaded point lies.
struct ShadowMapOptions {
  std::uint32_t resolution;  ///< Texels along a side.
  std::uint32_t filter;      ///< Width of the box over which what is lit is averaged [texels].
  float bias;                ///< How far a point lit at a right angle to its normal is moved off its surface.
  float beyond = 0.0f;       ///< How much of a picture lies beyond what its light lights, on every side, for
                             ///< wide penumbrae at its border.
};

/// What percentage-closer soft shadows (Fernando 2005) need to know besides the maps.
struct SoftLookUp {
  float size;                               ///< As of direct::SoftLight.
  std::span<const direct::DiscTap> search;  ///< Where what throws the shadow is looked for,
  std::span<const direct::DiscTap> blur;    ///< and where what is lit.
  /// By how much the discs are turned at each lane.
  const direct::FloatLanes& turnSine;
  const direct::FloatLanes& turnCosine;
};

/// Depths as lights see the scene: six faces for a point, one picture for a spot's cone, one orthographic
/// picture of the scene's bounds for a directional light. Lights with an area have none.
class ShadowMaps {
 public:
  /// Renders the maps of the lights whose `shining` is not 0, of all where it is empty. Reuses memory. Throws
  /// Error(kResources) where they do not fit job.memoryBudgetBytes.
  void build(const RasterScene& scene, std::span<const Light> lights, std::span<const std::uint8_t> shining,
             const ShadowMapOptions& options, const Job& job);

  bool has(std::uint32_t light) const {
    return light < mapOfLight_.size() && mapOfLight_[light].viewCount > 0;
  }

  /// The part of a light's rays that reaches a point with that geometric normal, on the light's side: 0 in
  /// shadow, 1 in light, between on a shadow's edge, which is as soft as the filter is wide.
  float visibility(std::uint32_t light, vec3 position, vec3 ng) const;

  /// Likewise at the lanes of a tile whose bits are set; the other lanes become any number from 0 to 1.
  void visibility(std::uint32_t light, const ViewTile& tile, std::uint64_t lanes,
                  Lanes<float, kTileLanes>& out, SimdLevel level = bestSimdLevel()) const;

  /// Soft shadows of a light that is given a size: the mean depth of what lies nearer to the light says how
  /// wide the penumbra is, which is averaged over. penumbra: its radius where the surface lies, seen from the
  /// light [m]; 0 where nothing is in the way.
  void softVisibility(std::uint32_t light, const SoftLookUp& soft, const ViewTile& tile, std::uint64_t lanes,
                      direct::FloatLanes& out, direct::FloatLanes& penumbra,
                      SimdLevel level = bestSimdLevel()) const;

  std::uint64_t texels() const { return texels_; }

 private:
  struct Map {
    std::uint32_t firstView = 0, viewCount = 0;
  };

  ShadowMapOptions options_{};
  std::vector<Map> mapOfLight_;
  std::vector<LightView> views_;
  /// By view: along its forward axis, row by row; kNoDepth where nothing is.
  std::vector<LargeVector<float>> depths_;
  std::vector<float> nearest_;  ///< By view: the least depth.
  std::uint64_t texels_ = 0;
  Rasteriser rasteriser_;
};

}  // namespace isophote

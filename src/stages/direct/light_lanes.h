// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "physics/light.shared.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

#include <cstdint>

namespace isophote::direct {

/// What a light without extent sends to the eye by way of each view sample of a tile, were nothing between
/// them.
struct LightLanes {
  alignas(64) float r[kTileLanes], g[kTileLanes], b[kTileLanes];  ///< Radiance [W/(m^2 sr)].
  float originX[kTileLanes], originY[kTileLanes],
      originZ[kTileLanes];                                  ///< Of the shadow ray, off the surface.
  float wiX[kTileLanes], wiY[kTileLanes], wiZ[kTileLanes];  ///< Unit, towards the light.
  float distance[kTileLanes];
  std::uint32_t lit[kTileLanes];  ///< 1 where there is any.

  Ray shadowRay(int lane) const {
    return {vec3(originX[lane], originY[lane], originZ[lane]), 0.0f, vec3(wiX[lane], wiY[lane], wiZ[lane]),
            distance[lane] * (1.0f - 1e-4f)};
  }
};

/// True points, spots and directional lights.
bool hasNoExtent(const Light& light);

/// For a light that has no extent, and a tile that does not transmit.
void lightTile(const Light& light, const ViewTile& tile, LightLanes& out, SimdLevel level = bestSimdLevel());

}  // namespace isophote::direct

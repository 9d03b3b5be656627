// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/lanes.h"
#include "math/simd.h"
#include "physics/light.shared.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

#include <cstdint>

namespace isophote::direct {

/// What a light without extent sends to the eye by way of each view sample of a tile, were nothing between
/// them.
struct LightLanes {
  Vec3Lanes<kTileLanes> radiance;     ///< [W/(m^2 sr)].
  Vec3Lanes<kTileLanes> origin;       ///< Of the shadow ray, off the surface.
  Vec3Lanes<kTileLanes> wi;           ///< Unit, towards the light.
  Lanes<float, kTileLanes> distance;  ///< To just before it.
  std::uint64_t lit = 0;              ///< Lanes where there is any.
};

/// The part of a light that arrives at each lane.
using LightVisibility = Lanes<float, kTileLanes>;

/// Adds what arrives.
void addVisible(const LightLanes& lanes, const LightVisibility& visible, RadianceTile& out,
                SimdLevel level = bestSimdLevel());

/// True points, spots and directional lights.
bool hasNoExtent(const Light& light);

/// For a light that has no extent, and a tile that does not transmit.
void lightTile(const Light& light, const ViewTile& tile, LightLanes& out, SimdLevel level = bestSimdLevel());

}  // namespace isophote::direct

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/photon_differential.shared.h"
#include "scene/scene.h"
#include "stages/photon_trace/emission.h"
#include "stages/photon_trace/path_columns.h"

#include <cstdint>

namespace isophote {

/// What follows a path besides its PathState where footprints are asked for.
struct PathDifferential {
  PhotonDifferential step;
  std::uint32_t scattered = 0;  ///< PhotonFootprint::scattered
};

/// Differentials of photons that emitPaths() has emitted with the same numbers, of a light that emits
/// `photons` of them. Directions are spaced as photons that share the light's solid angle (of a map: by their
/// density), positions as photons that share its area.
void emitDifferentials(const Scene& scene, const Light& light, const EmissionNumbers& u, float photons,
                       const PathColumns& emitted, std::uint32_t count, PathDifferential* out);

}  // namespace isophote

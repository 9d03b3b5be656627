// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"
#include "stages/photon_trace/path_columns.h"
#include "stages/photon_trace/path_random.h"

#include <array>
#include <cstdint>

namespace isophote {

/// Random numbers of emission: by dimension (path_random.h), then by path.
using EmissionNumbers = std::array<Column<float>, kEventDimension>;

/// Dimensions from the first on that the light uses; the others may hold anything in [0, 1).
std::uint32_t emissionDimensions(const Light& light);

/// Emits a photon along each of the first `count` paths: sets origin, direction and power, the last that of a
/// light that emits this photon alone.
void emitPaths(const Scene& scene, const Light& light, const EmissionNumbers& u, std::uint32_t count,
               PathColumns& out);

}  // namespace isophote

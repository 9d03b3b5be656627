// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/settings.h"

#include <cstdint>

namespace isophote {

/// In how many batches a frame's photons are traced and estimated, one after the other, so that the photon
/// map keeps to a part of the memory budget whatever the number of photons. 1 where they fit, and where they
/// are needed all at once: by the k nearest, by a number of stored photons, by bounce maps, and by the layer
/// "density".
std::uint32_t photonBatches(const RenderSettings& settings, std::uint64_t memoryBudgetBytes);

}  // namespace isophote

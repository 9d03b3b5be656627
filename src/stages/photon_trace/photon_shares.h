// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/light.shared.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote {

/// How many of `photons` paths each light starts: in proportion to Light::power, rounded by largest remainder
/// (ties to the earlier light), at least 1 for every light with power. Sums to `photons`, or to the number of
/// lights with power where those are more; all 0 where nothing emits.
std::vector<std::uint32_t> photonShares(std::span<const Light> lights, std::uint32_t photons);

}  // namespace isophote

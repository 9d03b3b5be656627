// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "settings/visit.h"

#include <array>
#include <cstdint>

namespace isophote {

/// Pixels of a cell of the view frustum across.
enum class ClusterSize : std::uint32_t { k4x4, k8x4, k8x8, k16x8, k16x16, k32x16, k32x32 };
template <>
struct EnumNames<ClusterSize> {
  static constexpr std::array names{"4x4", "8x4", "8x8", "16x8", "16x16", "32x16", "32x32"};
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/photon.shared.h"
#include "settings/visit.h"

#include <array>
#include <cstdint>

namespace isophote {

/// Weight of a photon over its footprint, as a setting.
enum class Kernel : std::uint32_t { kConstant = kKernelConstant, kEpanechnikov = kKernelEpanechnikov };
template <>
struct EnumNames<Kernel> {
  static constexpr std::array names{"constant", "epanechnikov"};
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace isophote {

/// Whether the bytes start like a picture of linear floats: OpenEXR or Radiance HDR.
bool holdsRadiance(std::span<const std::byte> bytes);

/// Decodes an OpenEXR or Radiance HDR picture. Safe on untrusted bytes. All values come from 0 to 1e9: NaN
/// and negative ones count as 0, infinite ones as the largest half float, as a sun that was too bright for
/// its file. Throws Error(kBadInput), also for other formats, or Error(kResources) over `budgetBytes`.
Image decodeRadiance(std::span<const std::byte> bytes, std::string_view subject, std::uint64_t budgetBytes);

}  // namespace isophote

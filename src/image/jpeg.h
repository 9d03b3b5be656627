// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/decode.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace isophote {

/// Decodes a JPEG (grey, YCbCr, RGB, CMYK or YCCK; baseline or progressive) to 8-bit RGBA. CMYK is taken as
/// plain ink coverage, r = (1 - c)(1 - k), since profiles are ignored. A truncated file is an error. Errors
/// as decodeImage().
DecodedImage decodeJpeg(std::span<const std::byte> bytes, std::string_view subject,
                        std::uint64_t budgetBytes);

}  // namespace isophote

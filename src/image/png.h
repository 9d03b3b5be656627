// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/decode.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isophote {

/// Decodes any PNG (1 to 16 bits, grey, palette, RGB, with or without alpha, interlaced) to 8-bit RGBA.
/// 16-bit values are rounded to 8 bits. Errors as decodeImage().
DecodedImage decodePng(std::span<const std::byte> bytes, std::string_view subject, std::uint64_t budgetBytes);

/// Encodes 8-bit sRGB pixels, `rgb` holding 3 * width * height bytes, as a PNG marked as sRGB. The same
/// pixels give the same bytes. Precondition: 0 < width, height.
std::vector<std::uint8_t> encodePng(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/large_pages.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isophote {

/// An 8-bit picture as its file encodes it: for colours that is sRGB, for data such as normals it is the
/// plain values. Colour profiles, gamma chunks and EXIF orientation are ignored, as glTF asks. Rows from the
/// top.
struct DecodedImage {
  int width = 0;
  int height = 0;
  LargeVector<std::uint8_t> rgba;  ///< 4 * width * height; alpha is 255 where the file has none
};

/// Decodes a PNG, JPEG or TGA held in memory, told apart by their first bytes. Safe on untrusted bytes, from
/// any thread. `subject` names the picture in errors: Error(kBadInput) if the bytes are damaged or of another
/// format, Error(kResources) if decoding would take more than `budgetBytes`.
DecodedImage decodeImage(std::span<const std::byte> bytes, std::string_view subject,
                         std::uint64_t budgetBytes);

/// Name of the format that the bytes start with ("PNG", "WebP", "KTX2", ...); empty where none is recognised.
std::string_view formatOf(std::span<const std::byte> bytes);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isophote {

/// Most that reading one picture may allocate unless the caller says otherwise [bytes].
inline constexpr std::uint64_t kFilmBudgetBytes = std::uint64_t(4) << 30;

/// A film as an OpenEXR file: channels R, G, B of the picture; "<layer>.R" and so on of each layer, but
/// "normal.X",
/// ".Y", ".Z", and of the layers with one number a pixel "depth.Z" and "density.Y". All are 32-bit floats,
/// compressed with ZIP without loss. Metadata become string attributes "isophote.<key>". The same film gives
/// the same bytes.
std::vector<std::uint8_t> encodeExr(const Film& film);

/// Reads any flat, single-part OpenEXR file, scan lines or tiles, half, float or uint. Safe on untrusted
/// bytes. The film has the size of the display window, black where the file has no data. Channels R, G, B or
/// Y without a layer are the picture; where there are none, the first layer that has colours is (else the
/// first layer). A layer of one channel is read into all three components. Alpha is ignored. Metadata come
/// sorted by key. Error(kBadInput) where the bytes are damaged or of another kind, Error(kResources) over
/// `budgetBytes`.
Film decodeExr(std::span<const std::byte> bytes, std::string_view subject,
               std::uint64_t budgetBytes = kFilmBudgetBytes);

}  // namespace isophote

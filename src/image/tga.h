// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/decode.h"

namespace isophote {

/// Reads a Truevision TGA picture: grey, colour-mapped or true-colour, plain or run-length encoded, from any
/// of its four corners. For decodeImage(), whose promises it keeps.
DecodedImage decodeTga(std::span<const std::byte> bytes, std::string_view subject, std::uint64_t budgetBytes);

}  // namespace isophote

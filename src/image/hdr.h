// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace isophote {

/// Reads a Radiance picture (.hdr): RGBE texels, plain or run-length encoded in either of the format's ways,
/// lines in any of its eight orders. Its EXPOSURE is divided out; texels are mantissa times power of two, so
/// that white is 1. Safe on untrusted bytes. Error(kBadInput) where they are damaged or of another kind,
/// Error(kResources) over `budgetBytes`.
Image decodeHdr(std::span<const std::byte> bytes, std::string_view subject, std::uint64_t budgetBytes);

}  // namespace isophote

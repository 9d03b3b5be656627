// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace isophote {

/// Walks the header of an OpenEXR file before the library sees it, because the library allocates what the
/// header asks for. Throws an Error that names `subject` unless the file is flat and of one part, every
/// attribute lies within the file, the windows are sane, the file is long enough for the pixels that it
/// declares, and the library's buffers fit `budgetBytes`. Precondition: the bytes start with the magic
/// number.
void requireSaneExrHeader(std::span<const std::byte> bytes, std::string_view subject,
                          std::uint64_t budgetBytes);

}  // namespace isophote

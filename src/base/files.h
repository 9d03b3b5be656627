// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace isophote {

/// A whole file as bytes. Throws Error(kBadInput) where there is none, where it cannot be read, is a folder,
/// a device or a pipe (which may never end), and where it holds more than `maxBytes`.
std::string readFile(const std::filesystem::path& path, std::uint64_t maxBytes = std::uint64_t(8) << 30);

/// Writes a whole file or nothing: into a temporary file of the same folder that is then renamed, and removed
/// on failure. A device or pipe (/dev/stdout) is written directly. Throws Error(kBadInput) where the folder
/// is missing or cannot be written to, Error(kResources) where the disk is full.
void writeFileAtomically(const std::filesystem::path& path, std::string_view bytes);
void writeFileAtomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

/// Throws what writeFileAtomically(path, ...) would throw now, so that long work does not end in vain. Leaves
/// no trace.
void requireWritable(const std::filesystem::path& path);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace isophote {

/// Finds the file that a scene file calls `name`, beside it in `folder`. Scene files travel: '\' separates
/// folders as
/// '/' does, upper and lower case may differ from the disk's, and where the path leads nowhere the bare file
/// name in `folder` is taken. Of several that differ in case only, the first in alphabetical order is taken.
std::optional<std::filesystem::path> findFileBeside(const std::filesystem::path& folder,
                                                    std::string_view name);

}  // namespace isophote

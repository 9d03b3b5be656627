// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace isophote::viewer {

/// The first of "name-0001.png", "name-0002.png", ... in the folder that does not exist there yet: a picture
/// that is kept never replaces another.
std::filesystem::path unusedName(const std::filesystem::path& folder, std::string_view name,
                                 std::string_view ending);

/// What pictures of that scene are called: "room" for "models/room.glb".
std::string screenshotName(std::string_view scene);

}  // namespace isophote::viewer

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/screenshot.h"

#include "base/error.h"

namespace isophote::viewer {

std::filesystem::path unusedName(const std::filesystem::path& folder, std::string_view name,
                                 std::string_view ending) {
  constexpr int kMost = 1'000'000;
  for (int number = 1; number < kMost; ++number) {
    std::filesystem::path path = folder / fmt::format("{}-{:04}{}", name, number, ending);
    // A link that leads nowhere is somebody's, too.
    if (!std::filesystem::exists(std::filesystem::symlink_status(path))) return path;
  }
  failInput(folder.string(), "holds a million pictures of \"{}\"; move them elsewhere", name);
}

std::string screenshotName(std::string_view scene) {
  const std::string name = std::filesystem::path(scene).stem().string();
  return name.empty() ? "picture" : name;
}

}  // namespace isophote::viewer

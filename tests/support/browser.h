// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/files.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace isophote {

/// Whether there is a browser that tests can run; where not, they skip.
inline bool hasBrowser() { return std::system("command -v chromium >/dev/null") == 0; }
inline constexpr const char* kNoBrowser = "there is no browser to open the page with (package chromium)";

/// What Chromium without a window prints on stdout; its own files are kept in the folder. No sandbox, as a
/// test may run as root, and only opens pages that we wrote.
inline std::string runBrowser(const std::filesystem::path& folder, const std::string& arguments) {
  const std::filesystem::path output = folder / "browser.stdout";
  const std::string line = fmt::format(
      "cd '{0}' && HOME='{0}' timeout -k 1 120 chromium --headless --no-sandbox --disable-gpu "
      "--disable-dev-shm-usage --hide-scrollbars --force-color-profile=srgb --user-data-dir='{0}/browser' "
      "{1} >'{2}' 2>'{0}/browser.stderr' </dev/null",
      folder.string(), arguments, output.string());
  if (std::system(line.c_str()) != 0) return "the browser failed: " + readFile(folder / "browser.stderr");
  return readFile(output);
}

}  // namespace isophote

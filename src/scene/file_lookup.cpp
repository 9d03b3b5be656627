// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/file_lookup.h"

#include <algorithm>
#include <string>

namespace isophote {

namespace {

namespace fs = std::filesystem;

bool equalButForCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

/// The entry of `folder` called `name` when case does not count.
std::optional<fs::path> findEntry(const fs::path& folder, const fs::path& name) {
  std::error_code error;
  if (fs::exists(folder / name, error)) return folder / name;
  std::optional<fs::path> found;
  fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path candidate = entry->path().filename();
    if (!equalButForCase(candidate.string(), name.string())) continue;
    if (!found || candidate < found->filename()) found = folder / candidate;
  }
  return found;
}

std::optional<fs::path> findPath(const fs::path& folder, const fs::path& path) {
  fs::path found = folder;
  for (const fs::path& part : path) {
    const std::optional<fs::path> entry = findEntry(found, part);
    if (!entry) return std::nullopt;
    found = *entry;
  }
  std::error_code error;
  return fs::is_regular_file(found, error) ? std::optional(found) : std::nullopt;
}

}  // namespace

std::optional<fs::path> findFileBeside(const fs::path& folder, std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '\\', '/');
  const fs::path path = text;
  if (path.filename().empty()) return std::nullopt;
  std::error_code error;
  // A name that holds a real backslash, and absolute paths.
  if (fs::path exact = folder / fs::path(name); fs::is_regular_file(exact, error)) return exact;
  if (path.is_relative()) {
    if (auto found = findPath(folder, path)) return found;
  } else if (fs::is_regular_file(path, error)) {
    return path;
  }
  return findPath(folder, path.filename());
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isophote/world.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// What is said of one setting to people.
struct SettingInfo {
  std::string key;    ///< "photon_trace.photons"
  std::string value;  ///< As set() reads it.
  std::string range;  ///< In words; empty: every value of its kind.
  std::string unit;
  std::string help;
};

/// How a world is rendered: every setting of `isophote info --settings`, by its key.
class Settings {
 public:
  Settings();  ///< Defaults.
  /// The complete choice that reproduces a published system ("jensen", ...). Throws Error(kBadUsage) that
  /// lists the names.
  static Settings preset(std::string_view name);
  ~Settings();
  Settings(const Settings& other);
  Settings& operator=(const Settings& other);
  Settings(Settings&&) noexcept;
  Settings& operator=(Settings&&) noexcept;

  /// Sets what the scene's own description asks for.
  Settings& apply(const World& world);
  /// How much work goes into a picture, in one word: "draft", "preview" or "final" replace photons,
  /// subsampling and passes, and nothing else. Renderer::render() makes all of the passes. Throws
  /// Error(kBadUsage) that lists the names.
  Settings& applyQuality(std::string_view name);
  /// Throws Error(kBadUsage) where there is no such key (naming the nearest) or the value does not fit;
  /// nothing is changed then.
  Settings& set(std::string_view key, std::string_view value);
  Settings& set(std::string_view key, double value);
  /// The object of `isophote render --settings FILE`.
  Settings& setJson(std::string_view json);
  std::string get(std::string_view key) const;
  std::string json() const;
  std::vector<SettingInfo> list() const;

  struct Content;  ///< The library's own.
  const Content& content() const { return *content_; }

 private:
  std::unique_ptr<Content> content_;
};

}  // namespace isophote

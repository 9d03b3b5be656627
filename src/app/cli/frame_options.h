// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/cli/setting_options.h"
#include "render/settings.h"
#include "scene/scene.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace isophote::cli {

/// How commands that light scenes with photons are told the settings: a preset, a quality, a file, options,
/// --set.
struct FrameOptions {
  std::string preset;
  std::string quality;
  std::filesystem::path settingsFile;
  std::vector<std::string> assignments;
  std::vector<GivenSetting> given;

  /// --preset and --quality.
  void addPresetTo(CLI::App& parser);
  /// The short options, --width and so on.
  void addShortTo(CLI::App& parser);
  /// --settings and --set.
  void addSettingsTo(CLI::App& parser);

  /// What all else is set upon.
  RenderSettings presetOrDefaults() const;
  /// Sets, over a preset or the defaults, the scene's wishes (where there is a scene yet), the quality, the
  /// settings file, the options and --set: the later ones hold. Where a time is set and no number of passes,
  /// it is not bounded by the quality's.
  void apply(std::span<const Field> fields, const Scene* scene, const std::string& sceneName) const;
};

}  // namespace isophote::cli

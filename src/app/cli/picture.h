// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/cli/command.h"
#include "base/stats.h"
#include "image/tonemap.h"
#include "scene/scene.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace isophote::cli {

/// What commands that make a picture of a scene share: which scene, and where the picture goes.
struct PictureOptions {
  std::string scene;
  std::string camera;
  std::vector<std::filesystem::path> assets;
  std::filesystem::path output;
  std::filesystem::path stats;  ///< Empty: none.
  std::string exposure;
  std::string toneMap;
  std::string layer;  ///< Empty: the whole picture.

  void addTo(CLI::App& parser, WorkOptions& work);
  // Parts of it: which scene, and how a picture is shown.
  void addSceneTo(CLI::App& parser);
  void addDisplayTo(CLI::App& parser);
  /// How a picture is shown.
  DisplayOptions display() const;
  /// Whether the film needs its layers.
  bool wantsLayers() const;
  /// Throws what would go wrong with the outputs after the work, before it; gives how a PNG is shown.
  DisplayOptions check() const;
  /// Where models are searched: --assets, then the folders in ISOPHOTE_ASSETS.
  SceneOptions sceneOptions() const;
  /// The picture alone, as it is shown.
  void writePicture(const Film& film, const DisplayOptions& display) const;
  void write(const Film& film, const DisplayOptions& display, const Stats& measured, Host& host) const;
};

/// The size of the picture where it was left open (0): a missing side follows from the other and the camera's
/// aspect (16:9 where it has none), and 720 lines is the default.
void completeSize(std::uint32_t& width, std::uint32_t& height, const Camera& camera);

}  // namespace isophote::cli

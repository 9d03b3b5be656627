// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "render/progressive.h"

#include <filesystem>

namespace isophote {

/// What a picture of many passes has come to, as an OpenEXR file: the mean so far with its layers, which can
/// be looked at, and in its metadata all that is needed to go on. Going on gives the bytes that an
/// undisturbed run would have given.
///
/// Tells what may not change in between: the settings but for the numbers of passes and seconds, the
/// geometry, materials, lights and camera of the scene.
class Checkpoint {
 public:
  /// `path` must end in .exr (Error(kBadUsage)).
  Checkpoint(std::filesystem::path path, const Scene& scene, const Camera& camera);

  /// Whether there is such a file.
  bool exists() const;
  /// Has `renderer`, which must be fresh, go on from the file. Throws Error(kBadInput) where it is damaged,
  /// or of another picture, naming the first thing that differs.
  void load(ProgressiveRenderer& renderer, const RenderSettings& settings, const Job& job = {}) const;
  /// Whole or not at all. The settings must be those of `renderer`.
  void save(const ProgressiveRenderer& renderer) const;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::string scene_;  ///< Digest of scene and camera.
};

}  // namespace isophote

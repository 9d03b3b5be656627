// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <filesystem>

namespace isophote {

/// Loads an Isophote scene description (.json): models, cameras, lights, material overrides and settings, as
/// docs/scene-description.md says. Model files are searched beside the description, then in
/// options.assetFolders. Unfinished: finishScene() is the caller's. Throws Error(kBadInput) naming the file
/// and the place in it ("lights[2].watts").
Scene loadDescription(const std::filesystem::path& file, const SceneOptions& options = {},
                      const Job& job = {});

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "scene/scene.h"

#include <filesystem>
#include <span>
#include <string>

namespace isophote::bench {

/// Scenes of the papers, with the cameras and lamps of scenes/*.json.
enum class PublicScene {
  kSponzaDabrovic,  ///< One lamp; of the papers from 2009 on. Else atrium.
  kSponzaCrytek,    ///< One lamp. Else atrium.
  kSibenik,         ///< Else atrium.
  kConference,      ///< Else cornell-objects.
  kLevel,  ///< A game level under 30 lamps, as in scenes/zdm2-lamps.json. Else atrium under 30 lamps.
  kRing,   ///< A mirror of 128 triangles in a room: always at hand.
};

/// The scene that is really measured.
struct SceneChoice {
  Scene scene;       ///< Finished; the first camera is the one to use.
  std::string name;  ///< For the rows: "Sponza (Dabrovic's)", or "atrium, for Sponza (Dabrovic's)".
  bool standsIn = false;
};

/// The public scene where one of the folders holds its model, otherwise the built-in one for it.
SceneChoice choosePublicScene(PublicScene wanted, std::span<const std::filesystem::path> folders,
                              const Job& job = {});

/// A built-in scene with a point light of so many watts in place of its own lights. Bounce maps and shadow
/// maps are for lights without extent.
Scene underPointLight(const std::string& builtin, vec3 position, float watts);

/// As many triangles as the ring of the papers: a mirror of 128 in a room of five walls, under a lamp.
Scene mirrorRing();

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace isophote {

/// Albedos of the walls.
struct CornellRoom {
  vec3 white{0.73f, 0.72f, 0.69f};  ///< Floor, ceiling and back.
  vec3 left{0.62f, 0.06f, 0.05f};
  vec3 right{0.13f, 0.46f, 0.10f};
};

/// Adds the empty Cornell room: the cube x, z in [-1, 1], y in [0, 2] metres, open at z = 1, Lambertian, with
/// an emissive lamp set flush into its ceiling (so that no light is caught above it and the surface has no
/// gap), and the camera "front", whose picture (aspect 1) ends exactly at the opening's edges. Returns the
/// white material.
std::uint32_t addCornellRoom(Scene& scene, const CornellRoom& room);

}  // namespace isophote

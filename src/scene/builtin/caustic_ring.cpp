// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// caustic-ring: a polished golden ring on a wooden table, lit from the side and above. The inner wall, an
// exact cylinder by its normals, focuses the light into the bright cusped curve that a cup shows in the sun.
// The ring is a perfect mirror; the table is Lambertian; the lamp is a small sphere and not a true point, so
// that a path tracer that starts at the eye can find it too.
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

#include <array>
#include <cmath>

namespace isophote {

namespace {

constexpr int kSlices = 512;
constexpr int kEdgeSteps = 6;
constexpr float kInner = 0.30f;   ///< Radius of the inner wall [m].
constexpr float kOuter = 0.33f;   ///< Radius of the outer wall [m].
constexpr float kHeight = 0.12f;  ///< [m]
constexpr float kEdge = 0.006f;   ///< Radius of the rounded edges [m].

/// A rectangle with rounded corners, walked so that the outside lies to the right. The flat sides and the
/// corners are apart (points given twice): sides keep exact normals.
std::vector<ProfilePoint> ringProfile() {
  struct Corner {
    vec2 centre;
    float startDegrees;
  };
  const std::array corners{Corner{{kOuter - kEdge, kEdge}, -90}, Corner{{kOuter - kEdge, kHeight - kEdge}, 0},
                           Corner{{kInner + kEdge, kHeight - kEdge}, 90},
                           Corner{{kInner + kEdge, kEdge}, 180}};
  std::vector<ProfilePoint> profile;
  for (const Corner& corner : corners) {
    for (int step = 0; step <= kEdgeSteps; ++step) {
      const float angle = (corner.startDegrees + 90.0f * float(step) / kEdgeSteps) * kPi / 180.0f;
      // The ends meet the flat sides exactly.
      const float x = step == 0 || step == kEdgeSteps ? std::round(std::cos(angle)) : std::cos(angle);
      const float y = step == 0 || step == kEdgeSteps ? std::round(std::sin(angle)) : std::sin(angle);
      const ProfilePoint point{corner.centre.x + kEdge * x, corner.centre.y + kEdge * y};
      profile.push_back(point);
      if (step == 0 || step == kEdgeSteps) profile.push_back(point);
    }
  }
  // What was walked last is the inner bottom corner; one more side closes the profile.
  profile.erase(profile.begin());
  profile.push_back(profile.front());
  return profile;
}

}  // namespace

Scene makeCausticRing() {
  Scene scene;
  scene.name = "caustic-ring";
  const auto table = addMaterial(scene, lambert("wood", {0.46f, 0.33f, 0.22f}));
  NamedMaterial gold{makeMaterial(), "gold"};
  gold.baseColour = {0.95f, 0.76f, 0.42f};
  gold.metallic = 1.0f;
  gold.roughness = 0.0f;

  Mesh tableTop, ring;
  addQuad(tableTop, {-2.5f, 0, 2}, {5, 0, 0}, {0, 0, -5});
  addObject(scene, "table", table, std::move(tableTop));
  addLathe(ring, ringProfile(), kSlices);
  addObject(scene, "ring", addMaterial(scene, gold), std::move(ring));

  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = {-0.75f, 0.78f, -1.15f};
  lamp.radius = 0.02f;
  lamp.colour = {12.0f, 11.2f, 10.0f};
  scene.lights.push_back(lamp);
  scene.cameras.push_back(
      {.name = "above", .eye = {-0.1f, 0.95f, 0.85f}, .target = {0.04f, 0, 0.05f}, .verticalFovDegrees = 38});
  return scene;
}

}  // namespace isophote

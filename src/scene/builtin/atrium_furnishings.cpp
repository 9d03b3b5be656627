// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/atrium_plan.h"
#include "scene/builtin/cloth.h"
#include "scene/builtin/masonry.h"

#include <cmath>

namespace isophote::atrium {

namespace {

void addCurtains(Scene& scene, const Materials& m) {
  Mesh rod;
  addBox(rod, {-1.3f, -0.02f, -0.02f}, {1.3f, 0.02f, 0.02f});
  const auto rodMesh = addMesh(scene, "curtain rod", m.bronze, std::move(rod));
  const std::array<std::uint32_t, 4> cloths = m.cloths();
  std::array<std::array<std::uint32_t, 2>, 4> pairs{};
  for (std::size_t i = 0; i < cloths.size(); ++i) {
    for (const std::size_t half : {std::size_t(0), std::size_t(1)}) {
      Mesh curtain;
      addCurtain(curtain, {.width = half == 0 ? 1.24f : -1.24f,
                           .height = kSpringing - kFloor - 0.08f,
                           .folds = 6,
                           .phase = float(2 * i + half)});
      pairs[i][half] = addMesh(scene, "curtain", cloths[i], std::move(curtain));
    }
  }
  // Which cloth hangs in which bay; -1: none.
  constexpr std::array<std::array<int, 7>, 2> kBays{{{-1, 0, -1, 1, -1, 3, -1}, {0, -1, 3, -1, 2, -1, 1}}};
  for (std::size_t row = 0; row < kBays.size(); ++row) {
    const Side& side = kSides[2 * row + 1];  // a long one
    for (int bay = 0; bay < side.bays; ++bay) {
      const int cloth = kBays[row][std::size_t(bay)];
      if (cloth < 0) continue;
      const float x = side.left() + kBay * (float(bay) + 0.5f), y = kSpringing - 0.03f;
      addInstance(scene, "curtain rod", rodMesh, side.at(x, y, 0));
      addInstance(scene, "curtain", pairs[std::size_t(cloth)][0], side.at(x - 1.26f, y, 0));
      addInstance(scene, "curtain", pairs[std::size_t(cloth)][1], side.at(x + 1.26f, y, 0));
    }
  }
}

/// Banners on the piers between the arches, and awnings across the yard.
void addBanners(Scene& scene, const Materials& m) {
  const std::array<std::uint32_t, 4> cloths = m.cloths();
  std::array<std::uint32_t, 4> banners{};
  for (std::size_t i = 0; i < cloths.size(); ++i) {
    Mesh banner;
    addBanner(banner, {.width = 0.78f, .height = 1.9f, .phase = 1.7f * float(i)});
    banners[i] = addMesh(scene, "banner", cloths[i], std::move(banner));
  }
  int next = 0;
  for (const Side& side : kSides) {
    for (int i = 1; i < side.bays; ++i) {
      const float x = side.left() + kBay * float(i);
      addInstance(scene, "banner", banners[std::size_t(next++ % 4)],
                  side.at(x, kGallery - 0.32f, 0.5f * kLowerDepth + 0.1f));
    }
  }
  const std::array colours{m.saffron, m.crimson};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    Mesh awning;
    addAwning(awning, {.length = 2.0f * kAxes.x - 0.6f, .width = 1.5f, .sag = 1.0f, .phase = float(i)});
    addInstance(scene, "awning", addMesh(scene, "awning", colours[i], std::move(awning)),
                turnedAndMoved(0, {0, kCeiling + 0.1f, -5.25f - 3.0f * float(i)}));
  }
}

void addFountain(Scene& scene, const Materials& m) {
  std::vector<ProfilePoint> profile;
  const auto edge = [&](float radius, float height) { profile.insert(profile.end(), 2, {radius, height}); };
  profile.push_back({1.5f, 0});
  edge(1.5f, 0.14f);
  edge(1.2f, 0.14f);
  edge(1.2f, 0.28f);
  edge(0.36f, 0.28f);
  addArc(profile, {0.32f, 0.34f}, 0.06f, -90, 90, 5);
  profile.insert(profile.end(), {{0.24f, 0.42f}, {0.17f, 0.6f}, {0.16f, 0.75f}, {0.22f, 0.9f}});
  addArc(profile, {0.22f, 0.95f}, 0.05f, -90, 90, 4);
  // The bowl, outside and inside.
  profile.insert(profile.end(), {{0.5f, 1.05f}, {0.78f, 1.14f}, {0.92f, 1.26f}, {0.97f, 1.335f}});
  addArc(profile, {0.97f, 1.37f}, 0.035f, -90, 180, 7);
  profile.insert(profile.end(), {{0.9f, 1.32f}, {0.74f, 1.2f}, {0.45f, 1.12f}, {0.16f, 1.1f}});
  // A finial with a small second bowl.
  edge(0.13f, 1.1f);
  profile.insert(profile.end(),
                 {{0.08f, 1.3f}, {0.075f, 1.5f}, {0.12f, 1.62f}, {0.3f, 1.7f}, {0.38f, 1.79f}});
  edge(0.4f, 1.84f);
  profile.insert(profile.end(), {{0.36f, 1.84f}, {0.26f, 1.77f}, {0.08f, 1.75f}});
  profile.insert(profile.end(), {{0.07f, 1.9f}, {0.13f, 2.0f}, {0.12f, 2.1f}, {0.05f, 2.2f}, {0, 2.25f}});
  Mesh mesh;
  addLathe(mesh, profile, 40);
  addObject(scene, "fountain", m.limestone, std::move(mesh));
}

/// Sprigs on crossed cards around a pot's mouth.
Mesh makeSprigs() {
  constexpr int kCards = 22;
  constexpr float kSize = 0.5f;
  Mesh mesh;
  for (int i = 0; i < kCards; ++i) {
    // Directions on a cone that opens with each sprig, turned by the golden angle.
    const float around = 2.39996f * float(i), tilt = 0.15f + 0.95f * float(i) / kCards;
    const vec3 up(std::sin(tilt) * std::cos(around), std::cos(tilt), std::sin(tilt) * std::sin(around));
    const vec3 across = normalize(cross(up, vec3(std::sin(around * 1.7f), 0.3f, std::cos(around * 1.7f))));
    const vec3 foot = vec3(0, 0.55f, 0) + 0.12f * up;
    addQuad(mesh, foot - 0.5f * kSize * across, kSize * across, kSize * up);
  }
  scaleUvs(mesh, kSize);
  return mesh;
}

void addPots(Scene& scene, const Materials& m) {
  std::vector<ProfilePoint> profile{{0.2f, 0},      {0.29f, 0.46f}, {0.29f, 0.46f}, {0.33f, 0.47f},
                                    {0.33f, 0.47f}, {0.34f, 0.56f}, {0.34f, 0.56f}, {0.29f, 0.56f},
                                    {0.29f, 0.56f}, {0.27f, 0.5f},  {0.27f, 0.5f},  {0, 0.52f}};
  Mesh pot;
  addLathe(pot, profile, 24);
  const auto potMesh = addMesh(scene, "pot", m.terracotta, std::move(pot));
  const auto sprigsMesh = addMesh(scene, "sprigs", m.leaves, makeSprigs());
  const vec2 corner = kAxes - 1.3f;
  for (const vec2 at : {vec2(corner.x, corner.y), vec2(-corner.x, corner.y), vec2(corner.x, -corner.y),
                        vec2(-corner.x, -corner.y), vec2(corner.x, 0), vec2(-corner.x, 0)}) {
    const mat4x3 place = turnedAndMoved(40.0f * at.x + 17.0f * at.y, {at.x, 0, at.y});
    addInstance(scene, "pot", potMesh, place);
    addInstance(scene, "sprigs", sprigsMesh, place);
  }
}

}  // namespace

void addFurnishings(Scene& scene, const Materials& materials) {
  addCurtains(scene, materials);
  addBanners(scene, materials);
  addFountain(scene, materials);
  addPots(scene, materials);
}

}  // namespace isophote::atrium

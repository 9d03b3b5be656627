// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/masonry.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace isophote {

namespace {

constexpr float kRadians = kPi / 180.0f;

void addTwice(std::vector<ProfilePoint>& profile, ProfilePoint point) {
  profile.push_back(point);
  profile.push_back(point);
}

/// Angles [radians] over a half circle, and those of the wall's upper corners, so that its outline is exact.
std::vector<float> archAngles(const ArchWall& wall) {
  std::vector<float> angles;
  for (int i = 0; i <= wall.segments; ++i) angles.push_back(kPi * float(i) / float(wall.segments));
  const float corner = std::atan2(wall.top - wall.springing, 0.5f * wall.width);
  for (const float exact : {corner, kPi - corner}) {
    // Moves the nearest angle rather than adding a sliver beside it.
    *std::ranges::min_element(angles, {}, [&](float a) { return std::abs(a - exact); }) = exact;
  }
  return angles;
}

/// Where the ray from the arch's centre at that angle leaves the wall's outline.
vec2 onOutline(const ArchWall& wall, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  const float halfWidth = 0.5f * wall.width, height = wall.top - wall.springing;
  const float along = std::min(halfWidth / std::max(std::abs(c), 1e-6f), height / std::max(s, 1e-6f));
  return {std::clamp(along * c, -halfWidth, halfWidth), wall.springing + std::clamp(along * s, 0.0f, height)};
}

/// The moulded band around the arch: a flat fascia, a round roll, back to the wall.
std::vector<ProfilePoint> archivoltProfile(float width) {
  std::vector<ProfilePoint> profile;
  profile.push_back({0, 0});
  addTwice(profile, {0, 0.035f});
  addTwice(profile, {0.6f * width, 0.035f});
  addTwice(profile, {0.6f * width, 0.055f});
  const float roll = 0.2f * width;
  for (int i = 0; i <= 4; ++i) {
    const float angle = kPi * (1.0f - float(i) / 4.0f);
    profile.push_back({0.8f * width + roll * std::cos(angle), 0.055f + roll * std::sin(angle)});
  }
  profile.push_back(profile.back());
  profile.push_back({width, 0});
  return profile;
}

}  // namespace

void addArc(std::vector<ProfilePoint>& profile, vec2 centre, float radius, float fromDegrees, float toDegrees,
            int steps) {
  for (int i = 0; i <= steps; ++i) {
    const float angle = kRadians * (fromDegrees + (toDegrees - fromDegrees) * float(i) / float(steps));
    profile.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
    if (i == 0 || i == steps) profile.push_back(profile.back());
  }
}

void addColumn(Mesh& mesh, const Column& column) {
  const float r = column.radius, top = column.height;
  const float plinth = 0.5f * r, abacus = 0.6f * r, capital = 1.7f * r;
  const float foot = top - abacus - capital;  // of the capital
  addBox(mesh, {-1.5f * r, 0, -1.5f * r}, {1.5f * r, plinth, 1.5f * r});

  std::vector<ProfilePoint> profile;
  // Attic base: a big roll, a hollow, a small roll.
  addArc(profile, {1.22f * r, plinth + 0.22f * r}, 0.22f * r, -90, 90, column.arcSteps);
  addTwice(profile, {1.2f * r, plinth + 0.44f * r});
  addArc(profile, {1.26f * r, plinth + 0.56f * r}, 0.12f * r, 240, 120, column.arcSteps / 2);
  addTwice(profile, {1.2f * r, plinth + 0.68f * r});
  addArc(profile, {1.12f * r, plinth + 0.78f * r}, 0.1f * r, -60, 90, column.arcSteps / 2);
  addTwice(profile, {1.06f * r, plinth + 0.88f * r});
  // The shaft: straight for a third, then tapered along a curve; a ring under the capital.
  const float shaftFoot = plinth + 1.0f * r;
  profile.push_back({r, shaftFoot});
  for (const float t : {0.4f, 0.7f, 1.0f}) {
    const float taper = std::max(0.0f, t - 0.3f) / 0.7f;
    profile.push_back({r * (1.0f - 0.16f * taper * taper), shaftFoot + t * (foot - shaftFoot)});
  }
  profile.push_back(profile.back());
  addArc(profile, {0.88f * r, foot + 0.08f * r}, 0.08f * r, -90, 90, column.arcSteps / 2);
  // The capital: a bell that opens and turns square.
  const float bell = foot + 0.16f * r;
  addTwice(profile, {0.86f * r, bell});
  const int bellSteps = column.arcSteps + 1;
  for (int i = 0; i <= bellSteps; ++i) {
    const float t = float(i) / float(bellSteps);
    const float open = t * t * (1.6f - 0.6f * t);
    profile.push_back({0.86f * r + open * (0.92f * column.abacus - 0.86f * r),
                       bell + t * (top - abacus - bell), std::min(1.0f, 1.1f * t * t)});
  }
  addLathe(mesh, profile, column.slices);

  const float half = column.abacus;
  std::vector<ProfilePoint> slab{{-half, top - abacus}};
  addTwice(slab, {-0.06f * half, top - abacus});
  addTwice(slab, {0, top - 0.6f * abacus});
  addTwice(slab, {0, top});
  slab.push_back({-half, top});
  addMoulding(mesh, slab, vec2(half));
}

void addArchWall(Mesh& mesh, const ArchWall& wall) {
  const std::vector<float> angles = archAngles(wall);
  const int count = int(angles.size()) - 1;
  const float front = 0.5f * wall.depth;
  const auto onArch = [&](int i, float offset) {
    const float angle = angles[std::size_t(i)];
    return vec2((wall.radius + offset) * std::cos(angle),
                wall.springing + (wall.radius + offset) * std::sin(angle));
  };
  for (const float z : {front, -front}) {
    addPatch(mesh, {count, 1, false, false}, [&](int column, int row) {
      const int i = z > 0 ? count - column : column;
      return vec3(row == 0 ? onArch(i, 0) : onOutline(wall, angles[std::size_t(i)]), z);
    });
  }
  addPatch(mesh, {count, 1, false, false},
           [&](int column, int row) { return vec3(onArch(column, 0), row == 0 ? front : -front); });
  addSweep(mesh, archivoltProfile(wall.archivolt), count, false, [&](int column, const ProfilePoint& point) {
    return vec3(onArch(count - column, point.radius), front + point.height);
  });
  const float crown = wall.springing + wall.radius, half = 0.45f * wall.archivolt;
  addBox(mesh, {-half, crown - 0.02f, front - 0.1f}, {half, crown + 1.35f * wall.archivolt, front + 0.11f});
}

void addGroinVault(Mesh& mesh, float radius, float springing, int segments) {
  for (int quarter = 0; quarter < 4; ++quarter) {
    Mesh sector;
    addPatch(sector, {segments, 2, false, false}, [&](int column, int row) {
      const float angle = kPi * (0.5f - float(column) / float(segments));
      const float z = radius * std::sin(angle), x = std::abs(z) + 0.5f * float(row) * (radius - std::abs(z));
      return vec3(x, springing + std::max(0.0f, radius * std::cos(angle)), z);
    });
    transform(sector, turnedAndMoved(90.0f * float(quarter), vec3(0.0f)));
    append(mesh, sector);
  }
}

void addTransverseArch(Mesh& mesh, const TransverseArch& arch) {
  const float half = 0.5f * arch.width;
  std::vector<ProfilePoint> section{{arch.radius + arch.thickness, half}};
  addTwice(section, {arch.radius, half});
  addTwice(section, {arch.radius, -half});
  section.push_back({arch.radius + arch.thickness, -half});
  addSweep(mesh, section, arch.segments, false, [&](int column, const ProfilePoint& point) {
    const float angle = kPi * (1.0f - float(column) / float(arch.segments));
    return vec3(point.height, arch.springing + point.radius * std::sin(angle),
                point.radius * std::cos(angle));
  });
}

void addBalustrade(Mesh& mesh, const Balustrade& balustrade) {
  const float half = 0.5f * balustrade.length, height = balustrade.height;
  const float foot = 0.1f, rail = height - 0.12f;
  addBox(mesh, {-half, 0, -0.11f}, {half, foot, 0.11f});
  addBox(mesh, {-half, rail, -0.12f}, {half, height, 0.12f});
  const auto at = [&](float t) { return foot + t * (rail - foot); };
  const std::array<ProfilePoint, 8> profile{{{0.060f, at(0)},
                                             {0.045f, at(0.10f)},
                                             {0.080f, at(0.32f)},
                                             {0.064f, at(0.48f)},
                                             {0.034f, at(0.74f)},
                                             {0.038f, at(0.88f)},
                                             {0.062f, at(0.93f)},
                                             {0.062f, at(1)}}};
  for (int i = 0; i < balustrade.balusters; ++i) {
    Mesh baluster;
    addLathe(baluster, profile, balustrade.slices);
    const float x = balustrade.length * ((float(i) + 0.5f) / float(balustrade.balusters) - 0.5f);
    transform(baluster, turnedAndMoved(0, {x, 0, 0}));
    append(mesh, baluster);
  }
}

}  // namespace isophote

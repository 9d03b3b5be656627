// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The plan is a grid of square bays of 3 m: 3 x 7 bays of courtyard, one bay of arcade around it. Each side
// is built in its own frame: x along the side, z from the line of columns (z = 0) into the yard, back wall at
// z = -3.
#pragma once

#include "scene/builtin/shapes.h"

#include <array>

namespace isophote::atrium {

inline constexpr float kBay = 3.0f;  ///< [m], as everything below.
/// Half the rectangle of the lines of columns, x and z.
inline constexpr vec2 kAxes{1.5f * kBay, 3.5f * kBay};
inline constexpr vec2 kWalls{kAxes.x + kBay, kAxes.y + kBay};
inline constexpr float kFloor = 0.3f;  ///< Of the arcade, two steps above the yard.
inline constexpr float kSpringing = kFloor + 2.9f;
inline constexpr float kGallery = 5.05f;  ///< Floor of the upper storey.
inline constexpr float kUpperSpringing = kGallery + 2.0f;
inline constexpr float kCeiling = 8.05f;
inline constexpr float kEaves = 8.5f;
inline constexpr float kLowerDepth = 0.6f, kUpperDepth = 0.4f;  ///< Of the walls over the arches.

struct Side {
  float degrees;   ///< Turn of the side's frame about y.
  float distance;  ///< From the centre to the line of columns.
  int bays;

  float left() const { return -0.5f * kBay * float(bays); }
  /// World from a frame at that place of the side.
  mat4x3 at(float x, float y, float z) const {
    const mat4x3 turn = turnedAndMoved(degrees, vec3(0.0f));
    return turnedAndMoved(degrees, turn * vec4(x, y, z - distance, 0.0f));
  }
};

/// Far end, right, near end, left, as the camera "yard" sees them.
inline constexpr std::array<Side, 4> kSides{Side{0, kAxes.y, 3}, Side{-90, kAxes.x, 7}, Side{180, kAxes.y, 3},
                                            Side{90, kAxes.x, 7}};

struct Materials {
  std::uint32_t limestone, plaster, ashlar, dado, ochre, paving, chequer, timber, roofTile, terracotta,
      bronze, leaves;
  std::uint32_t crimson, emerald, azure, saffron;

  std::array<std::uint32_t, 4> cloths() const { return {crimson, azure, saffron, emerald}; }
};

/// Curtains, banners, awnings, the fountain and the plants.
void addFurnishings(Scene& scene, const Materials& materials);

}  // namespace isophote::atrium

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/bounds.h"
#include "physics/light.shared.h"
#include "physics/light_view.shared.h"
#include "trace/raster.h"

#include <vector>

namespace isophote {

/// Whether all light of this source leaves one point or one direction, so that pictures from there see what
/// it lights: points without a radius, spots, directional lights.
bool hasLightViews(const Light& light);

/// Cones wider than this are seen by the faces of a cube instead of one picture, whose pixels would differ
/// too much in solid angle.
inline constexpr float kWidestSingleView = 0.6427876f;  ///< cos 50 degrees

/// Axes of a light's views: columns right, up, forward. `turn` in [0, 1)^3: points are turned to a uniformly
/// distributed orientation, spots about their axis; directional lights keep the rectangle that holds the
/// scene.
mat3 lightViewFrame(const Light& light, vec3 turn);

/// Appends the views that together see everything that the light lights: six faces of a cube for a point, one
/// picture that just holds the cone for a spot (five faces where it is wide), one orthographic picture that
/// just holds the scene's bounds for a directional light. `side`: pixels along each side; the longer side of
/// a directional light's. `margin`: of them, how many pixels at every border lie beyond what is to be seen.
void appendLightViews(const Light& light, std::uint32_t index, const Bounds& bounds, const mat3& frame,
                      std::uint32_t side, float margin, std::vector<LightView>& views);

/// The same picture for the rasteriser, whose rows and columns are the view's.
RasterView rasterViewOf(const LightView& view);

/// The smallest `side` at which about `pixels` pixels of the views, rounded up, receive light.
std::uint32_t lightViewSide(const Light& light, const Bounds& bounds, std::uint32_t pixels);

}  // namespace isophote

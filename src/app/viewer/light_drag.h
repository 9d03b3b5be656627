// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/camera.shared.h"

#include <cstddef>
#include <optional>
#include <span>

namespace isophote::viewer {

/// A picture as the pointer meets it: what the camera sees, and how many pixels that are.
struct PictureView {
  CameraRays rays;
  vec2 size;
};

/// Where in the picture a point is seen [pixels from the upper left]; none behind the eye.
std::optional<vec2> pixelOf(const PictureView& view, vec3 point);

/// The marker that is nearest to the pointer, and at most so far from it [pixels].
std::optional<std::size_t> markerAt(std::span<const std::optional<vec2>> markers, vec2 pointer, float reach);

/// Where a point goes that is dragged parallel to the picture's plane: what was beneath the pointer stays
/// beneath it.
vec3 draggedInPlane(const PictureView& view, vec3 point, vec2 from, vec2 to);

/// Where it goes along an axis (unit): as far as the pointer goes along the axis as it is seen. Stays where
/// the axis is seen end on.
vec3 draggedAlong(const PictureView& view, vec3 point, vec3 axis, vec2 from, vec2 to);

/// A direction after a pointer's motion [pixels]: turned about the view's upright and its right, half a turn
/// over the picture's height.
vec3 turnedDirection(const PictureView& view, vec3 direction, vec2 from, vec2 to);

}  // namespace isophote::viewer

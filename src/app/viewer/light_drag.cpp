// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/light_drag.h"

#include <algorithm>
#include <cmath>

namespace isophote::viewer {

namespace {

/// Depth along the view, from which a pinhole's picture shrinks; 1 everywhere for parallel rays.
float spread(const CameraRays& rays, vec3 point) {
  return rays.orthographic > 0.0f ? 1.0f : dot(point - rays.eye, rays.forward);
}

vec3 rotated(vec3 v, vec3 axis, float radians) {
  const float c = std::cos(radians), s = std::sin(radians);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0f - c));
}

}  // namespace

std::optional<vec2> pixelOf(const PictureView& view, vec3 point) {
  const CameraRays& rays = view.rays;
  const vec3 d = point - rays.eye;
  const float depth = dot(d, rays.forward);
  if (!(depth > 0.0f)) return std::nullopt;
  const float scale = 1.0f / spread(rays, point);
  const vec2 p(dot(d, rays.right) / dot(rays.right, rays.right) * scale,
               dot(d, rays.up) / dot(rays.up, rays.up) * scale);
  return vec2(0.5f * (p.x + 1.0f) * view.size.x, 0.5f * (1.0f - p.y) * view.size.y);
}

std::optional<std::size_t> markerAt(std::span<const std::optional<vec2>> markers, vec2 pointer, float reach) {
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!markers[i]) continue;
    const float distance = length(*markers[i] - pointer);
    if (distance > reach) continue;
    reach = distance;
    nearest = i;
  }
  return nearest;
}

vec3 draggedInPlane(const PictureView& view, vec3 point, vec2 from, vec2 to) {
  const vec2 steps =
      (imagePlaneFromPixel(to, view.size) - imagePlaneFromPixel(from, view.size)) * spread(view.rays, point);
  return point + view.rays.right * steps.x + view.rays.up * steps.y;
}

vec3 draggedAlong(const PictureView& view, vec3 point, vec3 axis, vec2 from, vec2 to) {
  // How the point's pixel moves with a small step along the axis.
  const float step = 1e-3f * std::max(std::abs(dot(point - view.rays.eye, view.rays.forward)), 1e-3f);
  const std::optional<vec2> here = pixelOf(view, point), there = pixelOf(view, point + axis * step);
  if (!here || !there) return point;
  const vec2 pixels = (*there - *here) / step;
  const float squared = dot(pixels, pixels);
  // Seen almost end on, a pixel would stand for more than the whole depth.
  const vec2 across = view.size / spread(view.rays, point);
  if (!(squared > 1e-4f * dot(across, across))) return point;
  return point + axis * (dot(to - from, pixels) / squared);
}

vec3 turnedDirection(const PictureView& view, vec3 direction, vec2 from, vec2 to) {
  const vec2 radians = (to - from) * (kPi / std::max(view.size.y, 1.0f));
  const vec3 up = normalize(view.rays.up), right = normalize(view.rays.right);
  return normalize(rotated(rotated(direction, right, radians.y), up, radians.x));
}

}  // namespace isophote::viewer

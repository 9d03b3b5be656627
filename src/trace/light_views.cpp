// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/light_views.h"

#include "math/sampling.shared.h"
#include "physics/emission.shared.h"

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

/// Uniformly distributed rotation (Shoemake 1992: a uniform unit quaternion).
mat3 uniformRotation(vec3 u) {
  const float a = 2.0f * kPi * u.y, b = 2.0f * kPi * u.z;
  const float x = std::sqrt(1.0f - u.x) * std::sin(a), y = std::sqrt(1.0f - u.x) * std::cos(a);
  const float z = std::sqrt(u.x) * std::sin(b), w = std::sqrt(u.x) * std::cos(b);
  return {vec3(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
          vec3(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
          vec3(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y))};
}

bool needsFaces(const Light& light) {
  return light.type == kLightPoint || light.cosOuter < kWidestSingleView;
}

float tangentOf(float cosine) { return std::sqrt(1.0f - cosine * cosine) / cosine; }

/// Part of a cube's pixels that a cone around the middle of one face fills, by its solid angle.
float partOfCube(const Light& light) {
  return light.type == kLightPoint ? 1.0f : std::max(0.5f * (1.0f - light.cosOuter), 1e-3f);
}

}  // namespace

bool hasLightViews(const Light& light) {
  return light.type == kLightSpot || light.type == kLightDirectional ||
         (light.type == kLightPoint && !(light.radius > 0.0f));
}

mat3 lightViewFrame(const Light& light, vec3 turn) {
  if (light.type == kLightPoint) return uniformRotation(turn);
  const mat3 basis = basisAround(light.direction);
  if (light.type == kLightDirectional) return basis;
  const float angle = 2.0f * kPi * turn.x;
  const vec3 right = basis[0] * std::cos(angle) + basis[1] * std::sin(angle);
  return {right, cross(light.direction, right), light.direction};
}

void appendLightViews(const Light& light, std::uint32_t index, const Bounds& bounds, const mat3& frame,
                      std::uint32_t side, float margin, std::vector<LightView>& views) {
  LightView view{};
  view.light = index;
  view.origin = light.position;
  view.width = view.height = side;
  const auto widened = [&](float half, std::uint32_t pixels) {
    return half * float(pixels) / (float(pixels) - 2.0f * margin);
  };
  const auto push = [&](vec3 right, vec3 up, vec3 forward) {
    view.right = right;
    view.up = up;
    view.forward = forward;
    views.push_back(view);
  };
  if (light.type == kLightDirectional) {
    const vec3 extents = projectedHalfExtents(light.direction, 0.5f * bounds.size());
    const float longer = std::max(extents.x, extents.y);
    const auto pixels = [&](float extent) {
      const float exact = float(side) * extent / std::max(longer, 1e-30f);
      return std::max(std::uint32_t(std::ceil(exact)), std::uint32_t(2.0f * margin) + 1);
    };
    view.orthographic = 1.0f;
    view.width = pixels(extents.x);
    view.height = pixels(extents.y);
    view.halfWidth = widened(std::max(extents.x, 1e-6f), view.width);
    view.halfHeight = widened(std::max(extents.y, 1e-6f), view.height);
    view.origin = bounds.centre() - frame[2] * (extents.z * 1.001f + 1e-3f);
    push(frame[0], frame[1], frame[2]);
  } else if (needsFaces(light)) {
    view.halfWidth = view.halfHeight = widened(1.0f, side);
    for (int axis = 2; axis >= 0; --axis) {
      const vec3 right = frame[(axis + 1) % 3], up = frame[(axis + 2) % 3];
      push(right, up, frame[axis]);
      if (axis < 2 || light.type == kLightPoint) push(right, up, -frame[axis]);
    }
  } else {
    view.halfWidth = view.halfHeight = widened(tangentOf(light.cosOuter), side);
    push(frame[0], frame[1], frame[2]);
  }
}

RasterView rasterViewOf(const LightView& view) {
  CameraRays camera{};
  camera.eye = view.origin;
  camera.orthographic = view.orthographic;
  camera.forward = view.forward;
  camera.right = view.right * view.halfWidth;
  // The rasteriser's rows run downwards.
  camera.up = view.up * -view.halfHeight;
  return {camera, int(view.width), int(view.height), view.subpixel};
}

std::uint32_t lightViewSide(const Light& light, const Bounds& bounds, std::uint32_t pixels) {
  const double n = std::max(pixels, 1u);
  if (light.type == kLightDirectional) {
    const vec3 extents = max(projectedHalfExtents(light.direction, 0.5f * bounds.size()), vec3(1e-6f));
    const double stretch = double(std::max(extents.x, extents.y)) / double(std::min(extents.x, extents.y));
    return std::uint32_t(std::ceil(std::sqrt(n * std::min(stretch, n))));
  }
  // Of fewer pixels than 16, a spot's cone might miss all centres.
  if (needsFaces(light)) {
    const double side = std::ceil(std::sqrt(n / (6.0 * double(partOfCube(light)))));
    return std::max(std::uint32_t(side), light.type == kLightPoint ? 1u : 4u);
  }
  return std::max(std::uint32_t(std::ceil(std::sqrt(n * 4.0 / double(kPi)))), 4u);
}

}  // namespace isophote

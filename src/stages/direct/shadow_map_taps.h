// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Two things keep surfaces from shadowing themselves. Around the point a map is compared not with the point's
// depth but with that of its tangent plane, as far as this comes nearer to the light: a flat surface then
// never lies in its own shadow, at any slope. What is left, curved surfaces and inner corners, is met by
// moving the point off its surface by a part of a texel, the more the more obliquely it is lit: shadows stay
// within a texel of what throws them.
#pragma once

#include "stages/direct/shadow_maps.h"

namespace isophote::direct {

/// For rounding, where a surface faces the light [texels].
inline constexpr float kFacingBias = 0.05f;
/// Beyond this slope the tangent plane no longer counts [texels of depth a texel aside].
inline constexpr float kSteepest = 32.0f;

/// Weight of each of filter + 1 taps of a box of that width whose lower end lies `fraction` into the first.
SHARED_FN float tapWeight(std::uint32_t tap, std::uint32_t filter, float fraction) {
  const float whole = tap == 0 ? 1.0f - fraction : tap == filter ? fraction : 1.0f;
  return whole / float(filter);
}

SHARED_FN float depthIn(const LightView& view, vec3 position) {
  return dot(position - view.origin, view.forward);
}

/// What the taps around a point have in common.
struct Place {
  float depth;       ///< Of the point; not positive behind the view.
  float lowX, lowY;  ///< Lower end of the filter's box, from texels' centres on [texels].
  float depthMoved;  ///< Of the point moved off its surface.
  float nearest;     ///< Least depth that the tangent plane may have.
  /// The tangent plane's depth over the view's plane: height / (facing + rise . plane), for perspective
  /// views; for orthographic ones (height - rise . plane) / facing.
  float height, facing;
  vec2 rise;
};

/// `reach`: how far from the point taps look [texels], 1 at least.
SHARED_FN Place placeOf(const LightView& view, const ShadowMapOptions& options, vec3 position, vec3 ng,
                        float reach = 1.0f) {
  Place p;
  // How much a texel covers here, and the point moved off its surface by a part of that.
  const bool parallel = view.orthographic > 0.5f;
  const vec3 toPoint = position - view.origin;
  p.depth = dot(toPoint, view.forward);
  const float perDepth = parallel ? 1.0f : p.depth;
  const vec2 texel =
      vec2(2.0f * view.halfWidth / float(view.width), 2.0f * view.halfHeight / float(view.height));
  const float footprint = max(texel.x, texel.y) * perDepth;
  const vec3 towards = toPoint / length(toPoint);
  const vec3 along(parallel ? view.forward.x : +towards.x, parallel ? view.forward.y : +towards.y,
                   parallel ? view.forward.z : +towards.z);
  const float cosine = dot(along, ng);
  const float sine = sqrt(max(1.0f - cosine * cosine, 0.0f));
  const vec3 moved = position + ng * (footprint * (kFacingBias + options.bias * sine));
  const vec3 at = lightViewProject(view, moved);
  const float half = 0.5f * float(options.filter);
  p.lowX = at.x - half - 0.5f;
  p.lowY = at.y - half - 0.5f;
  p.depthMoved = at.z;
  p.nearest = at.z - kSteepest * reach * footprint;
  p.height = dot(moved - view.origin, ng);
  p.facing = dot(view.forward, ng);
  p.rise = vec2(dot(view.right, ng), dot(view.up, ng));
  return p;
}

/// Of what is not even a number, the first: lanes that lie elsewhere look something up, too.
SHARED_FN float texelWithin(float texel, std::uint32_t count) {
  return texel > 0.0f ? min(texel, float(count - 1)) : 0.0f;
}

/// A tap: its texel, and what that must not be less than where the light arrives.
struct Tap {
  int texel;
  float depth;
};

/// Of the texel with that lower corner, as whole numbers.
SHARED_FN Tap tapAtTexel(const LightView& view, const Place& p, float wholeX, float wholeY) {
  const float x = texelWithin(wholeX, view.width);
  const float y = texelWithin(wholeY, view.height);
  const float slope = dot(p.rise, lightViewPlane(view, vec2(x + 0.5f, y + 0.5f)));
  const bool parallel = view.orthographic > 0.5f;
  const float over = parallel ? p.height - slope : +p.height;
  const float under = parallel ? +p.facing : p.facing + slope;
  const float plane = over / under;
  const float least = plane > 0.0f ? min(plane, p.depthMoved) : +p.depthMoved;
  return {int(y) * int(view.width) + int(x), max(least, p.nearest)};
}

SHARED_FN Tap tapAt(const LightView& view, const Place& p, std::uint32_t tapX, std::uint32_t tapY) {
  return tapAtTexel(view, p, floor(p.lowX) + float(tapX), floor(p.lowY) + float(tapY));
}

}  // namespace isophote::direct

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Percentage-closer soft shadows (Fernando 2005) on a depth map, 64 points at a time.
#pragma once

#include "stages/direct/shadow_map_taps.h"
#include "stages/direct/soft_light.shared.h"

namespace isophote::direct {

/// Which of a light's views each lane lies in.
using ViewOfLane = Lanes<std::uint32_t, kTileLanes>;

/// How far aside, in the picture, a light's edge throws what lies at that depth onto a point [texels].
SHARED_FN float softTexels(const LightView& view, float size, float blocker, float depth) {
  const float texel = 2.0f * view.halfWidth / float(view.width);
  const float aside =
      view.orthographic > 0.5f ? depth - blocker : 1.0f / max(blocker, 1e-6f) - 1.0f / max(depth, 1e-6f);
  return size * max(aside, 0.0f) / texel;
}

/// Places of the lanes of a tile, and how their discs lie in the picture.
struct SoftPlaces {
  FloatLanes depth, x, y, depthMoved, nearest, height, facing, riseX, riseY;
  FloatLanes xU, yU, xV, yV;  ///< Of one texel along the disc's axes.
  FloatLanes reach;           ///< [texels]

  SHARED_FN Tap tapAt(const LightView& view, int i, float u, float v) const {
    const Place p{depth[i],   0.0f,      0.0f,      depthMoved[i],
                  nearest[i], height[i], facing[i], vec2(riseX[i], riseY[i])};
    return tapAtTexel(view, p, floor(x[i] + u * xU[i] + v * xV[i]), floor(y[i] + u * yU[i] + v * yV[i]));
  }
};

/// The light's disc faces the point, so that away from the picture's middle its image is stretched outwards.
SHARED_FN void placeLanes(const LightView& view, const ShadowMapOptions& options, float nearest, float margin,
                          const SoftLookUp& soft, const ViewTile& tile, SoftPlaces& __restrict out) {
  const bool parallel = view.orthographic > 0.5f;
  for (int i = 0; i < kTileLanes; ++i) {
    const vec3 position = positionOf(tile, i);
    const float depth = depthIn(view, position);
    const float reach =
        clamp(softTexels(view, soft.size, nearest, depth), 0.5f * float(options.filter), margin);
    const Place p = placeOf(view, options, position, ngOf(tile, i), max(reach, 1.0f));
    const float half = 0.5f * float(options.filter) + 0.5f;
    const vec2 at(p.lowX + half, p.lowY + half);
    const vec2 plane = lightViewPlane(view, at);
    const float off2 = dot(plane, plane);
    const float off = sqrt(off2);
    const bool aside = off > 1e-6f && !parallel;
    const float outX = aside ? plane.x / off : 1.0f, outY = aside ? plane.y / off : 0.0f;
    const float stretch = parallel ? 1.0f : sqrt(1.0f + off2);
    // The turned disc: u along the way outwards, which is stretched, v across it.
    const float s = soft.turnSine[i], c = soft.turnCosine[i];
    out.xU[i] = c * stretch * outX - s * outY;
    out.yU[i] = c * stretch * outY + s * outX;
    out.xV[i] = -s * stretch * outX - c * outY;
    out.yV[i] = -s * stretch * outY + c * outX;
    out.depth[i] = p.depth;
    out.x[i] = at.x;
    out.y[i] = at.y;
    out.depthMoved[i] = p.depthMoved;
    out.nearest[i] = p.nearest;
    out.height[i] = p.height;
    out.facing[i] = p.facing;
    out.riseX[i] = p.rise.x;
    out.riseY[i] = p.rise.y;
    out.reach[i] = reach;
  }
}

/// Sets the lanes that lie in the view of that number.
SHARED_FN void lookUpSoftBody(const LightView& lightView, const ShadowMapOptions& options,
                              const float* __restrict depths, float nearest, float margin,
                              const SoftLookUp& soft, const ViewTile& tile, const ViewOfLane& viewOf,
                              std::uint32_t number, FloatLanes& __restrict out,
                              FloatLanes& __restrict penumbra) {
  const LightView view = lightView;
  const float size = soft.size;
  SoftPlaces places;
  placeLanes(view, options, nearest, margin, soft, tile, places);
  FloatLanes atLeast, found, sum, weights, radius, lit;
  Lanes<int, kTileLanes> texel;
  const auto look = [&](const DiscTap& tap, const FloatLanes& reach) __attribute__((always_inline)) {
    for (int i = 0; i < kTileLanes; ++i) {
      const Tap t = places.tapAt(view, i, tap.x * reach[i], tap.y * reach[i]);
      texel[i] = t.texel;
      atLeast[i] = t.depth;
    }
    for (int i = 0; i < kTileLanes; ++i) found[i] = depths[texel[i]];
  };
  for (const DiscTap& tap : soft.search) {
    look(tap, places.reach);
    for (int i = 0; i < kTileLanes; ++i) {
      const float felt = softTexels(view, size, found[i], places.depth[i]) + 1.0f;
      const float blocks = found[i] < atLeast[i] && felt >= tap.radius * places.reach[i] ? 1.0f : 0.0f;
      sum[i] += blocks > 0.5f ? +found[i] : 0.0f;
      weights[i] += blocks;
    }
  }
  float any = 0.0f;
  for (int i = 0; i < kTileLanes; ++i) any += viewOf[i] == number ? +weights[i] : 0.0f;
  const float least = 0.5f * float(options.filter);
  for (int i = 0; i < kTileLanes; ++i) {
    const float mean = weights[i] > 0.5f ? sum[i] / max(weights[i], 1.0f) : +places.depth[i];
    radius[i] = clamp(softTexels(view, size, mean, places.depth[i]), least, max(margin, least));
  }
  for (const DiscTap& tap : soft.blur) {
    if (any == 0.0f) {
      // Nothing lies in the way of any lane.
      for (int i = 0; i < kTileLanes; ++i) lit[i] = float(soft.blur.size());
      break;
    }
    look(tap, radius);
    for (int i = 0; i < kTileLanes; ++i) lit[i] += found[i] >= atLeast[i] ? 1.0f : 0.0f;
  }
  const float perTap = 1.0f / float(soft.blur.size());
  const float texelWidth = 2.0f * view.halfWidth / float(view.width);
  for (int i = 0; i < kTileLanes; ++i) {
    const float scale = view.orthographic > 0.5f ? +texelWidth : texelWidth * places.depth[i];
    const bool here = viewOf[i] == number;
    const float visible = places.depth[i] > 0.0f ? lit[i] * perTap : 1.0f;
    const float wide = weights[i] > 0.5f ? radius[i] * scale : 0.0f;
    out[i] = here ? +visible : +out[i];
    penumbra[i] = here ? +wide : +penumbra[i];
  }
}

}  // namespace isophote::direct

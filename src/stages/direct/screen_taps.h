// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The loops of image space gathering: every lane of a tile looks at other view samples of the picture, at
// places on its own tangent plane.
#pragma once

#include "math/lanes.h"
#include "stages/direct/disc_taps.h"
#include "stages/direct/shadow_maps.h"
#include "stages/direct/soft_light.shared.h"
#include "stages/gbuffer/view_samples.h"

#include <cstdint>
#include <span>

namespace isophote::direct {

/// Instead of a distance to what throws a shadow: nothing does, or the light does not shine there at all.
inline constexpr float kLit = 0.0f, kUnlit = -1.0f;

/// What the eye sees, and the hard shadow of one light in it: a number a pixel, in the order of the tiles.
struct Screen {
  const float* depth;           ///< Along the camera's axis [m].
  const std::uint32_t* normal;  ///< packNormal10, geometric.
  const float* occluder;  ///< Distance to what is between the light and the surface [m], or kLit, kUnlit.
  int width, height, tilesX;
  vec2 subpixel;  ///< Where in each pixel its sample lies.
  vec3 eye, forward;
  vec3 right, up;  ///< Half the picture at distance 1; in metres where the camera is orthographic.
  float orthographic;
};

/// Of each lane: where points of its tangent plane lie in the picture, and how far others lie off that plane.
/// Homogeneous pixel coordinates (x, y over w) are linear in the point.
struct TapLanes {
  FloatLanes x, y, w;     ///< Of the lane's own point.
  FloatLanes xU, yU, wU;  ///< Of a metre along the first axis of the disc, and along the second.
  FloatLanes xV, yV, wV;
  FloatLanes distance;               ///< Of the eye from the tangent plane.
  FloatLanes along;                  ///< What a metre of depth adds to it,
  FloatLanes aside, asideX, asideY;  ///< and what depth times this, which is linear in the pixel, does.
  FloatLanes normalX, normalY, normalZ;
};

/// A light without extent as each lane sees it.
struct LightAim {
  FloatLanes wiX, wiY, wiZ, distance;
  Vec3Lanes<kTileLanes> origin;  ///< Of a ray to it.
  std::uint64_t lit = 0;         ///< Lanes that face it, and on which it shines.
};

SHARED_FN vec3 homogeneousPixel(const Screen& s, vec3 v, float one) {
  const vec3 right = s.right / dot(s.right, s.right), up = s.up / dot(s.up, s.up);
  const float w = s.orthographic > 0.5f ? one : dot(v, s.forward);
  return vec3((dot(v, right) + w) * 0.5f * float(s.width), (w - dot(v, up)) * 0.5f * float(s.height), w);
}

/// `turn`: by how much the disc is turned at each lane, its sine and cosine.
SHARED_FN void setUpTapsBody(const Screen& screen, const ViewTile& tile, const LightAim& aim,
                             const FloatLanes& turnSine, const FloatLanes& turnCosine,
                             TapLanes& __restrict out) {
  const Screen s = screen;
  const vec2 perPixel(2.0f / float(s.width), -2.0f / float(s.height));
  const vec2 first(s.subpixel.x * perPixel.x - 1.0f, s.subpixel.y * perPixel.y + 1.0f);
  for (int i = 0; i < kTileLanes; ++i) {
    const vec3 n = ngOf(tile, i);
    const vec3 fromEye = positionOf(tile, i) - s.eye;
    const vec3 wi(aim.wiX[i], aim.wiY[i], aim.wiZ[i]);
    const mat3 basis = basisAround(wi);
    const vec3 axisU = shearedAxis(basis[0] * turnCosine[i] + basis[1] * turnSine[i], wi, n);
    const vec3 axisV = shearedAxis(basis[1] * turnCosine[i] - basis[0] * turnSine[i], wi, n);
    const vec3 p = homogeneousPixel(s, fromEye, 1.0f);
    const vec3 u = homogeneousPixel(s, axisU, 0.0f), v = homogeneousPixel(s, axisV, 0.0f);
    out.x[i] = p.x;
    out.y[i] = p.y;
    out.w[i] = p.z;
    out.xU[i] = u.x;
    out.yU[i] = u.y;
    out.wU[i] = u.z;
    out.xV[i] = v.x;
    out.yV[i] = v.y;
    out.wV[i] = v.z;
    const float asideRight = dot(s.right, n), asideUp = dot(s.up, n);
    out.distance[i] = -dot(fromEye, n);
    out.along[i] = dot(s.forward, n);
    out.aside[i] = asideRight * first.x + asideUp * first.y;
    out.asideX[i] = asideRight * perPixel.x;
    out.asideY[i] = asideUp * perPixel.y;
    out.normalX[i] = n.x;
    out.normalY[i] = n.y;
    out.normalZ[i] = n.z;
  }
}

/// The pixel that shows a place, as whole numbers, and where the picture keeps it.
struct TapPixel {
  float x, y;
  float inside;  ///< 1 or 0.
  int index;
};

SHARED_FN TapPixel pixelAt(const Screen& s, float x, float y, float w) {
  const float perW = 1.0f / max(w, 1e-20f);
  const float px = floor(x * perW - s.subpixel.x + 0.5f);
  const float py = floor(y * perW - s.subpixel.y + 0.5f);
  TapPixel p;
  const float inX = px >= 0.0f && px < float(s.width) ? 1.0f : 0.0f;
  const float inY = py >= 0.0f && py < float(s.height) ? 1.0f : 0.0f;
  p.inside = w > 0.0f ? inX * inY : 0.0f;
  p.x = p.inside > 0.5f ? px : 0.0f;
  p.y = p.inside > 0.5f ? py : 0.0f;
  const int ix = int(p.x), iy = int(p.y);
  p.index = ((iy >> 3) * s.tilesX + (ix >> 3)) * kTileLanes + ((iy & 7) << 3) + (ix & 7);
  return p;
}

/// What a tap reads, lane by lane.
struct TapReads {
  FloatLanes x, y, inside, depth, occluder;
  Lanes<int, kTileLanes> index;
  Lanes<std::uint32_t, kTileLanes> normal;
};

SHARED_FN void readTap(const Screen& s, const TapLanes& taps, const FloatLanes& radius, DiscTap tap,
                       TapReads& __restrict out) {
  for (int i = 0; i < kTileLanes; ++i) {
    const float u = tap.x * radius[i], v = tap.y * radius[i];
    const TapPixel p =
        pixelAt(s, taps.x[i] + u * taps.xU[i] + v * taps.xV[i], taps.y[i] + u * taps.yU[i] + v * taps.yV[i],
                taps.w[i] + u * taps.wU[i] + v * taps.wV[i]);
    out.x[i] = p.x;
    out.y[i] = p.y;
    out.inside[i] = p.inside;
    out.index[i] = p.index;
  }
  // On their own, with indices of type int from memory, because that is what compilers gather by.
  for (int i = 0; i < kTileLanes; ++i) out.depth[i] = s.depth[out.index[i]];
  for (int i = 0; i < kTileLanes; ++i) out.normal[i] = s.normal[out.index[i]];
  for (int i = 0; i < kTileLanes; ++i) out.occluder[i] = s.occluder[out.index[i]];
}

/// Weight of what lane i's tap has read; perMetre: 1 / distance from the tangent plane that counts no more.
SHARED_FN float weightOfTap(const Screen& s, const TapLanes& taps, const TapReads& read, int i,
                            float perMetre) {
  const float depth = read.depth[i];
  const float w = s.orthographic > 0.5f ? 1.0f : +depth;
  const float off = taps.distance[i] + depth * taps.along[i] +
                    w * (taps.aside[i] + read.x[i] * taps.asideX[i] + read.y[i] * taps.asideY[i]);
  const vec3 n = unpackNormal10(read.normal[i]);
  const float alike = n.x * taps.normalX[i] + n.y * taps.normalY[i] + n.z * taps.normalZ[i];
  return read.inside[i] * softTapWeight(off, perMetre, alike);
}

/// A pixel's width on the surface, seen face on [m].
SHARED_FN float pixelWidth(const Screen& s, float w) { return 2.0f * length(s.right) / float(s.width) * w; }

/// 1 / how far off the tangent plane taps count, where they look around so far.
SHARED_FN float perMetreOf(const Screen& s, float w, float radius) {
  return 1.0f / (kSoftPlaneReach * radius + pixelWidth(s, abs(w)) + 1e-12f);
}

/// First pass: the mean distance to what throws the shadows whose penumbrae reach a lane becomes its own
/// penumbra's radius [m], 0 where none does. `reach`: of the widest penumbra that can.
SHARED_FN void searchBody(const Screen& screen, const TapLanes& taps, const LightAim& aim, float size,
                          float parallel, float reach, std::span<const DiscTap> disc, const FloatLanes& own,
                          FloatLanes& __restrict out) {
  const Screen s = screen;
  TapReads read;
  FloatLanes radius, perMetre, sum, weights;
  for (int i = 0; i < kTileLanes; ++i) {
    radius[i] = reach;
    perMetre[i] = perMetreOf(s, taps.w[i], reach);
    sum[i] = max(own[i], 0.0f);
    weights[i] = own[i] > 0.0f ? 1.0f : 0.0f;
  }
  for (const DiscTap& tap : disc) {
    readTap(s, taps, radius, tap, read);
    const float away = tap.radius * reach;
    for (int i = 0; i < kTileLanes; ++i) {
      const float occluder = read.occluder[i];
      const float felt = penumbraRadius(size, parallel, occluder, aim.distance[i]);
      const float weight = weightOfTap(s, taps, read, i, perMetre[i]);
      const float counts = occluder > 0.0f && felt >= away ? +weight : 0.0f;
      sum[i] += counts * occluder;
      weights[i] += counts;
    }
  }
  for (int i = 0; i < kTileLanes; ++i) {
    const float mean = sum[i] / max(weights[i], 1e-6f);
    const float found = penumbraRadius(size, parallel, mean, aim.distance[i]);
    out[i] = weights[i] > 1e-3f ? +found : 0.0f;
  }
}

/// Second pass: the part of the taps within a lane's penumbra that is lit.
SHARED_FN void blurBody(const Screen& screen, const TapLanes& taps, const FloatLanes& radius,
                        std::span<const DiscTap> disc, const FloatLanes& own, FloatLanes& __restrict out) {
  const Screen s = screen;
  TapReads read;
  FloatLanes perMetre, sum, weights;
  for (int i = 0; i < kTileLanes; ++i) perMetre[i] = perMetreOf(s, taps.w[i], radius[i]);
  for (const DiscTap& tap : disc) {
    readTap(s, taps, radius, tap, read);
    for (int i = 0; i < kTileLanes; ++i) {
      const float occluder = read.occluder[i];
      const float weight = weightOfTap(s, taps, read, i, perMetre[i]);
      // Not one condition in the other, which would not vectorise.
      const float counts = occluder >= 0.0f ? 1.0f : 0.0f;
      const float lit = occluder == kLit ? 1.0f : 0.0f;
      sum[i] += lit * weight;
      weights[i] += counts * weight;
    }
  }
  // Where hardly any tap lies on the surface, its own shadow stays hard.
  const float few = 0.02f * float(disc.size());
  for (int i = 0; i < kTileLanes; ++i) {
    const float blurred = sum[i] / max(weights[i], 1e-6f);
    const float hard = own[i] > 0.0f ? 0.0f : 1.0f;
    out[i] = weights[i] > few && radius[i] > 0.0f ? +blurred : +hard;
  }
}

/// Half the width of the square over which turned discs average out [pixels].
inline constexpr int kSmoothFrom = -1, kSmoothTo = 2;

/// Third pass: the mean over 4 x 4 pixels, whose discs are turned differently, as far as penumbrae are that
/// wide. `penumbra` in pixels.
SHARED_FN void smoothBody(const Screen& screen, const float* __restrict visible,
                          const float* __restrict penumbra, const TapLanes& taps, int tileX, int tileY,
                          std::size_t first, FloatLanes& __restrict out) {
  const Screen s = screen;
  FloatLanes perMetre, sum, weights, found, width;
  TapReads read;
  for (int i = 0; i < kTileLanes; ++i)
    perMetre[i] = perMetreOf(s, taps.w[i], 4.0f * pixelWidth(s, abs(taps.w[i])));
  for (int dy = kSmoothFrom; dy <= kSmoothTo; ++dy)
    for (int dx = kSmoothFrom; dx <= kSmoothTo; ++dx) {
      const float away = float(max(abs(dx), abs(dy)));
      for (int i = 0; i < kTileLanes; ++i) {
        const int x = tileX + (i & 7) + dx, y = tileY + (i >> 3) + dy;
        const bool inside = x >= 0 && x < s.width && y >= 0 && y < s.height;
        const int ix = inside ? x : 0, iy = inside ? y : 0;
        read.x[i] = float(ix);
        read.y[i] = float(iy);
        read.inside[i] = inside ? 1.0f : 0.0f;
        read.index[i] = ((iy >> 3) * s.tilesX + (ix >> 3)) * kTileLanes + ((iy & 7) << 3) + (ix & 7);
      }
      for (int i = 0; i < kTileLanes; ++i) read.depth[i] = s.depth[read.index[i]];
      for (int i = 0; i < kTileLanes; ++i) read.normal[i] = s.normal[read.index[i]];
      for (int i = 0; i < kTileLanes; ++i) read.occluder[i] = s.occluder[read.index[i]];
      for (int i = 0; i < kTileLanes; ++i) found[i] = visible[read.index[i]];
      for (int i = 0; i < kTileLanes; ++i) width[i] = penumbra[read.index[i]];
      for (int i = 0; i < kTileLanes; ++i) {
        const float wide = max(width[i], penumbra[first + std::size_t(i)]);
        const float near = clamp(wide - away, 0.0f, 1.0f);
        const float surface = weightOfTap(s, taps, read, i, perMetre[i]);
        const float weight = read.occluder[i] >= 0.0f ? near * surface : 0.0f;
        sum[i] += weight * found[i];
        weights[i] += weight;
      }
    }
  for (int i = 0; i < kTileLanes; ++i) {
    const float own = visible[first + std::size_t(i)];
    out[i] = weights[i] > 1e-3f ? sum[i] / weights[i] : +own;
  }
}

}  // namespace isophote::direct

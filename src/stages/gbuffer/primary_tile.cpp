// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/primary_tile.h"
#include "physics/shading_normal.shared.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace isophote::gbuffer {

namespace {

SHARED_FN void raysBody(const CameraRays& cameraRays, vec2 size, vec2 corner, vec2 subpixel,
                        PrimaryRays& __restrict out) {
  const CameraRays camera = cameraRays;
  for (int i = 0; i < kTileLanes; ++i) {
    const vec2 pixel = corner + vec2(float(i & (kTileSide - 1)), float(i / kTileSide));
    const vec2 p = imagePlaneFromPixel(pixel + subpixel, size);
    out.origin.set(i, cameraRayOrigin(camera, p));
    out.direction.set(i, cameraRayDirection(camera, p));
  }
}

/// What of the lanes goes into a tile: 1 or 0, and the pixels.
struct LaneMasks {
  alignas(64) std::uint32_t used[kTileLanes];
};

SHARED_FN void fillBody(const SurfaceLanes& s, const SurfaceVectors& rayDirection, const LaneMasks& masks,
                        std::uint32_t firstPixel, std::uint32_t width, ViewTile& t) {
  for (int i = 0; i < kTileLanes; ++i) {
    const bool used = masks.used[i] != 0u;
    t.positionX[i] = used ? +s.points.position.x[i] : kFarAway;
    t.positionY[i] = used ? +s.points.position.y[i] : kFarAway;
    t.positionZ[i] = used ? +s.points.position.z[i] : kFarAway;
    t.ngX[i] = s.points.ng.x[i];
    t.ngY[i] = s.points.ng.y[i];
    t.ngZ[i] = s.points.ng.z[i];
    t.nsX[i] = s.points.ns.x[i];
    t.nsY[i] = s.points.ns.y[i];
    t.nsZ[i] = s.points.ns.z[i];
  }
  for (int i = 0; i < kTileLanes; ++i) {
    const bool used = masks.used[i] != 0u;
    t.woX[i] = -rayDirection.x[i];
    t.woY[i] = -rayDirection.y[i];
    t.woZ[i] = -rayDirection.z[i];
    t.diffuseR[i] = used ? +s.diffuse.x[i] : 0.0f;
    t.diffuseG[i] = used ? +s.diffuse.y[i] : 0.0f;
    t.diffuseB[i] = used ? +s.diffuse.z[i] : 0.0f;
    const std::uint32_t pixel =
        firstPixel + std::uint32_t(i / kTileSide) * width + std::uint32_t(i & (kTileSide - 1));
    t.pixel[i] = used ? pixel : kNoPixel;
  }
}

/// viewFade() of the used lanes as their throughput.
SHARED_FN void fadeBody(const SurfaceLanes& s, const SurfaceVectors& rayDirection, const LaneMasks& masks,
                        ViewTile& t) {
  alignas(64) float fades[kTileLanes];
  float least = 1.0f;
  for (int i = 0; i < kTileLanes; ++i) {
    const float fade = viewFade(rayDirection[i], s.points.ng[i], s.points.ns[i]);
    fades[i] = masks.used[i] != 0u ? fade : 1.0f;
  }
  for (int i = 0; i < kTileLanes; ++i) least = fades[i] < least ? fades[i] : least;
  t.unitThroughput = least < 1.0f ? 0 : 1;
  if (t.unitThroughput != 0) return;
  for (float* throughput : {t.throughputR, t.throughputG, t.throughputB})
    for (int i = 0; i < kTileLanes; ++i) throughput[i] = fades[i];
}

/// Least and largest of the used lanes: a box a vector's lane first, then of all.
SHARED_FN void rangeBody(const float* values, const LaneMasks& masks, float& least, float& largest) {
  constexpr int kWays = 16;
  constexpr float kMost = std::numeric_limits<float>::max();
  float lower[kWays], upper[kWays];
  for (int i = 0; i < kWays; ++i) {
    lower[i] = kMost;
    upper[i] = -kMost;
  }
  for (int first = 0; first < kTileLanes; first += kWays)
    for (int i = 0; i < kWays; ++i) {
      const bool used = masks.used[first + i] != 0u;
      const float low = used ? values[first + i] : kMost, high = used ? values[first + i] : -kMost;
      lower[i] = low < lower[i] ? low : lower[i];
      upper[i] = high > upper[i] ? high : upper[i];
    }
  for (int width = kWays / 2; width > 0; width /= 2)
    for (int i = 0; i < width; ++i) {
      lower[i] = lower[i + width] < lower[i] ? lower[i + width] : lower[i];
      upper[i] = upper[i + width] > upper[i] ? upper[i + width] : upper[i];
    }
  least = lower[0];
  largest = upper[0];
}

/// From where they come: the tile's own numbers are on their way to memory.
SHARED_FN void boundsBody(const SurfaceVectors& position, const LaneMasks& masks, Bounds& bounds) {
  rangeBody(position.x.values, masks, bounds.lower.x, bounds.upper.x);
  rangeBody(position.y.values, masks, bounds.lower.y, bounds.upper.y);
  rangeBody(position.z.values, masks, bounds.lower.z, bounds.upper.z);
}

SHARED_FN void masksBody(std::uint64_t lanes, LaneMasks& masks) {
  for (int half = 0; half < kTileLanes; half += 32) {
    const auto bits = std::uint32_t(lanes >> half);
    for (int i = 0; i < 32; ++i) masks.used[half + i] = bits >> i & 1u;
  }
}

SHARED_FN void fillGlossyBody(const SurfaceLanes& s, const LaneMasks& masks, ViewTile& t) {
  for (int i = 0; i < kTileLanes; ++i) {
    const bool used = masks.used[i] != 0u;
    t.f0R[i] = used ? +s.f0.x[i] : 0.0f;
    t.f0G[i] = used ? +s.f0.y[i] : 0.0f;
    t.f0B[i] = used ? +s.f0.z[i] : 0.0f;
    t.f90[i] = used ? +s.f90[i] : 0.0f;
    t.alpha[i] = used ? +s.alpha[i] : 0.0f;
    t.coupling0[i] = used ? +s.coupling0[i] : 0.0f;
    t.coupling90[i] = used ? +s.coupling90[i] : 0.0f;
  }
}

ISOPHOTE_SIMD(castRays, raysBody,
              (const CameraRays& camera, vec2 size, vec2 corner, vec2 subpixel, PrimaryRays& out),
              (camera, size, corner, subpixel, out))
ISOPHOTE_SIMD(fill, fillBody,
              (const SurfaceLanes& s, const SurfaceVectors& rayDirection, const LaneMasks& masks,
               std::uint32_t firstPixel, std::uint32_t width, ViewTile& t),
              (s, rayDirection, masks, firstPixel, width, t))
ISOPHOTE_SIMD(fillGlossy, fillGlossyBody, (const SurfaceLanes& s, const LaneMasks& masks, ViewTile& t),
              (s, masks, t))
ISOPHOTE_SIMD(findBounds, boundsBody,
              (const SurfaceVectors& position, const LaneMasks& masks, Bounds& bounds),
              (position, masks, bounds))
ISOPHOTE_SIMD(makeMasks, masksBody, (std::uint64_t lanes, LaneMasks& masks), (lanes, masks))
ISOPHOTE_SIMD(fade, fadeBody,
              (const SurfaceLanes& s, const SurfaceVectors& rayDirection, const LaneMasks& masks,
               ViewTile& t),
              (s, rayDirection, masks, t))

}  // namespace

std::uint64_t lanesInside(const ViewSamples& view, TileCorner corner) {
  const int columns = std::min(kTileSide, view.width - corner.x);
  const int rows = std::min(kTileSide, view.height - corner.y);
  const std::uint64_t row = (1u << columns) - 1u;
  std::uint64_t lanes = 0;
  for (int y = 0; y < rows; ++y) lanes |= row << (y * kTileSide);
  return lanes;
}

void primaryRays(const CameraRays& camera, int width, int height, vec2 subpixel, TileCorner corner,
                 PrimaryRays& out) {
  castRaysFor(bestSimdLevel())(camera, vec2(float(width), float(height)),
                               vec2(float(corner.x), float(corner.y)), subpixel, out);
}

void fillTile(const SurfaceLanes& surfaces, const SurfaceVectors& rayDirection, std::uint64_t lanes,
              int width, TileCorner corner, ViewTile& tile) {
  const SimdLevel level = bestSimdLevel();
  LaneMasks masks;
  makeMasksFor(level)(lanes, masks);
  const auto firstPixel = std::uint32_t(corner.y) * std::uint32_t(width) + std::uint32_t(corner.x);
  fillFor(level)(surfaces, rayDirection, masks, firstPixel, std::uint32_t(width), tile);
  findBoundsFor(level)(surfaces.points.position, masks, tile.bounds);
  tile.count = std::uint32_t(std::popcount(lanes));
  fadeFor(level)(surfaces, rayDirection, masks, tile);
  tile.transmits = 0;
  tile.lambertian = surfaces.lambertian == lanes ? 1 : 0;
  if (tile.lambertian == 0) fillGlossyFor(level)(surfaces, masks, tile);
}

}  // namespace isophote::gbuffer

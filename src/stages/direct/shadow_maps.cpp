// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Two things keep surfaces from shadowing themselves. Around the point a map is compared not with the point's
// depth but with that of its tangent plane, as far as this comes nearer to the light: a flat surface then
// never lies in its own shadow, at any slope. What is left, curved surfaces and inner corners, is met by
// moving the point off its surface by a part of a texel, the more the more obliquely it is lit: shadows stay
// within a texel of what throws them.
#include "stages/direct/shadow_maps.h"

#include "base/error.h"
#include "trace/light_views.h"

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

/// For rounding, where a surface faces the light [texels].
constexpr float kFacingBias = 0.05f;
/// Beyond this slope the tangent plane no longer counts [texels of depth a texel aside].
constexpr float kSteepest = 32.0f;

/// Texels beyond what the light sees, for taps at the border.
float marginOf(const ShadowMapOptions& options) { return 0.5f * float(options.filter) + 2.0f; }

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

SHARED_FN Place placeOf(const LightView& view, const ShadowMapOptions& options, vec3 position, vec3 ng) {
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
  p.nearest = at.z - kSteepest * footprint;
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

SHARED_FN Tap tapAt(const LightView& view, const Place& p, std::uint32_t tapX, std::uint32_t tapY) {
  const float x = texelWithin(floor(p.lowX) + float(tapX), view.width);
  const float y = texelWithin(floor(p.lowY) + float(tapY), view.height);
  const float slope = dot(p.rise, lightViewPlane(view, vec2(x + 0.5f, y + 0.5f)));
  const bool parallel = view.orthographic > 0.5f;
  const float over = parallel ? p.height - slope : +p.height;
  const float under = parallel ? +p.facing : p.facing + slope;
  const float plane = over / under;
  const float least = plane > 0.0f ? min(plane, p.depthMoved) : +p.depthMoved;
  return {int(y) * int(view.width) + int(x), max(least, p.nearest)};
}

/// Which of a light's views each lane lies in.
using ViewOfLane = Lanes<std::uint32_t, kTileLanes>;

SHARED_FN void chooseViewsBody(std::span<const LightView> views, const ViewTile& tile,
                               ViewOfLane& __restrict out) {
  alignas(64) float deepest[kTileLanes];
  for (int i = 0; i < kTileLanes; ++i) {
    deepest[i] = depthIn(views[0], positionOf(tile, i));
    out[i] = 0u;
  }
  for (std::uint32_t v = 1; v < views.size(); ++v) {
    const LightView view = views[v];
    for (int i = 0; i < kTileLanes; ++i) {
      const float depth = depthIn(view, positionOf(tile, i));
      out[i] = depth > deepest[i] ? v : +out[i];
      deepest[i] = depth > deepest[i] ? depth : +deepest[i];
    }
  }
}

SHARED_FN void findLanesBody(const ViewOfLane& viewOf, std::uint32_t view, std::uint64_t& lanes) {
  lanes = bitsWhere([&](int i) __attribute__((always_inline)) { return viewOf[i] == view; });
}

/// Sets the lanes that lie in that view. Those without a surface lie somewhere, too.
SHARED_FN void lookUpBody(const LightView& lightView, const ShadowMapOptions& options,
                          const float* __restrict depths, const ViewTile& tile, const ViewOfLane& viewOf,
                          std::uint32_t number, Lanes<float, kTileLanes>& __restrict out) {
  const LightView view = lightView;
  const std::uint32_t filter = options.filter;
  Lanes<float, kTileLanes> depth, lowX, lowY, depthMoved, nearest, height, facing, riseX, riseY;
  for (int i = 0; i < kTileLanes; ++i) {
    const Place p = placeOf(view, options, positionOf(tile, i), ngOf(tile, i));
    depth[i] = p.depth;
    lowX[i] = p.lowX;
    lowY[i] = p.lowY;
    depthMoved[i] = p.depthMoved;
    nearest[i] = p.nearest;
    height[i] = p.height;
    facing[i] = p.facing;
    riseX[i] = p.rise.x;
    riseY[i] = p.rise.y;
  }
  Lanes<float, kTileLanes> lit, atLeast, found;
  Lanes<int, kTileLanes> texel;
  for (std::uint32_t y = 0; y <= filter; ++y) {
    Lanes<float, kTileLanes> inRow;
    for (std::uint32_t x = 0; x <= filter; ++x) {
      for (int i = 0; i < kTileLanes; ++i) {
        const Place p{depth[i],   lowX[i],   lowY[i],   depthMoved[i],
                      nearest[i], height[i], facing[i], vec2(riseX[i], riseY[i])};
        const Tap tap = tapAt(view, p, x, y);
        texel[i] = tap.texel;
        atLeast[i] = tap.depth;
      }
      // On its own, with indices of type int from memory, because that is what compilers gather by.
      for (int i = 0; i < kTileLanes; ++i) found[i] = depths[texel[i]];
      for (int i = 0; i < kTileLanes; ++i)
        inRow[i] += found[i] >= atLeast[i] ? tapWeight(x, filter, lowX[i] - floor(lowX[i])) : 0.0f;
    }
    for (int i = 0; i < kTileLanes; ++i) lit[i] += inRow[i] * tapWeight(y, filter, lowY[i] - floor(lowY[i]));
  }
  for (int i = 0; i < kTileLanes; ++i) {
    const float visible = depth[i] > 0.0f ? +lit[i] : 1.0f;
    out[i] = viewOf[i] == number ? visible : +out[i];
  }
}

ISOPHOTE_SIMD(chooseViews, chooseViewsBody,
              (std::span<const LightView> views, const ViewTile& tile, ViewOfLane& out), (views, tile, out))
ISOPHOTE_SIMD(findLanes, findLanesBody, (const ViewOfLane& viewOf, std::uint32_t view, std::uint64_t& lanes),
              (viewOf, view, lanes))
ISOPHOTE_SIMD(lookUp, lookUpBody,
              (const LightView& view, const ShadowMapOptions& options, const float* depths,
               const ViewTile& tile, const ViewOfLane& viewOf, std::uint32_t number,
               Lanes<float, kTileLanes>& out),
              (view, options, depths, tile, viewOf, number, out))

}  // namespace

void ShadowMaps::build(const RasterScene& raster, std::span<const std::uint8_t> shining,
                       const ShadowMapOptions& options, const Job& job) {
  const Bounds& bounds = raster.trace().scene().bounds;
  const std::span<const Light> lights = raster.trace().lights();
  options_ = options;
  views_.clear();
  mapOfLight_.assign(lights.size(), {});
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    const Light& light = lights[i];
    if ((!shining.empty() && shining[i] == 0) || !hasLightViews(light)) continue;
    mapOfLight_[i].firstView = std::uint32_t(views_.size());
    appendLightViews(light, i, bounds, lightViewFrame(light, vec3(0.0f)), options.resolution,
                     marginOf(options), views_);
    mapOfLight_[i].viewCount = std::uint32_t(views_.size()) - mapOfLight_[i].firstView;
  }
  texels_ = 0;
  for (const LightView& view : views_) texels_ += std::uint64_t(view.width) * view.height;
  if (texels_ > job.memoryBudgetBytes / sizeof(float))
    fail(ErrorKind::kResources, "direct.shadowResolution",
         "shadow maps of {} texels do not fit the memory budget of {} MiB; lower the resolution or raise the "
         "budget",
         texels_, job.memoryBudgetBytes >> 20);
  if (depths_.size() < views_.size()) depths_.resize(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    views_[v].subpixel = vec2(0.5f);
    rasteriser_.run(raster, rasterViewOf(views_[v]), {.depths = &depths_[v]}, job);
  }
}

float ShadowMaps::visibility(std::uint32_t light, vec3 position, vec3 ng) const {
  const Map map = mapOfLight_[light];
  std::size_t v = map.firstView;
  for (std::size_t other = v + 1; other < map.firstView + map.viewCount; ++other)
    if (depthIn(views_[other], position) > depthIn(views_[v], position)) v = other;
  const LightView& view = views_[v];
  const Place place = placeOf(view, options_, position, ng);
  float lit = 0;
  for (std::uint32_t j = 0; j <= options_.filter; ++j) {
    float inRow = 0;
    for (std::uint32_t i = 0; i <= options_.filter; ++i) {
      const Tap tap = tapAt(view, place, i, j);
      const float weight = tapWeight(i, options_.filter, place.lowX - floor(place.lowX));
      inRow += depths_[v][std::size_t(tap.texel)] >= tap.depth ? weight : 0.0f;
    }
    lit += inRow * tapWeight(j, options_.filter, place.lowY - floor(place.lowY));
  }
  return place.depth > 0.0f ? lit : 1.0f;
}

void ShadowMaps::visibility(std::uint32_t light, const ViewTile& tile, std::uint64_t lanes,
                            Lanes<float, kTileLanes>& out, SimdLevel level) const {
  const Map map = mapOfLight_[light];
  const std::span<const LightView> views = std::span(views_).subspan(map.firstView, map.viewCount);
  ViewOfLane viewOf;
  chooseViewsFor(level)(views, tile, viewOf);
  for (std::uint32_t v = 0; v < views.size(); ++v) {
    std::uint64_t inView = 0;
    findLanesFor(level)(viewOf, v, inView);
    if ((inView & lanes) != 0)
      lookUpFor(level)(views[v], options_, depths_[map.firstView + v].data(), tile, viewOf, v, out);
  }
}

}  // namespace isophote

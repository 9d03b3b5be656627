// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/direct/shadow_maps.h"

#include "base/error.h"
#include "stages/direct/shadow_map_soft.h"
#include "stages/direct/shadow_map_taps.h"
#include "trace/light_views.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace isophote {

using namespace direct;

namespace {

/// Texels beyond what the light sees, for taps at the border.
float marginOf(const ShadowMapOptions& options) {
  return std::max(0.5f * float(options.filter) + 2.0f, options.beyond * float(options.resolution));
}

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
ISOPHOTE_SIMD(lookUpSoft, lookUpSoftBody,
              (const LightView& view, const ShadowMapOptions& options, const float* depths, float nearest,
               float margin, const SoftLookUp& soft, const ViewTile& tile, const ViewOfLane& viewOf,
               std::uint32_t number, FloatLanes& out, FloatLanes& penumbra),
              (view, options, depths, nearest, margin, soft, tile, viewOf, number, out, penumbra))
ISOPHOTE_SIMD(lookUp, lookUpBody,
              (const LightView& view, const ShadowMapOptions& options, const float* depths,
               const ViewTile& tile, const ViewOfLane& viewOf, std::uint32_t number,
               Lanes<float, kTileLanes>& out),
              (view, options, depths, tile, viewOf, number, out))

float leastOf(const LargeVector<float>& depths) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, depths.size(), 65536), kNoDepth,
      [&](const auto& range, float least) {
        return std::min(least,
                        *std::min_element(&depths[range.begin()], &depths[range.begin()] + range.size()));
      },
      [](float a, float b) { return std::min(a, b); });
}

}  // namespace

void ShadowMaps::build(const RasterScene& raster, std::span<const Light> lights,
                       std::span<const std::uint8_t> shining, const ShadowMapOptions& options,
                       const Job& job) {
  const Bounds& bounds = raster.trace().scene().bounds;
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
  nearest_.resize(views_.size());
  if (options.beyond > 0.0f)
    for (std::size_t v = 0; v < views_.size(); ++v) nearest_[v] = leastOf(depths_[v]);
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

void ShadowMaps::softVisibility(std::uint32_t light, const SoftLookUp& soft, const ViewTile& tile,
                                std::uint64_t lanes, FloatLanes& out, FloatLanes& penumbra,
                                SimdLevel level) const {
  const Map map = mapOfLight_[light];
  const std::span<const LightView> views = std::span(views_).subspan(map.firstView, map.viewCount);
  ViewOfLane viewOf;
  chooseViewsFor(level)(views, tile, viewOf);
  for (std::uint32_t v = 0; v < views.size(); ++v) {
    std::uint64_t inView = 0;
    findLanesFor(level)(viewOf, v, inView);
    if ((inView & lanes) != 0)
      lookUpSoftFor(level)(views[v], options_, depths_[map.firstView + v].data(), nearest_[map.firstView + v],
                           marginOf(options_) - 2.0f, soft, tile, viewOf, v, out, penumbra);
  }
}

}  // namespace isophote

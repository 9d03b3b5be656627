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
float tapWeight(std::uint32_t tap, std::uint32_t filter, float fraction) {
  const float whole = tap == 0 ? 1.0f - fraction : tap == filter ? fraction : 1.0f;
  return whole / float(filter);
}

}  // namespace

void ShadowMaps::build(const RasterScene& raster, std::span<const std::uint8_t> shining,
                       const ShadowMapOptions& options, const Job& job) {
  const Scene& scene = raster.trace().scene();
  options_ = options;
  views_.clear();
  mapOfLight_.assign(scene.lights.size(), {});
  for (std::uint32_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if ((!shining.empty() && shining[i] == 0) || !hasLightViews(light)) continue;
    mapOfLight_[i].firstView = std::uint32_t(views_.size());
    appendLightViews(light, i, scene.bounds, lightViewFrame(light, vec3(0.0f)), options.resolution,
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
    if (dot(position - views_[other].origin, views_[other].forward) >
        dot(position - views_[v].origin, views_[v].forward))
      v = other;
  const LightView& view = views_[v];

  // How much a texel covers here, and the point moved off its surface by a part of that.
  const vec3 toPoint = position - view.origin;
  const float depth = dot(toPoint, view.forward);
  if (!(depth > 0.0f)) return 1.0f;
  const float perDepth = view.orthographic > 0.5f ? 1.0f : depth;
  const vec2 texel =
      vec2(2.0f * view.halfWidth / float(view.width), 2.0f * view.halfHeight / float(view.height));
  const float footprint = std::max(texel.x, texel.y) * perDepth;
  const vec3 along = view.orthographic > 0.5f ? view.forward : toPoint / length(toPoint);
  const float cosine = dot(along, ng);
  const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
  const vec3 moved = position + ng * (footprint * (kFacingBias + options_.bias * sine));

  // The tangent plane's depth over the view's plane: height / (facing + rise . plane), for perspective views;
  // for orthographic ones (height - rise . plane) / facing.
  const vec3 at = lightViewProject(view, moved);
  const float height = dot(moved - view.origin, ng);
  const float facing = dot(view.forward, ng);
  const vec2 rise(dot(view.right, ng), dot(view.up, ng));
  const float nearest = at.z - kSteepest * footprint;

  const float half = 0.5f * float(options_.filter);
  const float lowX = at.x - half - 0.5f, lowY = at.y - half - 0.5f;
  const float firstX = std::floor(lowX), firstY = std::floor(lowY);
  const float* const depths = depths_[v].data();
  float lit = 0;
  for (std::uint32_t j = 0; j <= options_.filter; ++j) {
    const float y = std::clamp(firstY + float(j), 0.0f, float(view.height - 1));
    const float* const row = depths + std::size_t(y) * view.width;
    float inRow = 0;
    for (std::uint32_t i = 0; i <= options_.filter; ++i) {
      const float x = std::clamp(firstX + float(i), 0.0f, float(view.width - 1));
      const float slope = dot(rise, lightViewPlane(view, vec2(x + 0.5f, y + 0.5f)));
      const float plane = view.orthographic > 0.5f ? (height - slope) / facing : height / (facing + slope);
      const float compared = std::max(plane > 0.0f ? std::min(plane, at.z) : at.z, nearest);
      inRow += row[std::size_t(x)] >= compared ? tapWeight(i, options_.filter, lowX - firstX) : 0.0f;
    }
    lit += inRow * tapWeight(j, options_.filter, lowY - firstY);
  }
  return lit;
}

}  // namespace isophote

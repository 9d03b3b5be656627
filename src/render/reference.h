// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "image/image.h"
#include "scene/scene.h"
#include "settings/visit.h"

namespace isophote {

struct ReferenceSettings {
  std::uint32_t width = 1280;
  std::uint32_t height = 720;
  std::uint32_t spp = 64;
  float timeSeconds = 0;
  std::uint32_t aa = 0;
  std::uint32_t bounces = 3;
  std::uint32_t mirrorDepth = 32;
  std::uint32_t seed = 0;
  bool indirectOnly = false;

  void visit(auto&& v) {
    v("width", width, {.help = "Width of the picture.", .unit = "px", .min = 1, .max = 16384});
    v("height", height, {.help = "Height of the picture.", .unit = "px", .min = 1, .max = 16384});
    v("spp", spp, {.help = "Paths a pixel.", .min = 1, .max = 16777216});
    v("timeSeconds", timeSeconds,
      {.help = "Go on for this long instead of `spp`; 0: off.", .unit = "s", .min = 0, .max = 1e6});
    v("aa", aa,
      {.help = "1: all paths through the pixel's centre, as `render --aa 1` sees it; 0: a box filter over "
               "the pixel.",
       .min = 0,
       .max = 1});
    v("bounces", bounces, {.help = "Indirect bounces, counted as `render` does.", .min = 0, .max = 64});
    v("mirrorDepth", mirrorDepth,
      {.help =
           "Largest number of mirror and glass events between the eye and the first non-specular surface.",
       .min = 0,
       .max = 64});
    v("seed", seed, {.help = "Start of all random numbers."});
    v("indirectOnly", indirectOnly, {.help = "Leave direct and emitted light out of the picture."});
  }
};

/// Unbiased path tracing of the same transport that renderCpu() estimates: the same camera, lights,
/// materials, bounce count and specular depth, by next-event estimation and BSDF sampling under multiple
/// importance sampling (Veach 1997). Layers: direct, indirect, emitted, and "variance": of each pixel's mean
/// in colour. What no path can find stays black: caustics of lights without an extent (a point light of
/// radius 0, a spot, a sun seen by a mirror); a warning says so where the scene has specular surfaces and
/// such lights.
Film renderReference(const Scene& scene, const Camera& camera, const ReferenceSettings& settings,
                     Stats& stats, const Job& job = {});

}  // namespace isophote

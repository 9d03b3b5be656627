// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/gbuffer/view_samples.h"
#include "trace/surface.h"
#include "trace/trace_scene.h"

#include <cstdint>
#include <vector>

namespace isophote::gbuffer {

/// What a primary ray met, and what all that follows from it sends straight to the eye.
struct FirstSurface {
  bool met = false;  ///< A surface.
  bool lit = false;  ///< One that can be lit: `sample` holds it.
  ViewSample sample;
  vec3 baseColour{0.0f};
  vec3 ns{0.0f};
  vec3 emitted{0.0f};  ///< Radiance that reaches the eye from emitters.
};

/// Follows eye paths from their first hit on, through mirrors, glass and blended surfaces, one pixel after
/// the other; keeps its memory from one to the next.
class EyePaths {
 public:
  struct Options {
    const TraceScene& trace;
    std::uint32_t mirrorDepth;
    std::uint32_t seed;
    std::uint32_t pass;
  };

  /// The path of `pixel` whose primary ray met `hit`. What it sees in mirrors and through glass is appended
  /// to `secondary`.
  FirstSurface follow(const Options& options, std::uint32_t pixel, const Ray& ray, const Hit& hit,
                      std::vector<ViewSample>& secondary);

 private:
  struct Path {
    Ray ray;
    vec3 throughput;
    std::uint32_t depth;    ///< Specular events so far.
    std::uint32_t layers;   ///< Blended surfaces so far.
    vec3 absorption{0.0f};  ///< Of the solid that the ray goes through [1/m].
  };
  struct Pixel;

  std::vector<Path> pending_;
};

}  // namespace isophote::gbuffer

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "stages/light_gbuffer/light_samples.h"
#include "trace/trace_scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote {

/// Looks at the scene from its point, spot and directional lights: the first surface through each pixel of a
/// cube around a point, of a picture of a spot's cone, of an orthographic picture for a directional light.
class LightGbuffer {
 public:
  struct In {
    const TraceScene& trace;
    /// How many pixels each light's views should have light in, by light; 0: none. Rounded up to whole
    /// squares.
    std::span<const std::uint32_t> pixels;
    std::uint32_t seed = 0;
    /// Every pass looks through other points of the pixels, from a cube turned (points) or a picture turned
    /// about its axis (spots) at random, so that the mean over passes converges.
    std::uint32_t pass = 0;
  };

  /// Reuses the memory of `out`. Throws Error(kResources) when the hits would not fit job.memoryBudgetBytes.
  void run(const In& in, LightSamples& out, Stats& stats, const Job& job = {});

 private:
  /// Of each block: photons that it emits, and the mean of RGB of their power.
  struct Emitted {
    std::uint32_t photons = 0;
    double power = 0;
  };
  std::vector<Emitted> emitted_;
};

}  // namespace isophote

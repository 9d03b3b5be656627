// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "stages/gbuffer/view_samples.h"

namespace isophote {

/// Puts one pass into the film: direct + indirect light times the eye path's throughput, and emitted light,
/// each weighted by `weight` (1 / number of passes). Fills the layers direct, indirect, emitted, albedo,
/// normal and depth where they are wanted.
class Composite {
 public:
  struct In {
    const ViewSamples& view;
    const Radiance& direct;
    const Radiance& indirect;
    float weight = 1;
    bool first = true;   ///< Overwrites what the film holds; later passes add to it.
    bool layers = true;  ///< Fills the layers; without them the film has none. The view has its own then.
  };

  /// Reuses the film's memory.
  void run(const In& in, Film& film, Stats& stats, const Job& job = {}) const;
};

}  // namespace isophote

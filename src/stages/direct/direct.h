// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

namespace isophote {

struct DirectSettings {
  std::uint32_t areaSamples = 4;

  void visit(auto&& v) {
    v("areaSamples", areaSamples,
      {.help = "Shadow rays a view sample sends to each light that has an area.", .min = 1, .max = 4096});
  }
};

/// Light that arrives straight from the lights, shadows traced.
class Direct {
 public:
  struct In {
    const TraceScene& trace;
    const ViewSamples& view;
    std::uint32_t seed = 0;
    std::uint32_t pass = 0;
  };

  explicit Direct(DirectSettings settings) : settings_(settings) {}
  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {}) const;

 private:
  DirectSettings settings_;
};

}  // namespace isophote

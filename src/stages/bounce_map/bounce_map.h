// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "stages/bounce_map/bounced_photons.h"
#include "stages/light_gbuffer/light_samples.h"
#include "trace/trace_scene.h"

#include <cstdint>
#include <memory>

namespace isophote {

/// The first bounce of photons where it is seen from the light (ISPM 4.2): one photon is emitted through
/// every pixel of the light's views, with the power that the light sends through that pixel's exact solid
/// angle, and scattered once at the surface there by importance sampling its BSDF. Roulette lets it go on or
/// not, as for photons that are traced from the light; what goes on is photon_trace's.
class BounceMap {
 public:
  struct In {
    const TraceScene& trace;
    const LightSamples& samples;
    std::uint32_t seed = 0;
    std::uint32_t pass = 0;  ///< As for the samples.
  };

  BounceMap();
  ~BounceMap();
  BounceMap(BounceMap&&) noexcept;
  BounceMap& operator=(BounceMap&&) noexcept;

  /// Reuses the memory of `out`. Deterministic at any thread count.
  void run(const In& in, BouncedPhotons& out, Stats& stats, const Job& job = {});

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace isophote

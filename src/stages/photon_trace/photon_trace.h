// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "settings/visit.h"
#include "stages/photon_trace/path_state.h"
#include "stages/photon_trace/photon_map.h"
#include "stages/photon_trace/traced_ray.h"
#include "trace/trace_scene.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace isophote {

struct PhotonTraceSettings {
  std::uint32_t photons = 200'000;
  std::uint32_t photonsStored = 0;

  void visit(auto&& v) {
    v("photons", photons,
      {.help = "Photon paths emitted, shared between the lights by their power.", .min = 1, .max = 4e9});
    v("photonsStored", photonsStored,
      {.help = "Emit in batches until this many photons are stored; 0: emit `photons` paths.",
       .min = 0,
       .max = 4e9});
  }
};

/// Emits photons from every light and walks each through the scene until it is absorbed, escapes or has
/// scattered `bounces` times. The first hit of a path is direct light and never stored; every later hit on a
/// surface that is not perfectly specular is (docs/conventions.md says how they are counted). Deterministic
/// at any thread count. One object serves one run at a time: it keeps the memory of the last run for the
/// next.
class PhotonTrace {
 public:
  struct In {
    const TraceScene& trace;
    std::uint32_t seed = 0;
    std::uint32_t pass = 0;     ///< Passes differ in their photons; 0 in a moving sequence.
    std::uint32_t bounces = 3;  ///< Largest number of scattering events before the last hit.
    /// Paths to emit from each light; where empty, the settings share them by the lights' power.
    std::span<const std::uint32_t> pathsOfLight = {};
    /// Photons that another stage has emitted and scattered once. They go on from there: what they hit next
    /// is stored with bounce 1. Each counts as a path emitted, and its power as emitted.
    std::span<const PathState> starts = {};
    /// Follow photon differentials and fill PhotonMap::footprints. Not with `starts`, whose differentials are
    /// not known.
    bool footprints = false;
    /// Where given, receives every ray that was traced, in the order of tracing (for benchmarks).
    std::vector<TracedRay>* rays = nullptr;
    /// Where the photons are traced in several batches: the paths of one, of each light about as many. All
    /// batches together are the paths that one alone would be, with the same powers. Not with `starts` or
    /// photonsStored.
    std::uint32_t batch = 0;
    std::uint32_t batches = 1;
  };

  explicit PhotonTrace(PhotonTraceSettings settings);
  ~PhotonTrace();
  PhotonTrace(PhotonTrace&&) noexcept;
  PhotonTrace& operator=(PhotonTrace&&) noexcept;

  /// Reuses the memory of `out`. With `photonsStored`, whole rounds of paths are emitted until so many are
  /// stored (a few per cent more, as a round's harvest is predicted from those before it), and every power is
  /// that of the number of paths emitted in the end. Throws Error(kResources) when the photons would not fit
  /// job.memoryBudgetBytes.
  void run(const In& in, PhotonMap& out, Stats& stats, const Job& job = {});

 private:
  struct Memory;
  PhotonTraceSettings settings_;
  std::unique_ptr<Memory> memory_;
};

/// A radius [m] at which a disc on a lit surface holds about `photonsPerEstimate` photons (for half of the
/// photons more, for half fewer; see automatic_radius.cpp): the default where no radius is set. 0 when no
/// surface holds two photons apart. Photons of unequal power count for as many as equal ones would have the
/// same noise.
float automaticRadius(const PhotonMap& map, float photonsPerEstimate);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "physics/photon.shared.h"
#include "stages/photon_trace/emission.h"
#include "stages/photon_trace/hit_lanes.h"
#include "stages/photon_trace/path_random.h"
#include "trace/trace_scene.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote {

/// Consecutive paths of one light that lie in one block.
struct PathRange {
  std::uint32_t light = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;  ///< first % kPathsPerBlock + count <= kPathsPerBlock
};

/// What one range of paths left behind. Powers are those of a light that emits one photon in all: to be
/// divided by the number of paths of the light.
struct RangeOutput {
  std::vector<Photon> photons;
  std::vector<std::uint64_t> hitsPerBounce;
  double powerEmitted = 0;
  double powerAbsorbed = 0;
  double powerEscaped = 0;
  double powerEnded = 0;
  std::vector<Ray> rays;  ///< Only where they are asked for.
};

/// Everything that the paths of one block share.
struct PathTracing {
  const TraceScene& trace;
  const SobolTable& sobol;
  std::uint32_t seed;
  std::uint32_t pass;
  std::uint32_t bounces;
  bool recordRays;
};

/// The working memory of one thread. The paths of a block advance together, one segment at a time, 16 rays by
/// 16, and shading follows tracing at a small distance: what it reads is asked for as soon as a hit is known
/// and arrives while further rays are traced. Arrays are indexed by slot: the paths that are still alive, in
/// the order of their rays.
class PathBlock {
  static constexpr std::uint32_t kRaysAtOnce = 16;

 public:
  /// Traces the paths of a range; fills `out`, whose memory is reused.
  void trace(const PathTracing& tracing, const PathRange& range, const Job& job, RangeOutput& out);

 private:
  void emit(const PathTracing& tracing, const BlockRandom& random, const PathRange& range, RangeOutput& out);
  void orderPaths(const BlockRandom& random, const PathRange& range);
  void record(RangeOutput& out) const;
  void traceSegment(const PathTracing& tracing, const BlockRandom& random, std::uint32_t bounce,
                    RangeOutput& out);
  void traceRays(const TraceScene& trace, std::uint32_t first, bool sixteen, std::span<Hit> hits);
  void shade(const PathTracing& tracing, const BlockRandom& random, std::uint32_t bounce, HitLanes& lanes,
             RangeOutput& out);

  std::uint32_t live_ = 0;   ///< Slots in use.
  std::uint32_t alive_ = 0;  ///< Of them, those that the next segment has so far.
  PathColumns paths_;        ///< By slot.
  /// Hits that are found, wait for their triangles twice, and wait for their texels, in turn.
  std::array<HitLanes, 4> lanes_;
  PrefetchQueue queue_;
  Lanes<float> mean_, absorbed_;  ///< Of the segment's hits, by lane.
  EmissionNumbers u_;
};

}  // namespace isophote

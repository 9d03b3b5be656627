// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "stages/photon_trace/photon_map.h"
#include "stages/photon_trace/piece_tracer.h"

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace isophote {

/// Paths that a wave takes at most: the more, the nearer are neighbours among its rays.
inline constexpr std::uint32_t kMostPathsOfWave = 1u << 18;
/// Ranges likewise.
inline constexpr std::uint32_t kMostRangesOfWave = 1u << (32 - kFirstKeyBits);

/// What a run hears of and gathers while waves advance.
struct WaveOutput {
  PhotonMap& map;            ///< Photons and sums are added to what it holds.
  std::uint64_t stored = 0;  ///< Photons of map.photons, which may be longer.
  std::vector<TracedRay>* rays = nullptr;
  /// Called from any thread: so many more paths have come to their end.
  std::function<void(std::size_t paths)> ended;
  std::uint64_t pathsToCome = 0;  ///< Of the run, that no wave has begun with.
  std::uint64_t wanted = 0;       ///< Photons that paths are emitted for as long as it takes.
};

/// Walks many paths through the scene, one segment after the other. Before each segment the rays are sorted
/// (ray_order.h), then cut into pieces that threads take. Results are put together in the order of the
/// pieces, which does not depend on the threads. Keeps its memory for the next wave.
class Wavefront {
 public:
  /// Emits the paths of all ranges, kMostPathsOfWave together at most, and walks them to their ends. Slots
  /// follow one another; at most kMostRangesOfWave.
  void emit(const PathTracing& tracing, std::span<const PathRange> ranges, const Job& job, WaveOutput& out);
  /// Walks paths, kMostPathsOfWave at most, that have been scattered once.
  void resume(const PathTracing& tracing, std::span<const PathState> starts, const Job& job, WaveOutput& out);
  /// Bytes of memory that waves of so many paths take.
  static std::uint64_t bytes(std::uint64_t paths, bool footprints);

 private:
  /// Rays order_[first .. first + count), which may leave paths and photons in as many places from `first`
  /// on.
  struct Piece {
    std::uint32_t first, count;
    const PathRange* range = nullptr;  ///< Where its paths are still to be emitted.
  };

  void appendPieces(std::uint32_t first, std::uint32_t count, const PathRange* range);
  void traceSegment(const PathTracing& tracing, std::uint32_t bounce, std::span<const PathState> paths,
                    const Job& job, WaveOutput& out);
  void walk(const PathTracing& tracing, std::uint32_t bounce, const Job& job, WaveOutput& out);
  void startWave(std::size_t paths, WaveOutput& out);
  void collect(const PathTracing& tracing, std::uint32_t bounce, const Job& job, WaveOutput& out);
  std::uint64_t foreseen(const PathTracing& tracing, std::uint32_t bounce, std::uint64_t stored,
                         const WaveOutput& out) const;
  bool orderSurvivors();

  RaySort sort_;
  LargeVector<KeyedRay> order_;       ///< The rays of a segment.
  LargeVector<PathState> paths_;      ///< That these indices mean, after the first segment.
  LargeVector<KeyedRay> nextRays_;    ///< Of the next segment, with gaps between pieces.
  LargeVector<PathState> nextPaths_;  ///< Likewise.
  LargeVector<Photon> photons_;       ///< Stored on the segment, likewise.
  // Only where footprints are asked for:
  LargeVector<PathDifferential> differentials_;      ///< Of paths_.
  LargeVector<PathDifferential> nextDifferentials_;  ///< Of nextPaths_.
  LargeVector<PhotonFootprint> footprints_;          ///< Of photons_.
  std::vector<Piece> pieces_;
  std::vector<PieceResult> results_;  ///< Of the pieces; of former ones beyond them.
  std::uint64_t pathsOfWave_ = 0;     ///< That it began with,
  std::uint64_t storedBefore_ = 0;    ///< and photons that were stored before it.
  tbb::enumerable_thread_specific<std::unique_ptr<PieceTracer>> tracers_{
      [] { return std::make_unique<PieceTracer>(); }};
};

}  // namespace isophote

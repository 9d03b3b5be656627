// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "physics/photon.shared.h"
#include "stages/photon_trace/path_random.h"
#include "trace/trace_scene.h"

#include <array>
#include <cstdint>
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

/// The working memory of one thread. The paths of a block advance together, one segment at a time: all rays
/// of the segment are traced, then all hits shaded. Rays that do not wait for each other's shading keep the
/// processor busy, and random numbers are made for many paths at once. Arrays are indexed by slot: the paths
/// that are still alive, in the order of their rays.
class PathBlock {
 public:
  /// Traces the paths of a range; fills `out`, whose memory is reused.
  void trace(const PathTracing& tracing, const PathRange& range, const Job& job, RangeOutput& out);

 private:
  template <class T>
  using Slots = std::array<T, kPathsPerBlock>;

  void emit(const PathTracing& tracing, const BlockRandom& random, const PathRange& range, RangeOutput& out);
  void orderPaths(const BlockRandom& random, const PathRange& range);
  void traceRays(const TraceScene& trace, bool sixteen);
  void drawEvent(const BlockRandom& random, std::uint32_t event);

  friend struct PathShader;

  std::uint32_t live_ = 0;     ///< Slots in use.
  Slots<std::uint32_t> path_;  ///< Index within the block.
  Slots<Ray> rays_;
  Slots<Hit> hits_;
  Slots<vec3> power_;                          ///< Carried along the ray [W].
  Slots<float> density_;                       ///< Photon::pathDensity.
  alignas(64) std::array<Slots<float>, 6> u_;  ///< Random numbers of the next step.
  alignas(64) Slots<float> discX_;             ///< sampleDisc(u_[1], u_[2])
  alignas(64) Slots<float> discY_;
};

}  // namespace isophote

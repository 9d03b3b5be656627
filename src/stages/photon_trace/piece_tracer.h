// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/photon.shared.h"
#include "stages/photon_trace/differential_lanes.h"
#include "stages/photon_trace/emission.h"
#include "stages/photon_trace/hit_lanes.h"
#include "stages/photon_trace/path_random.h"
#include "stages/photon_trace/ray_order.h"
#include "stages/photon_trace/traced_ray.h"
#include "trace/trace_scene.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace isophote {

/// Consecutive paths of one light.
struct PathRange {
  std::uint32_t light = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t slot = 0;  ///< Of the first path among those of the wave.
  float share = 1;         ///< Of the light's power that each path gets.
};

/// What all paths of a run share.
struct PathTracing {
  const TraceScene& trace;
  const PathRandom& random;
  RayKeys keys;
  std::uint32_t bounces;
  bool recordRays;
  std::span<const float> photonsOfLight;  ///< Emitted by each; empty where no footprints are asked for.

  bool footprints() const { return !photonsOfLight.empty(); }
};

/// Where a piece leaves paths that go on and photons that it stores: room for as many as it has rays.
struct PieceRoom {
  PathState* paths;
  KeyedRay* rays;  ///< Of these paths, with their indices from `firstIndex` on.
  std::uint32_t firstIndex;
  Photon* photons;
  // Only where footprints are asked for.
  PathDifferential* differentials = nullptr;  ///< Of the paths.
  PhotonFootprint* footprints = nullptr;      ///< Of the photons.
};

/// What became of a piece's rays. Powers are sums of the mean of RGB [W].
struct PieceResult {
  std::uint64_t firstStored = 0;    ///< Place of its photons among those of the run,
  std::uint32_t firstSurvivor = 0;  ///< and of its survivors among those of the wave.
  std::uint32_t survivors = 0;
  std::uint32_t stored = 0;
  std::uint32_t hits = 0;
  double powerEmitted = 0;
  double powerAbsorbed = 0;
  double powerEscaped = 0;
  double powerEnded = 0;
  std::vector<TracedRay> rays;  ///< Only where they are asked for.

  void clear() {
    std::vector<TracedRay> memory = std::move(rays);
    memory.clear();
    *this = {};
    rays = std::move(memory);
  }
};

/// The working memory of one thread, which takes a piece of a segment's rays, by emit() or load(), and traces
/// and shades it, 16 rays by 16. Shading follows tracing at a small distance: what it reads is asked for as
/// soon as a hit is known and arrives while further rays are traced.
class PieceTracer {
  static constexpr std::uint32_t kRaysAtOnce = 16;

 public:
  /// Emits paths of the range, at most kRaysPerPiece: those whose slots are order[i].index.
  void emit(const PathTracing& tracing, const PathRange& range, std::span<const KeyedRay> order,
            PieceResult& result);
  /// Takes over paths[order[i].index], at most kRaysPerPiece.
  void load(std::span<const PathState> paths, std::span<const KeyedRay> order);
  /// Likewise their differentials; emit() makes them itself.
  void loadDifferentials(std::span<const PathDifferential> differentials, std::span<const KeyedRay> order);
  /// Traces the paths' rays after `bounce` scattering events, and scatters them where they hit. Adds to
  /// `result`.
  void trace(const PathTracing& tracing, std::uint32_t bounce, const PieceRoom& room, PieceResult& result);

 private:
  void record(PieceResult& result) const;
  void traceRays(const TraceScene& trace, std::uint32_t first, std::span<Hit> hits);
  void shade(const PathTracing& tracing, std::uint32_t bounce, HitLanes& lanes, const PieceRoom& room,
             PieceResult& result);
  void store(const HitLanes& lanes, std::uint32_t bounce, const PieceRoom& room, PieceResult& result) const;

  /// What is worked on where footprints are asked for.
  struct Differentials {
    std::array<PathDifferential, kRaysPerPiece> ofPaths;
    DifferentialLanes lanes;
  };
  Differentials& differentials();
  void storeFootprints(const HitLanes& lanes, const PieceRoom& room, std::uint32_t stored) const;
  void handOnDifferentials(const HitLanes& lanes, const PieceRoom& room, std::uint32_t survivors);

  std::uint32_t count_ = 0;
  bool coherent_ = false;  ///< The rays.
  PathColumns paths_;
  /// Hits that are found, wait for their triangles twice, and wait for their texels, in turn.
  std::array<HitLanes, 4> lanes_;
  PrefetchQueue queue_;
  HitColumn<float> mean_, absorbed_;  ///< Of the piece's hits, by lane.
  EmissionNumbers u_;
  std::unique_ptr<Differentials> differentials_;
};

/// Numbers of the main dimensions (path_random.h), by which the first rays of a light's paths are sorted:
/// neighbours then have similar directions (positions where those alone vary).
inline constexpr std::uint32_t kFirstKeyBits = 18;
/// Keys of the paths of the range with slots from `slot` on.
void keyFirstRays(const PathRandom& random, const PathRange& range, std::uint32_t slot,
                  std::span<KeyedRay> rays);

}  // namespace isophote

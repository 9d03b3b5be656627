// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/suite.h"
#include "render/settings.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_bvh/photon_bvh.h"
#include "stages/photon_trace/photon_map.h"
#include "trace/trace_scene.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace isophote::bench {

/// A scene of the paper's tables. Our models return other parts of the light than the paper's, so that
/// another number of photons has to be emitted for as many to be stored.
struct IgpmColumn {
  PublicScene scene;
  const char* name;  ///< The paper's.
  std::uint32_t emitted;
  std::uint32_t stored;
  float photonsAtSample;
  float smoothing;
  double framesPerSecond;         ///< By footprints.
  double nearestFramesPerSecond;  ///< By the k nearest.
  /// Of table 1, frames a second with leaves of at most 2, 4, ... 512 photons: by the volume heuristic and by
  /// the linear build. All 0 where it has no such scene.
  std::array<double, 9> leavesVolume, leavesMorton;
  /// Of table 3: semi-axes of footprints in steps of 5 cm from 0 on, the last one of all beyond 1 m.
  std::array<std::uint32_t, 21> radii;
};

const std::array<IgpmColumn, 4>& igpmColumns();

/// A column's scene, and settings with which as many photons are stored, and count at a view sample, as in
/// the paper (or as --scale asks for).
struct IgpmScene {
  const IgpmColumn* column;
  std::unique_ptr<SceneChoice> choice;  ///< `trace` refers to it, wherever this struct is moved.
  std::unique_ptr<TraceScene> trace;
  RenderSettings settings;

  const Camera& camera() const { return choice->scene.cameras.front(); }
};

/// What such a scene hands to its estimate.
struct IgpmEstimate {
  ViewSamples view;
  PhotonMap map;
  float radius;        ///< PhotonBvh::In::radius
  double surfaceArea;  ///< PhotonBvh::In::surfaceArea

  PhotonBvh::In in() const { return {view, map, radius, 1.0f, surfaceArea}; }
};
IgpmEstimate igpmEstimate(const IgpmScene& scene);

// Parts of the suite.
void benchIgpmFrames(Context& context, const IgpmScene& scene, Table& table,
                     Plot& breakdown);                                         ///< Table 2, fig. 5.
void benchIgpmLeaves(Context& context, const std::vector<IgpmScene>& scenes);  ///< Table 1.
void benchIgpmRadii(Context& context, const std::vector<IgpmScene>& scenes);   ///< Table 3.
void benchIgpmKernels(Context& context, const IgpmScene& ring);                ///< Figure 4.

}  // namespace isophote::bench

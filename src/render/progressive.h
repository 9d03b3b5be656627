// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/cpu_renderer.h"

#include <cstdint>
#include <functional>
#include <memory>

namespace isophote {

/// A picture that converges: the mean of frames, called passes, of fresh photons, subpixels and shadow rays,
/// while the radius of an estimate shrinks from pass to pass so that noise and bias both vanish (Knaus and
/// Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach", eq. 18 with alpha = 2/3: radii fall
/// as pass^(-1/6), variance as pass^(-2/3)).
///
/// The first pass is the frame that the settings describe, so that something is seen at once. Those after it
/// leave out what would not converge: they estimate at every pixel (from frame.sparsePasses on), trace their
/// shadows, and `kdtree` gathers within the radius. Their radii are frame.passRadius times as large. The same
/// seed gives the same bytes for any number of threads, broken off or not.
class ProgressiveRenderer {
 public:
  /// `trace` must outlive the renderer.
  ProgressiveRenderer(const TraceScene& trace, const RenderSettings& settings);

  /// Adds a pass. Throws Error; after kStopped what was there before holds still.
  void addPass(const Camera& camera, Stats& stats, const Job& job = {});

  /// Mean of the passes so far; its metadata are the settings.
  const Film& film() const { return mean_; }
  std::uint32_t passes() const { return passes_; }
  /// Of the first pass [m].
  float firstRadius() const { return firstRadius_; }

  /// Goes on from what another renderer of the same scene and settings had after so many passes. None: starts
  /// anew.
  void resume(Film mean, std::uint32_t passes, float firstRadius);

 private:
  const TraceScene& trace_;
  RenderSettings settings_;
  std::unique_ptr<CpuRenderer> renderer_;
  bool refining_ = false;  ///< renderer_ is of the later passes' settings.
  Film pass_, mean_;
  std::uint32_t passes_ = 0;
  float firstRadius_ = 0;
};

/// Whether the settings ask for passes.
inline bool hasPasses(const FrameSettings& frame) { return frame.passes > 1 || frame.seconds > 0.0f; }

/// Adds passes until there are as many, or as much time has gone by, as `frame` says; at least one where
/// there is none yet. Calls `afterPass` after each.
void addPasses(ProgressiveRenderer& renderer, const Camera& camera, const FrameSettings& frame, Stats& stats,
               const Job& job = {}, const std::function<void()>& afterPass = {});

/// Radius of a pass, counted from 0, as a part of that of pass 0, with a passRadius of 1.
float progressiveRadius(std::uint32_t pass);
/// The same, by the settings.
float radiusOfPass(const FrameSettings& frame, std::uint32_t pass);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "image/image.h"
#include "render/settings.h"
#include "scene/scene.h"
#include "trace/trace_scene.h"

#include <memory>

namespace isophote {

/// Renders frames of one scene with the CPU engine. Keeps the memory of its stages and buffers from one frame
/// to the next and nothing else: every frame is computed anew, so that everything may move, and a frame of
/// the same size as the one before allocates no buffer. One frame at a time; two renderers may work at once.
class CpuRenderer {
 public:
  /// `trace` must outlive the renderer.
  CpuRenderer(const TraceScene& trace, const RenderSettings& settings);
  ~CpuRenderer();
  CpuRenderer(CpuRenderer&&) noexcept;
  CpuRenderer& operator=(CpuRenderer&&) noexcept;

  /// Renders what the camera sees into `film`, which is overwritten and its memory reused. The film's
  /// metadata holds the settings ("stage.name" -> value); it names neither time, host nor threads. Throws
  /// Error; where a stop was asked for (kStopped), the film's content is undefined.
  void render(const Camera& camera, Film& film, Stats& stats, const Job& job = {});

  /// One of the passes of a picture that converges (ProgressiveRenderer): random numbers of its own, moved
  /// within the pixels.
  struct Pass {
    std::uint32_t index = 0;
    float radius = 0;  ///< Of an estimate [m]; 0: as the settings say.
  };
  /// Returns the radius that it used [m].
  float renderPass(const Camera& camera, const Pass& pass, Film& film, Stats& stats, const Job& job = {});

  const RenderSettings& settings() const;

 private:
  struct Frame;
  std::unique_ptr<Frame> frame_;
};

}  // namespace isophote

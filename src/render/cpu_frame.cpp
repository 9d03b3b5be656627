// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cpu_frame.h"

#include "render/cpu_renderer.h"
#include "render/progressive.h"

namespace isophote {

std::unique_ptr<TraceScene> buildTrace(const Scene& scene, Stats& stats, const Job& job) {
  job.report("building the ray tracing hierarchy", 0.0);
  const auto scope = stats.scope("trace.build");
  return std::make_unique<TraceScene>(scene, job);
}

Film renderCpu(const Scene& scene, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job) {
  return renderCpu(*buildTrace(scene, stats, job), camera, settings, stats, job);
}

Film renderCpu(const TraceScene& trace, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job) {
  if (hasPasses(settings.frame)) {
    ProgressiveRenderer renderer(trace, settings);
    addPasses(renderer, camera, settings.frame, stats, job);
    return renderer.film();
  }
  Film film;
  CpuRenderer(trace, settings).render(camera, film, stats, job);
  return film;
}

}  // namespace isophote

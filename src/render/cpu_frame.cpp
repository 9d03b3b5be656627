// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cpu_frame.h"

#include "render/cpu_renderer.h"

namespace isophote {

Film renderCpu(const Scene& scene, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job) {
  job.report("building the ray tracing hierarchy", 0.0);
  std::unique_ptr<TraceScene> trace;
  {
    const auto scope = stats.scope("trace.build");
    trace = std::make_unique<TraceScene>(scene, job);
  }
  return renderCpu(*trace, camera, settings, stats, job);
}

Film renderCpu(const TraceScene& trace, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job) {
  Film film;
  CpuRenderer(trace, settings).render(camera, film, stats, job);
  return film;
}

}  // namespace isophote

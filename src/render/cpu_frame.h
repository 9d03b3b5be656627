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

/// Builds the ray tracing hierarchy, and says so.
std::unique_ptr<TraceScene> buildTrace(const Scene& scene, Stats& stats, const Job& job = {});

/// Renders one picture with the CPU engine, of as many passes as the settings say (CpuRenderer renders
/// several pictures faster, ProgressiveRenderer lets one look between passes). Throws Error; on kStopped
/// nothing is returned.
Film renderCpu(const Scene& scene, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job = {});

/// The same where the hierarchy is built already, for several pictures of one scene.
Film renderCpu(const TraceScene& trace, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job = {});

}  // namespace isophote

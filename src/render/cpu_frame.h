// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "image/image.h"
#include "render/settings.h"
#include "scene/scene.h"
#include "trace/trace_scene.h"

namespace isophote {

/// Renders one picture with the CPU engine (CpuRenderer renders several faster). Throws Error; on kStopped
/// nothing is returned.
Film renderCpu(const Scene& scene, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job = {});

/// The same where the hierarchy is built already, for several pictures of one scene.
Film renderCpu(const TraceScene& trace, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job = {});

}  // namespace isophote

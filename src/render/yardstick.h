// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/camera.shared.h"
#include "trace/trace_scene.h"

#include <cstdint>

namespace isophote {

/// What frames are measured against: Embree alone on the primary rays of a picture, in coherent packets of 16
/// on all threads. Returns how many met something, so that nothing is left out.
std::uint64_t tracePrimaryRays(const TraceScene& trace, const CameraRays& camera, int width, int height);

}  // namespace isophote

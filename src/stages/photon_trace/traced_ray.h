// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trace/trace_scene.h"

#include <cstdint>

namespace isophote {

/// A ray of a photon path, recorded for benchmarks and tests.
struct TracedRay {
  Ray ray;
  std::uint32_t light;
  std::uint32_t path;
};

}  // namespace isophote

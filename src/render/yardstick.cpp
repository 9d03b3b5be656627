// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/yardstick.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>

namespace isophote {

std::uint64_t tracePrimaryRays(const TraceScene& trace, const CameraRays& camera, int width, int height) {
  const vec2 size{float(width), float(height)};
  const auto traceRows = [&](const tbb::blocked_range<int>& rows, std::uint64_t met) {
    std::array<Ray, 16> rays;
    std::array<Hit, 16> hits;
    for (int row = rows.begin(); row < rows.end(); ++row)
      for (int column = 0; column < width / 4; ++column) {
        for (int i = 0; i < 16; ++i) {
          const vec2 pixel(float(4 * column + i % 4) + 0.5f, float(4 * row + i / 4) + 0.5f);
          const vec2 p = imagePlaneFromPixel(pixel, size);
          rays[std::size_t(i)] = {cameraRayOrigin(camera, p), 0.0f, cameraRayDirection(camera, p), 1e30f};
        }
        trace.closestHits(rays, hits, true);
        met += std::uint64_t(std::ranges::count_if(hits, [](const Hit& hit) { return hit.valid(); }));
      }
    return met;
  };
  return tbb::parallel_reduce(tbb::blocked_range<int>(0, height / 4), std::uint64_t(0), traceRows,
                              std::plus<>());
}

}  // namespace isophote

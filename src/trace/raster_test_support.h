// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// How rasterised pictures are held against traced rays.
#pragma once

#include "math/rng.shared.h"
#include "trace/raster.h"
#include "trace/surface.h"

#include <array>
#include <cmath>

namespace isophote {

/// The i-th of random directions, uniform over the sphere.
inline vec3 sampleSphereDirection(std::uint32_t i) {
  const vec3 u = random3(23, i, 0);
  const float z = 2.0f * u.x - 1.0f, r = std::sqrt(1.0f - z * z);
  return vec3(r * std::cos(2.0f * kPi * u.y), r * std::sin(2.0f * kPi * u.y), z);
}

/// A picture by rasterising and the same by tracing.
struct BothWays {
  RasterView view;
  LargeVector<std::uint32_t> triangles;
  LargeVector<float> depths;
  std::vector<Hit> rastered;
  std::vector<Hit> traced;

  BothWays(const RasterScene& scene, const RasterView& v, SimdLevel level = bestSimdLevel()) : view(v) {
    Rasteriser(level).run(scene, view, {&triangles, &depths});
    rastered.resize(triangles.size());
    traced.resize(triangles.size());
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; x += 16) {
        std::array<Ray, 16> rays;
        const auto count = std::size_t(std::min(16, view.width - x));
        for (std::size_t i = 0; i < count; ++i) rays[i] = rasterRay(view, x + int(i), y);
        const std::size_t first = std::size_t(y) * std::size_t(view.width) + std::size_t(x);
        scene.hits({rays.data(), count}, {&triangles[first], count}, {&rastered[first], count});
        scene.trace().closestHits({rays.data(), count}, {&traced[first], count}, true);
      }
  }

  Ray ray(std::size_t pixel) const {
    return rasterRay(view, int(pixel % std::size_t(view.width)), int(pixel / std::size_t(view.width)));
  }
};

}  // namespace isophote

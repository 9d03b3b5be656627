// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/alpha_mask.h"
#include "trace/raster_setup.h"
#include "trace/surface.h"

#include <algorithm>
#include <cmath>

namespace isophote::raster {

/// A triangle of the scene by its id.
struct SceneTriangle {
  std::uint32_t instance;
  std::uint32_t index;
  ShadedTriangle world;

  SceneTriangle(const RasterScene& scene, std::uint32_t id)
      : instance(scene.instanceOf(id)),
        index(id - scene.instances()[instance].firstTriangle),
        world(worldTriangle(scene.trace().instance(instance), index)) {}

  void project(const Projector& projector, RasterVertex* vertices) const {
    for (int k = 0; k < 3; ++k) {
      const vec3 p = world.position[k];
      vertices[k] = raster::project(projector, p.x, p.y, p.z);
    }
  }
};

/// A triangle with an alpha mask: where its texture is at each pixel.
class MaskedTriangle {
 public:
  /// (x0, y0): pixel that isThere() counts from.
  MaskedTriangle(const RasterScene& scene, const Projector& projector, const LocalTriangle& t, int x0, int y0)
      : scene_(scene.trace().scene()),
        triangle_(scene, t.id),
        mesh_(scene_.meshes[scene_.instances[triangle_.instance].mesh]) {
    RasterVertex v[3];
    triangle_.project(projector, v);
    double largest = 0.0;
    double a[3], b[3], c[3];
    for (int k = 0; k < 3; ++k) {
      const RasterVertex &from = v[(k + 1) % 3], &to = v[(k + 2) % 3];
      const double x1 = double(from.x) - x0 * double(from.w), x2 = double(to.x) - x0 * double(to.w);
      const double y1 = double(from.y) - y0 * double(from.w), y2 = double(to.y) - y0 * double(to.w);
      a[k] = y1 * double(to.w) - double(from.w) * y2;
      b[k] = double(from.w) * x2 - x1 * double(to.w);
      c[k] = x1 * y2 - y1 * x2;
      largest = std::max({largest, std::abs(a[k]), std::abs(b[k])});
    }
    // Their ratios matter alone.
    const double scale = (t.flags & kNegativeTriangle ? -1.0 : 1.0) / std::max(largest, 1e-300);
    for (int k = 0; k < 3; ++k) {
      a_[k] = float(a[k] * scale);
      b_[k] = float(b[k] * scale);
      c_[k] = float(c[k] * scale);
    }
  }

  bool isThere(int x, int y) const {
    float weight[3];
    for (int k = 0; k < 3; ++k) weight[k] = std::max(a_[k] * float(x) + b_[k] * float(y) + c_[k], 0.0f);
    const float sum = std::max(weight[0] + weight[1] + weight[2], 1e-30f);
    const float inverse = 1.0f / sum;
    return texelIsThere(scene_, mesh_, triangle_.index, weight[1] * inverse, weight[2] * inverse);
  }

 private:
  const Scene& scene_;
  SceneTriangle triangle_;
  const Mesh& mesh_;
  float a_[3], b_[3], c_[3];
};

}  // namespace isophote::raster

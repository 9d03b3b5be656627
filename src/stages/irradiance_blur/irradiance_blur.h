// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"

#include <memory>

namespace isophote {

struct IrradianceBlurSettings {
  std::uint32_t radius = 12;
  std::uint32_t step = 3;

  void visit(auto&& v) {
    v("radius", radius,
      {.help = "Pixels from which irradiance is mixed, on each side; 0: none is.",
       .unit = "px",
       .min = 0,
       .max = 64});
    v("step", step, {.help = "Take every so manyth of these pixels.", .unit = "px", .min = 1, .max = 16});
  }
};

/// Smooths irradiance on the screen, along rows and then along columns, but not over edges: neighbours count
/// by how alike the geometric normals are and by their distance from the pixel's tangent plane. What they
/// reflect has no part in it, so textures stay sharp. Surfaces seen in mirrors and through glass have no
/// neighbours on the screen, and keep their own light.
class IrradianceBlur {
 public:
  struct In {
    const ViewSamples& view;
    const Radiance& irradiance;  ///< [W/m^2]
    SimdLevel simd = bestSimdLevel();
  };

  explicit IrradianceBlur(IrradianceBlurSettings settings);
  ~IrradianceBlur();
  IrradianceBlur(IrradianceBlur&&) noexcept;
  IrradianceBlur& operator=(IrradianceBlur&&) noexcept;

  /// Multiplies light[i], a reflectance [1/sr], by the smoothed irradiance at the samples of
  /// in.view.tiles[i]; reuses memory. Stats: stage irradiance_blur.
  void run(const In& in, Radiance& light, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  IrradianceBlurSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

#include <memory>

namespace isophote {

/// How the surfaces seen directly are found. Both find the same, but for rays that pass an edge within float
/// precision.
enum class PrimaryVisibility : std::uint32_t { kRaster, kTraced };
template <>
struct EnumNames<PrimaryVisibility> {
  static constexpr std::array names{"raster", "traced"};
};

struct GbufferSettings {
  PrimaryVisibility visibility = PrimaryVisibility::kRaster;
  std::uint32_t mirrorDepth = 32;

  void visit(auto&& v) {
    v("visibility", visibility,
      {.help = "How the surfaces that the eye sees directly are found: by rasterising, which is many times "
               "faster, or by rays. What is seen in mirrors and through glass is traced either way."});
    v("mirrorDepth", mirrorDepth,
      {.help =
           "Largest number of mirror and glass events between the eye and the first non-specular surface.",
       .min = 0,
       .max = 64});
  }
};

/// Follows one primary ray a pixel, and on through mirrors and glass, to the first non-specular surfaces.
/// A surface with both kinds of lobes gives a view sample and sends a path on.
class Gbuffer {
 public:
  struct In {
    const TraceScene& trace;
    CameraRays camera;
    int width;
    int height;
    vec2 subpixel{0.5f};  ///< Position of the primary sample in each pixel, [0, 1)^2; the centre by default.
    std::uint32_t seed = 0;  ///< Used where a path chooses between reflection and refraction.
    std::uint32_t pass = 0;
    bool surfaceLayers = false;  ///< Fill ViewSamples::albedo, normal and depth.
  };

  explicit Gbuffer(GbufferSettings settings);
  ~Gbuffer();
  Gbuffer(Gbuffer&&) noexcept;
  Gbuffer& operator=(Gbuffer&&) noexcept;

  /// Reuses the memory of `out`, and its own from one run to the next.
  void run(const In& in, ViewSamples& out, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  GbufferSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

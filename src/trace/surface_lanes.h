// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/simd.h"
#include "trace/shading_lanes.h"

#include <cstdint>
#include <memory>
#include <span>

namespace isophote {

inline constexpr int kSurfaceLanes = 64;
using SurfaceColumn = Lanes<float, kSurfaceLanes>;
using SurfaceVectors = Vec3Lanes<kSurfaceLanes>;

/// Surfaces side by side: what surfaceAt() gives at each of up to 64 hits, but for rounding, a few times as
/// fast. Only for plain ones: opaque, emitting nothing, without vertex colours. Keeps its memory.
class SurfaceLanes {
 public:
  SurfaceLanes();
  ~SurfaceLanes();
  SurfaceLanes(SurfaceLanes&&) noexcept;
  SurfaceLanes& operator=(SurfaceLanes&&) noexcept;

  /// Whether the surface of that instance is plain.
  static bool isPlain(const ShadedInstance& instance);

  /// Shades the lanes whose bits are set, which must be of plain surfaces. The others hold any finite
  /// numbers.
  void shade(const TraceScene& trace, std::span<const Hit, kSurfaceLanes> hits,
             const SurfaceVectors& rayDirection, std::uint64_t lanes, SimdLevel level = bestSimdLevel());

  PointLanes<kSurfaceLanes> points;
  SurfaceVectors baseColour;
  std::uint64_t lambertian = 0;  ///< Lanes that reflect diffusely and in no other way: `diffuse` is all.
  SurfaceVectors diffuse, f0;    ///< As Bsdf.
  SurfaceColumn f90, alpha, coupling0, coupling90;

  struct Scratch;

 private:
  void loadTriangle(const TraceScene& trace, std::span<const Hit, kSurfaceLanes> hits, int lane);

  std::uint64_t shaded_ = 0;  ///< Lanes of this call.
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

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
using SurfaceWords = Lanes<std::uint32_t, kSurfaceLanes>;
using SurfaceVectors = Vec3Lanes<kSurfaceLanes>;

/// Surfaces side by side: what surfaceAt() gives at each of up to 64 hits, but for rounding, many times as
/// fast. Only for plain ones: opaque, emitting nothing, without vertex colours. take() or meet(), then
/// shade(). Triangles are mostly many pixels wide, so that what is read of one is read once for all its
/// lanes. Keeps its memory.
class SurfaceLanes {
 public:
  SurfaceLanes();
  ~SurfaceLanes();
  SurfaceLanes(SurfaceLanes&&) noexcept;
  SurfaceLanes& operator=(SurfaceLanes&&) noexcept;

  /// Whether the surface of that instance is plain.
  static bool isPlain(const ShadedInstance& instance);

  /// Hits that rays have found.
  void take(const TraceScene& trace, std::span<const Hit, kSurfaceLanes> hits,
            SimdLevel level = bestSimdLevel());
  /// Hits of the rays with the triangles of those ids, as RasterScene::hits() gives them.
  void meet(const RasterScene& raster, const SurfaceWords& ids, const SurfaceVectors& origin,
            const SurfaceVectors& direction, SimdLevel level = bestSimdLevel());
  /// Shades the lanes of `plain`, which loses those that are mirrors or black. The other lanes hold any
  /// finite numbers.
  void shade(const SurfaceVectors& rayDirection, SimdLevel level = bestSimdLevel());

  Hit hit(int lane) const;

  std::uint64_t met = 0;    ///< Lanes that hit something,
  std::uint64_t plain = 0;  ///< and of them, those whose surface is plain.
  PointLanes<kSurfaceLanes> points;
  SurfaceVectors baseColour;
  std::uint64_t lambertian = 0;  ///< Lanes that reflect diffusely and in no other way: `diffuse` is all.
  SurfaceVectors diffuse, f0;    ///< As Bsdf.
  SurfaceColumn f90, alpha, coupling0, coupling90;

  struct Scratch;

 private:
  void begin();
  void addTriangle(const TraceScene& trace, std::uint32_t instance, std::uint32_t triangle,
                   std::uint64_t lanes, SimdLevel level);
  void addMaterial(const ShadedMaterial& material, std::uint64_t lanes);
  void bendNormals();
  void shadeGlossy(bool textureOfMetal, SimdLevel level);

  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

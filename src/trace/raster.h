// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "math/simd.h"
#include "physics/camera.shared.h"
#include "trace/raster_scene.h"

#include <memory>

namespace isophote {

/// One ray a pixel, as a camera or a light sends them. `camera` is a pinhole (cameras, spots, faces of a
/// cube) or orthographic (directional lights); its right, up and forward need not be unit or perpendicular.
struct RasterView {
  CameraRays camera;
  int width;
  int height;
  vec2 subpixel{0.5f};  ///< Where in its pixel each ray goes through, [0, 1)^2.
  /// Only what has a greater depth (see RasterTargets) is seen [m]; 0 sees all that is in front of the eye,
  /// or, orthographic, of the image plane.
  float nearest = 0.0f;
};

/// The ray of pixel (x, y), exactly the one that gbuffer would trace: x to the right, y down.
inline Ray rasterRay(const RasterView& view, int x, int y) {
  const vec2 p = imagePlaneFromPixel(vec2(float(x), float(y)) + view.subpixel,
                                     vec2(float(view.width), float(view.height)));
  return {cameraRayOrigin(view.camera, p), 0.0f, cameraRayDirection(view.camera, p), 1e30f};
}

/// The camera of one of the six faces of a cube around `centre`, to be rendered with width == height: faces
/// 0 to 5 look along +x, -x, +y, -y, +z, -z, the columns of `axes` where a turned cube is wanted. Together
/// they see every direction once.
CameraRays cubeFaceRays(vec3 centre, int face, const mat3& axes = mat3(1.0f));

/// What a run fills: width * height numbers each, row by row from the top. Either may be null.
struct RasterTargets {
  /// The triangle that the pixel's ray meets first: a RasterScene id, kNoTriangle where it meets none.
  /// RasterScene::hits() turns ids into Hits.
  LargeVector<std::uint32_t>* triangles = nullptr;
  /// How far it is along the camera's forward axis, dot(hit - eye, forward) where the axes are perpendicular
  /// [m]; kNoDepth where there is none. A pinhole ray's t is this times |forward + right p.x + up p.y|, an
  /// orthographic one's is this. Relative error about 1e-6.
  LargeVector<float>* depths = nullptr;
};

inline constexpr float kNoDepth = 1e30f;

/// Answers which triangle the ray of every pixel of a view meets first, as TraceScene::closestHit() would,
/// by rasterising: many times faster than tracing the rays. Two-sided; texels that an alpha mask cuts away
/// are not there.
///
/// Exact for the vertices as rounded to the view's plane (floats; about 1e-4 of a pixel in a picture 2000
/// wide): each pixel's centre is decided by the exact signs of edge functions, with one rule for pixels
/// exactly on an edge. Triangles that share an edge thus leave no pixel between them and none to both.
/// Triangles are never clipped, so that those through the plane of the eye are as exact as others. Of
/// triangles at the same depth the one with the smaller id is seen. The same bytes for any number of
/// threads and every SIMD level.
///
/// An object keeps its memory from run to run; one run at a time. With triangles alone or depths alone
/// a run is faster; what it fills does not depend on what else is wanted.
class Rasteriser {
 public:
  explicit Rasteriser(SimdLevel level = bestSimdLevel());
  ~Rasteriser();
  Rasteriser(const Rasteriser&) = delete;
  Rasteriser& operator=(const Rasteriser&) = delete;

  /// Runs on the calling thread's TBB arena.
  void run(const RasterScene& scene, const RasterView& view, const RasterTargets& targets,
           const Job& job = {});

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/bounds.h"
#include "trace/trace_scene.h"

#include <algorithm>
#include <span>
#include <vector>

namespace isophote {

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;
inline constexpr std::uint32_t kRasterLanes = 16;

/// Vertices of up to 16 triangles that lie close together, in the space of ShadedInstance::triangles.
struct alignas(64) RasterBlock {
  float x[3][kRasterLanes], y[3][kRasterLanes], z[3][kRasterLanes];
  std::uint32_t triangle[kRasterLanes];  ///< Index into its mesh; kNoTriangle: no triangle here.
};

/// Centres and half sizes of boxes, one array a coordinate.
struct BoxColumns {
  std::vector<float> centre[3];
  std::vector<float> half[3];
};

/// A range of blocks; instances of one mesh share it.
struct RasterMesh {
  std::uint32_t firstBlock;
  std::uint32_t blocks;
  Bounds bounds;
};

struct RasterInstance {
  std::uint32_t mesh;           ///< Index into RasterScene::meshes().
  std::uint32_t firstTriangle;  ///< Id of its triangle 0.
  bool masked;                  ///< Its material has an alpha mask.
};

/// The triangles of a TraceScene arranged for rasterising: TraceScene::raster(). Immutable: any number of
/// threads may read it. Keeps a reference to `trace`, which must outlive it. A triangle's id numbers the
/// triangles of all instances one after the other: ids are ordered by instance, then by index in the mesh.
class RasterScene {
 public:
  /// Throws Error(kResources) where the scene has 2^32 - 1 triangles or more.
  explicit RasterScene(const TraceScene& trace, const Job& job = {});

  /// Where rays meet the triangles of those ids: hits[i].valid() where triangles[i] is not kNoTriangle. The
  /// triangle is not searched for but taken as met: t, u and v are where ray i meets its plane, u and v moved
  /// into the triangle where rounding has them outside.
  void hits(std::span<const Ray> rays, std::span<const std::uint32_t> triangles, std::span<Hit> hits) const;

  const TraceScene& trace() const { return trace_; }
  const std::vector<RasterBlock>& blocks() const { return blocks_; }
  /// By block.
  const BoxColumns& boxes() const { return boxes_; }
  const std::vector<RasterMesh>& meshes() const { return meshes_; }
  /// In the order of Scene::instances.
  const std::vector<RasterInstance>& instances() const { return instances_; }

  /// Of a triangle's id. Neighbours mostly are of one instance: `guess` is any, tried first.
  std::uint32_t instanceOf(std::uint32_t id, std::uint32_t guess) const {
    const bool last = guess + 1 == firstTriangles_.size();
    const bool holds = id >= firstTriangles_[guess] && (last || id < firstTriangles_[guess + 1]);
    return holds ? guess : instanceOf(id);
  }
  std::uint32_t instanceOf(std::uint32_t id) const {
    const auto after = std::upper_bound(firstTriangles_.begin(), firstTriangles_.end(), id);
    return std::uint32_t(after - firstTriangles_.begin()) - 1;
  }

 private:
  const TraceScene& trace_;
  std::vector<RasterBlock> blocks_;
  BoxColumns boxes_;
  std::vector<RasterMesh> meshes_;
  std::vector<RasterInstance> instances_;
  std::vector<std::uint32_t> firstTriangles_;  ///< Of the instances.
};

}  // namespace isophote

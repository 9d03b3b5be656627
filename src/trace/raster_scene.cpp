// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/raster_scene.h"

#include "base/error.h"
#include "scene/alpha_mask.h"
#include "trace/raster_hit.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <map>

namespace isophote {

namespace {

/// A triangle while its mesh is divided into blocks.
struct Piece {
  vec3 centre;
  std::uint32_t triangle;
};

/// Orders the pieces so that every 16 from the first on lie close together: halves them along the longest
/// side of their box, in whole blocks.
void arrange(std::span<Piece> pieces) {
  if (pieces.size() <= kRasterLanes) return;
  Bounds bounds;
  for (const Piece& piece : pieces) bounds.extend(piece.centre);
  const vec3 size = bounds.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t blocks = (pieces.size() + kRasterLanes - 1) / kRasterLanes;
  const std::size_t half = blocks / 2 * kRasterLanes;
  std::nth_element(pieces.begin(), pieces.begin() + std::ptrdiff_t(half), pieces.end(),
                   [axis](const Piece& a, const Piece& b) {
                     return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis]
                                                             : a.triangle < b.triangle;
                   });
  const auto lower = [&] { arrange(pieces.first(half)); };
  const auto upper = [&] { arrange(pieces.subspan(half)); };
  if (pieces.size() > 4096) {
    tbb::parallel_invoke(lower, upper);
  } else {
    lower();
    upper();
  }
}

RasterBlock blockOf(const ShadedTriangle* triangles, std::span<const Piece> pieces) {
  RasterBlock block;
  for (std::uint32_t i = 0; i < kRasterLanes; ++i) {
    const bool used = i < pieces.size();
    const ShadedTriangle& t = triangles[pieces[used ? i : 0].triangle];
    block.triangle[i] = used ? pieces[i].triangle : kNoTriangle;
    for (int k = 0; k < 3; ++k) {
      block.x[k][i] = t.position[k].x;
      block.y[k][i] = t.position[k].y;
      block.z[k][i] = t.position[k].z;
    }
  }
  return block;
}

Bounds boundsOf(const RasterBlock& block) {
  Bounds bounds;
  for (int k = 0; k < 3; ++k)
    for (std::uint32_t i = 0; i < kRasterLanes; ++i)
      bounds.extend(vec3(block.x[k][i], block.y[k][i], block.z[k][i]));
  return bounds;
}

/// A mesh that is placed, once for all the instances that share its triangles.
struct PlacedMesh {
  const ShadedTriangle* triangles;
  std::uint32_t count;
};

}  // namespace

RasterScene::RasterScene(const TraceScene& trace, const Job& job) : trace_(trace) {
  const Scene& scene = trace.scene();
  std::vector<PlacedMesh> placed;
  std::map<const ShadedTriangle*, std::uint32_t> meshOf;
  std::uint64_t triangles = 0;
  std::uint32_t blocks = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    const auto count = std::uint32_t(mesh.triangles.size());
    const ShadedTriangle* first = trace.instance(std::uint32_t(i)).triangles;
    // An empty mesh may begin where another does.
    std::uint32_t index = std::uint32_t(meshes_.size());
    if (count > 0) {
      const auto [entry, isNew] = meshOf.try_emplace(first, index);
      index = entry->second;
      if (isNew) {
        meshes_.push_back({blocks, (count + kRasterLanes - 1) / kRasterLanes, {}});
        placed.push_back({first, count});
        blocks += meshes_.back().blocks;
      }
      instances_.push_back(
          {index, std::uint32_t(triangles), isMasked(scene, mesh) || isBlended(scene, mesh)});
    } else {
      meshes_.push_back({blocks, 0, {}});
      placed.push_back({first, 0});
      instances_.push_back({index, std::uint32_t(triangles), false});
    }
    firstTriangles_.push_back(std::uint32_t(triangles));
    triangles += count;
    if (triangles >= kNoTriangle)
      fail(ErrorKind::kResources, "",
           "the scene's instances have more than {} triangles in all, which is more than can be rasterised",
           kNoTriangle - 1);
  }
  job.throwIfStopped();

  constexpr std::uint64_t kBlockBytes =
      sizeof(RasterBlock) + 6 * sizeof(float) + kRasterLanes * sizeof(Piece);
  if (blocks * kBlockBytes > job.memoryBudgetBytes)
    fail(ErrorKind::kResources, "",
         "{} triangles arranged for rasterising do not fit the memory budget of {} MiB; raise the budget, or "
         "set gbuffer.visibility=traced",
         triangles, job.memoryBudgetBytes >> 20);
  blocks_.resize(blocks);
  for (int axis = 0; axis < 3; ++axis) {
    boxes_.centre[axis].resize(blocks);
    boxes_.half[axis].resize(blocks);
  }
  tbb::parallel_for(std::size_t(0), placed.size(), [&](std::size_t m) {
    std::vector<Piece> pieces(placed[m].count);
    for (std::uint32_t t = 0; t < placed[m].count; ++t) {
      const ShadedTriangle& triangle = placed[m].triangles[t];
      pieces[t] = {triangle.position[0] + triangle.position[1] + triangle.position[2], t};
    }
    arrange(pieces);
    for (std::uint32_t b = 0; b < meshes_[m].blocks; ++b) {
      const std::size_t first = std::size_t(b) * kRasterLanes;
      const std::size_t count = std::min<std::size_t>(kRasterLanes, pieces.size() - first);
      const std::uint32_t index = meshes_[m].firstBlock + b;
      blocks_[index] = blockOf(placed[m].triangles, std::span(pieces).subspan(first, count));
      const Bounds bounds = boundsOf(blocks_[index]);
      meshes_[m].bounds.extend(bounds);
      for (int axis = 0; axis < 3; ++axis) {
        boxes_.centre[axis][index] = bounds.centre()[axis];
        boxes_.half[axis][index] = bounds.upper[axis] - bounds.centre()[axis];
      }
    }
  });
  job.throwIfStopped();
}

void RasterScene::hits(std::span<const Ray> rays, std::span<const std::uint32_t> triangles,
                       std::span<Hit> hits) const {
  std::uint32_t known = kNoTriangle;
  std::uint32_t instance = 0;
  ShadedTriangle triangle;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::uint32_t id = triangles[i];
    if (id == kNoTriangle) {
      hits[i] = {};
      continue;
    }
    if (id != known) {
      instance = instanceOf(id, instance);
      triangle = worldTriangle(trace_.instance(instance), id - firstTriangles_[instance]);
      known = id;
    }
    const PlaneHit hit = planeHit(triangle.position, rays[i]);
    hits[i] = {hit.t, hit.u, hit.v, instance, id - firstTriangles_[instance]};
  }
}

}  // namespace isophote

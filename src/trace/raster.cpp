// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/raster.h"

#include "trace/raster_tile.h"

#include <tbb/parallel_for.h>

namespace isophote {

namespace {

/// At least so many blocks are set up together, in at most so many chunks: every tile reads all of them.
constexpr std::size_t kChunkBlocks = 128;
constexpr std::size_t kMostChunks = 256;

}  // namespace

CameraRays cubeFaceRays(vec3 centre, int face, const mat3& axes) {
  const int axis = face / 2;
  CameraRays rays{};
  rays.eye = centre;
  rays.forward = axes[axis] * (face % 2 == 0 ? 1.0f : -1.0f);
  rays.up = axes[axis == 1 ? 2 : 1];
  rays.right = cross(rays.forward, rays.up);
  return rays;
}

struct Rasteriser::Memory {
  SimdLevel level;
  raster::VisibleBlocks visible;
  std::vector<raster::Chunk> chunks;
};

Rasteriser::Rasteriser(SimdLevel level) : memory_(std::make_unique<Memory>()) { memory_->level = level; }
Rasteriser::~Rasteriser() = default;

void Rasteriser::run(const RasterScene& scene, const RasterView& view, const RasterTargets& targets,
                     const Job& job) {
  Memory& m = *memory_;
  const raster::Projector projector = raster::projectorOf(view);
  const std::size_t pixels = std::size_t(view.width) * std::size_t(view.height);
  if (targets.triangles) targets.triangles->resize(pixels);
  if (targets.depths) targets.depths->resize(pixels);

  raster::findVisible(scene, projector, m.level, m.visible);
  const std::span<const raster::BlockUse> blocks = m.visible.sorted;
  const std::size_t chunkBlocks = std::max(kChunkBlocks, (blocks.size() + kMostChunks - 1) / kMostChunks);
  const std::size_t chunks = (blocks.size() + chunkBlocks - 1) / chunkBlocks;
  if (m.chunks.size() < chunks) m.chunks.resize(chunks);
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t c) {
    if (job.stop.stop_requested()) return;
    const std::size_t first = c * chunkBlocks;
    raster::setUp(scene, projector, blocks.subspan(first, std::min(chunkBlocks, blocks.size() - first)),
                  m.level, m.chunks[c]);
  });
  job.throwIfStopped();

  const auto tilesX = std::uint32_t((view.width + raster::kTileWidth - 1) / raster::kTileWidth);
  const auto tilesY = std::uint32_t((view.height + raster::kTileHeight - 1) / raster::kTileHeight);
  const raster::RasteriseTileFn rasteriseTile =
      raster::rasteriseTileFor(targets.triangles != nullptr, m.level);
  tbb::parallel_for(std::uint32_t(0), tilesX * tilesY, [&](std::uint32_t tile) {
    if (job.stop.stop_requested()) return;
    rasteriseTile({scene, view, projector, std::span(m.chunks).first(chunks), tile,
                   targets.triangles ? targets.triangles->data() : nullptr,
                   targets.depths ? targets.depths->data() : nullptr});
  });
  job.throwIfStopped();
}

}  // namespace isophote

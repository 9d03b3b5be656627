// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trace/raster_setup.h"

namespace isophote::raster {

/// One tile of a view and what it is made from.
struct TileTask {
  const RasterScene& scene;
  const RasterView& view;
  const Projector& projector;
  std::span<const Chunk> chunks;
  std::uint32_t tile;
  std::uint32_t* triangles;  ///< Of the whole picture; may be null.
  float* depths;             ///< May be null.
};

using RasteriseTileFn = void (*)(const TileTask& task);
/// With ids: `triangles` is not null.
RasteriseTileFn rasteriseTileFor(bool withIds, SimdLevel level);

}  // namespace isophote::raster

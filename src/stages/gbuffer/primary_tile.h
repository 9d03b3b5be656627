// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/gbuffer/view_samples.h"
#include "trace/surface_lanes.h"

#include <cstdint>

namespace isophote::gbuffer {

/// The primary rays of one tile.
struct PrimaryRays {
  SurfaceVectors origin, direction;
  Ray operator[](int lane) const { return {origin[lane], 0.0f, direction[lane], 1e30f}; }
};

/// Upper left pixel of a primary tile.
struct TileCorner {
  int x, y;
};

inline TileCorner cornerOf(const ViewSamples& view, std::size_t tile) {
  return {int(tile % std::size_t(view.tilesX)) * kTileSide, int(tile / std::size_t(view.tilesX)) * kTileSide};
}

/// Lanes of a tile that lie in the picture.
std::uint64_t lanesInside(const ViewSamples& view, TileCorner corner);

/// The camera's rays through a tile's pixels.
void primaryRays(const CameraRays& camera, int width, int height, vec2 subpixel, TileCorner corner,
                 PrimaryRays& out);

/// Fills a tile with the surfaces of `lanes`, which `surfaces` has shaded; the other lanes become empty.
void fillTile(const SurfaceLanes& surfaces, const SurfaceVectors& rayDirection, std::uint64_t lanes,
              int width, TileCorner corner, ViewTile& tile);

}  // namespace isophote::gbuffer

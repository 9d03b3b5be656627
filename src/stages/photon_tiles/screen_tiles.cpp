// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_tiles/screen_tiles.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace isophote::photon_tiles {

void ScreenTiles::build(const ViewSamples& view) {
  eye_ = view.camera.eye;
  forward_ = view.camera.forward;
  const std::size_t columns = std::size_t(view.tilesX + kScreenTileSide - 1) / kScreenTileSide;
  const std::size_t rows = std::size_t(view.tilesY + kScreenTileSide - 1) / kScreenTileSide;
  const std::size_t primary = view.primaryTiles > 0 ? columns * rows : 0;
  const std::size_t secondary = (view.tiles.size() - view.primaryTiles + kViewTiles - 1) / kViewTiles;
  tiles_.resize(primary + secondary);
  near_.resize(primary);
  far_.resize(primary);
  slopesX_.resize(primary);
  slopesY_.resize(primary);
  columns_.resize(primary > 0 ? columns : 0);
  rows_.resize(primary > 0 ? rows : 0);
  tbb::parallel_for(std::size_t(0), primary, [&](std::size_t tile) {
    for (int i = 0; i < kViewTiles; ++i) {
      const int x = int(tile % columns) * kScreenTileSide + i % kScreenTileSide;
      const int y = int(tile / columns) * kScreenTileSide + i / kScreenTileSide;
      const bool inside = x < view.tilesX && y < view.tilesY;
      tiles_[tile][std::size_t(i)] = inside ? std::uint32_t(y * view.tilesX + x) : kNoTile;
    }
    measure(view, tile, slopesX_[tile], slopesY_[tile]);
  });
  const auto include = [](Slopes& all, const Slopes& one) {
    all.least = std::min(all.least, one.least);
    all.most = std::max(all.most, one.most);
  };
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Slopes all;
    for (std::size_t r = 0; r < rows_.size(); ++r) include(all, slopesX_[r * columns + c]);
    columns_[c] = slabOf(view.camera, view.camera.right, all);
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Slopes all;
    for (std::size_t c = 0; c < columns_.size(); ++c) include(all, slopesY_[r * columns + c]);
    rows_[r] = slabOf(view.camera, view.camera.up, all);
  }
  buildSecondary(view);
}

/// The depths of a primary tile and the slopes of its samples: how far they lie to the side, along the axis'
/// unit vector, over their depth; for parallel rays not over it.
void ScreenTiles::measure(const ViewSamples& view, std::size_t tile, Slopes& x, Slopes& y) {
  const vec3 right = normalize(view.camera.right);
  const vec3 up = normalize(view.camera.up);
  const bool parallel = view.camera.orthographic > 0.5f;
  near_[tile] = 1e30f;
  far_[tile] = -1e30f;
  x = y = {};
  for (const std::uint32_t index : tiles_[tile]) {
    if (index == kNoTile) continue;
    const ViewTile& t = view.tiles[index];
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (t.pixel[lane] == kNoPixel) continue;
      const vec3 offset = positionOf(t, lane) - eye_;
      const float depth = dot(offset, forward_);
      const float scale = parallel ? 1.0f : 1.0f / std::max(depth, 1e-12f);
      near_[tile] = std::min(near_[tile], depth);
      far_[tile] = std::max(far_[tile], depth);
      x.least = std::min(x.least, dot(offset, right) * scale);
      x.most = std::max(x.most, dot(offset, right) * scale);
      y.least = std::min(y.least, dot(offset, up) * scale);
      y.most = std::max(y.most, dot(offset, up) * scale);
    }
  }
}

ScreenTiles::Slab ScreenTiles::slabOf(const CameraRays& camera, vec3 axis, Slopes slopes) const {
  const vec3 side = normalize(axis);
  if (camera.orthographic > 0.5f) return {side, side, slopes.least, slopes.most};
  return {normalize(side - forward_ * slopes.least), normalize(side - forward_ * slopes.most), 0.0f, 0.0f};
}

void ScreenTiles::buildSecondary(const ViewSamples& view) {
  const std::size_t primary = rows_.size() * columns_.size();
  secondary_.assign(tiles_.size() - primary, {});
  blocks_.assign((secondary_.size() + kBlock - 1) / kBlock, {});
  for (std::size_t i = 0; i < secondary_.size(); ++i) {
    for (std::size_t k = 0; k < kViewTiles; ++k) {
      const std::size_t index = view.primaryTiles + i * kViewTiles + k;
      const bool exists = index < view.tiles.size();
      tiles_[primary + i][k] = exists ? std::uint32_t(index) : kNoTile;
      if (exists && view.tiles[index].count > 0) secondary_[i].extend(view.tiles[index].bounds);
    }
    if (!secondary_[i].empty()) blocks_[i / kBlock].extend(secondary_[i]);
  }
}

}  // namespace isophote::photon_tiles

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/gbuffer/view_samples.h"
#include "stages/photon_estimate/photon_sphere.shared.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace isophote::photon_tiles {

inline constexpr int kScreenTileSide = 4;  ///< ViewTiles: 32 pixels.
inline constexpr int kViewTiles = kScreenTileSide * kScreenTileSide;
inline constexpr std::uint32_t kNoTile = 0xffffffffu;

/// Which ViewTiles belong to each tile of 32 x 32 pixels, and where their samples lie. All tiles of a column
/// share two planes through the eye, and those of a row two others; each has a near and a far plane of its
/// own. After them come the secondary ViewTiles, 16 at a time, with bounds in the world.
class ScreenTiles {
 public:
  /// Reuses memory.
  void build(const ViewSamples& view);

  std::size_t size() const { return tiles_.size(); }
  /// Indices into ViewSamples::tiles, kNoTile where there are fewer.
  const std::array<std::uint32_t, kViewTiles>& viewTiles(std::size_t tile) const { return tiles_[tile]; }

  /// Calls visit(tile) for every tile whose bounds the sphere touches, in ascending order. Conservative.
  template <class Visit>
  void forEachTouched(const PhotonSphere& sphere, Visit&& visit) const {
    const vec3 offset = sphere.position - eye_;
    const float slack = 1e-5f * (length(offset) + length(eye_)) + 1e-5f * sphere.radius;
    const float reach = sphere.radius + slack;
    const float depth = dot(offset, forward_);
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      if (!rows_[row].touches(offset, reach)) continue;
      for (std::size_t column = 0; column < columns_.size(); ++column) {
        const std::size_t tile = row * columns_.size() + column;
        if (depth + reach < near_[tile] || depth - reach > far_[tile]) continue;
        if (columns_[column].touches(offset, reach)) visit(tile);
      }
    }
    forEachSecondary(sphere, reach, visit);
  }

 private:
  static constexpr std::size_t kBlock = 32;  ///< Secondary tiles under one bound.

  /// Points p with dot(p, low) >= lowAt and dot(p, high) <= highAt, relative to the eye; unit normals.
  struct Slab {
    vec3 low{0.0f}, high{0.0f};
    float lowAt = 0, highAt = 0;
    bool touches(vec3 offset, float reach) const {
      return dot(offset, low) >= lowAt - reach && dot(offset, high) <= highAt + reach;
    }
  };
  /// Smallest and largest slope of the samples of a row or column.
  struct Slopes {
    float least = 1e30f, most = -1e30f;
  };
  static bool touches(const Bounds& b, vec3 p, float reach) {
    const vec3 outside = max(max(b.lower - p, p - b.upper), vec3(0.0f));
    return dot(outside, outside) <= reach * reach;
  }
  template <class Visit>
  void forEachSecondary(const PhotonSphere& sphere, float reach, Visit&& visit) const {
    const std::size_t first = rows_.size() * columns_.size();
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
      if (blocks_[block].empty() || !touches(blocks_[block], sphere.position, reach)) continue;
      for (std::size_t i = block * kBlock; i < std::min((block + 1) * kBlock, secondary_.size()); ++i)
        if (!secondary_[i].empty() && touches(secondary_[i], sphere.position, reach)) visit(first + i);
    }
  }
  void measure(const ViewSamples& view, std::size_t tile, Slopes& x, Slopes& y);
  Slab slabOf(const CameraRays& camera, vec3 axis, Slopes slopes) const;
  void buildSecondary(const ViewSamples& view);

  vec3 eye_{0.0f}, forward_{0.0f};
  std::vector<std::array<std::uint32_t, kViewTiles>> tiles_;
  std::vector<float> near_, far_;  ///< Depths along `forward` [m].
  std::vector<Slab> columns_, rows_;
  std::vector<Slopes> slopesX_, slopesY_;  ///< Of each primary tile.
  std::vector<Bounds> secondary_;
  std::vector<Bounds> blocks_;
};

}  // namespace isophote::photon_tiles

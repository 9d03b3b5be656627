// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The hot loops of upsample: the cells around a tile of the picture against its 64 pixels. Cells are
// broadcast to the lanes, instead of being gathered by each, because neighbouring pixels share them.
#pragma once

#include "stages/gbuffer/view_samples.h"
#include "stages/upsample/upsample.shared.h"

#include <cstdint>

namespace isophote::upsample {

/// The sample of a cell of n x n pixels. One line of memory.
struct alignas(64) Cell {
  vec3 position;
  float present;  ///< 1; 0 where no pixel of the cell shows a surface that can be lit.
  vec3 ns;        ///< Shading normal.
  float alpha;    ///< Of its glossy reflection; 0 where it has none.
  vec3 diffuse;   ///< Light with the reflectance divided out, as upsampleDiffuse().
  float reserved0;
  vec3 glossy;  ///< Likewise, as upsampleGlossy().
  float reserved1;
};
static_assert(sizeof(Cell) == 64);

/// All the cells, and those around one tile.
struct Cells {
  const Cell* cells;  ///< Rows of `width`.
  int width, height;
  int side;              ///< Pixels.
  int offsetX, offsetY;  ///< Of the sample in its cell [pixels].
  uint weights;          ///< kUpsample...
  vec3 eye, forward;     ///< Of the camera.
  float cellSize;        ///< Width of a cell at distance 1 [m]; of any where the camera is orthographic.
  float orthographic;

  int columnFrom(int x) const { return weights == kUpsampleNearest ? x / side : below(x - offsetX); }
  int columnTo(int x) const { return weights == kUpsampleNearest ? x / side : below(x - offsetX) + 1; }
  int rowFrom(int y) const { return weights == kUpsampleNearest ? y / side : below(y - offsetY); }
  int rowTo(int y) const { return weights == kUpsampleNearest ? y / side : below(y - offsetY) + 1; }

 private:
  int below(int x) const { return (x >= 0 ? x : x - side + 1) / side; }
};

struct TilePlace {
  int x, y;  ///< Upper left pixel.
};

inline constexpr int kGroupLanes = 16;
inline constexpr int kGroupRows = kGroupLanes / kTileSide;
inline constexpr int kGroups = kTileLanes / kGroupLanes;

/// Calls add(cell, weights) for each cell that may count at the lanes of a group, until it returns true;
/// `weights` holds one a lane. Those in the middle, which count at the most lanes, come first.
template <class Add>
SHARED_FN void visitCells(const ViewTile& tile, const Cells& cells, TilePlace place, int group, Add&& add) {
  const int first = group * kGroupLanes;
  const int top = place.y + group * kGroupRows;
  const uint weights = cells.weights;
  const float side = float(cells.side);
  float cellsPerMetre[kGroupLanes], weight[kGroupLanes];
  for (int i = 0; i < kGroupLanes; ++i) {
    const float depth = dot(positionOf(tile, first + i) - cells.eye, cells.forward);
    const float size = cells.cellSize * (cells.orthographic > 0.5f ? 1.0f : depth);
    cellsPerMetre[i] = 1.0f / max(size, 1e-12f);
  }
  // The sample of the pixel's own cell counts wherever in the cell that lies.
  const bool nearest = weights == kUpsampleNearest;
  const float reach = nearest ? 0.5f * side : side;
  const float slope = nearest ? 0.0f : 1.0f / side;
  const float middleX = nearest ? 0.5f * side - 0.5f : float(cells.offsetX);
  const float middleY = nearest ? 0.5f * side - 0.5f : float(cells.offsetY);
  const int firstX = max(cells.columnFrom(place.x), 0);
  const int lastX = min(cells.columnTo(place.x + kTileSide - 1), cells.width - 1);
  const int lastY = min(cells.rowTo(top + kGroupRows - 1), cells.height - 1);
  const int columns = lastX - firstX + 1;
  for (int k = 0; k < columns; ++k) {
    const int column = firstX + (k + columns / 4) % columns;
    for (int row = max(cells.rowFrom(top), 0); row <= lastY; ++row) {
      const Cell& cell = cells.cells[row * cells.width + column];
      if (cell.present == 0.0f) continue;
      const vec3 samplePosition = cell.position, sampleNs = cell.ns;
      const float sampleX = float(column) * side + middleX - float(place.x);
      const float sampleY = float(row) * side + middleY - float(top);
      for (int i = 0; i < kGroupLanes; ++i) {
        const int lane = first + i;
        const float screen = upsampleScreenWeight(float(i & (kTileSide - 1)) - sampleX, reach, slope) *
                             upsampleScreenWeight(float(i / kTileSide) - sampleY, reach, slope);
        weight[i] =
            screen * upsampleSurfaceWeight(weights, positionOf(tile, lane), ngOf(tile, lane),
                                           nsOf(tile, lane), cellsPerMetre[i], samplePosition, sampleNs);
      }
      if (add(cell, weight)) return;
    }
  }
}

/// Sets the bits of the lanes that have a surface and no cell that counts for all that it reflects.
SHARED_FN void meetBody(const ViewTile& tile, const Cells& cells, TilePlace place, std::uint64_t& unmet) {
  unmet = 0;
  if (tile.count == 0u) return;
  for (int group = 0; group < kGroups; ++group) {
    const int first = group * kGroupLanes;
    // What still has to be found: a sample on the surface, and one that reflects alike.
    std::uint32_t wanted[kGroupLanes], wantedGlossy[kGroupLanes];
    for (int i = 0; i < kGroupLanes; ++i) {
      wanted[i] = tile.pixel[first + i] != kNoPixel ? 1u : 0u;
      wantedGlossy[i] = 0u;
    }
    if (tile.lambertian != 0) {
      visitCells(
          tile, cells, place, group, [&](const Cell&, const float* weight) __attribute__((always_inline)) {
            std::uint32_t missing = 0;
        // Unrolled, it would not be vectorised.
#pragma GCC unroll 1
            for (int i = 0; i < kGroupLanes; ++i) {
              wanted[i] = weight[i] > 0.0f ? 0u : wanted[i];
              missing |= wanted[i];
            }
            return missing == 0u;
          });
    } else {
      const float* alpha = tile.alpha + first;
      const float* f90 = tile.f90 + first;
      for (int i = 0; i < kGroupLanes; ++i)
        wantedGlossy[i] = alpha[i] > 0.0f && f90[i] > 0.0f ? wanted[i] : 0u;
      visitCells(
          tile, cells, place,
          group, [&](const Cell& cell, const float* weight) __attribute__((always_inline)) {
            std::uint32_t missing = 0;
            for (int i = 0; i < kGroupLanes; ++i) {
              wanted[i] = weight[i] > 0.0f ? 0u : wanted[i];
              const float alike = weight[i] * upsampleRoughnessWeight(alpha[i], cell.alpha);
              wantedGlossy[i] = cell.alpha > 0.0f && alike > 0.0f ? 0u : wantedGlossy[i];
              missing |= wanted[i] | wantedGlossy[i];
            }
            return missing == 0u;
          });
    }
    for (int i = 0; i < kGroupLanes; ++i) unmet |= std::uint64_t(wanted[i] | wantedGlossy[i]) << (first + i);
  }
}

/// Radiance at the lanes of a Lambertian tile; anything where no cell counts.
SHARED_FN void lambertianBody(const ViewTile& tile, const Cells& cells, TilePlace place, RadianceTile& out) {
  for (int group = 0; group < kGroups; ++group) {
    float sum[kGroupLanes] = {}, r[kGroupLanes] = {}, g[kGroupLanes] = {}, b[kGroupLanes] = {};
    visitCells(
        tile, cells, place, group, [&](const Cell& cell, const float* weight) __attribute__((always_inline)) {
          for (int i = 0; i < kGroupLanes; ++i) {
            sum[i] += weight[i];
            r[i] += weight[i] * cell.diffuse.x;
            g[i] += weight[i] * cell.diffuse.y;
            b[i] += weight[i] * cell.diffuse.z;
          }
          return false;
        });
    for (int i = 0; i < kGroupLanes; ++i) {
      const int lane = group * kGroupLanes + i;
      const float scale = kInvPi / max(sum[i], 1e-20f);
      out.r[lane] = r[i] * (tile.diffuseR[lane] * scale);
      out.g[lane] = g[i] * (tile.diffuseG[lane] * scale);
      out.b[lane] = b[i] * (tile.diffuseB[lane] * scale);
    }
  }
}

/// Likewise of any tile.
SHARED_FN void glossyBody(const ViewTile& tile, const Cells& cells, TilePlace place, RadianceTile& out) {
  for (int group = 0; group < kGroups; ++group) {
    float sum[kGroupLanes] = {}, r[kGroupLanes] = {}, g[kGroupLanes] = {}, b[kGroupLanes] = {};
    float glossySum[kGroupLanes] = {}, glossyR[kGroupLanes] = {}, glossyG[kGroupLanes] = {},
          glossyB[kGroupLanes] = {};
    const float* alpha = tile.alpha + group * kGroupLanes;
    visitCells(
        tile, cells, place, group, [&](const Cell& cell, const float* weight) __attribute__((always_inline)) {
          for (int i = 0; i < kGroupLanes; ++i) {
            sum[i] += weight[i];
            r[i] += weight[i] * cell.diffuse.x;
            g[i] += weight[i] * cell.diffuse.y;
            b[i] += weight[i] * cell.diffuse.z;
            const float alike = upsampleRoughnessWeight(alpha[i], cell.alpha);
            const float glossy = weight[i] * (cell.alpha > 0.0f ? alike : 0.0f);
            glossySum[i] += glossy;
            glossyR[i] += glossy * cell.glossy.x;
            glossyG[i] += glossy * cell.glossy.y;
            glossyB[i] += glossy * cell.glossy.z;
          }
          return false;
        });
    for (int i = 0; i < kGroupLanes; ++i) {
      const int lane = group * kGroupLanes + i;
      const Bsdf bsdf = reflectionOf(tile, lane);
      const vec3 ns = nsOf(tile, lane);
      const vec3 wo = woOf(tile, lane);
      const float cosO = abs(dot(wo, ns));
      const float scale = kInvPi * upsampleCoupling(bsdf, cosO) / max(sum[i], 1e-20f);
      const vec3 reflectance = upsampleGlossy(bsdf, cosO);
      const bool reflects = bsdf.alpha > 0.0f && bsdf.f90 > 0.0f;
      const float glossyScale = reflects ? 1.0f / max(glossySum[i], 1e-20f) : 0.0f;
      out.r[lane] = r[i] * bsdf.diffuse.x * scale + glossyR[i] * reflectance.x * glossyScale;
      out.g[lane] = g[i] * bsdf.diffuse.y * scale + glossyG[i] * reflectance.y * glossyScale;
      out.b[lane] = b[i] * bsdf.diffuse.z * scale + glossyB[i] * reflectance.z * glossyScale;
    }
  }
}

}  // namespace isophote::upsample

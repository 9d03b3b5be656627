// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/upsample/sparse_view.h"

#include "math/morton.h"
#include "math/sobol.shared.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace isophote::upsample {

namespace {

/// Samples whose memory is asked for before it is read: as much as arrives in the meantime.
constexpr int kWantedAhead = 12;

Place placeOf(const ViewSamples& view, int x, int y) {
  return {std::size_t(y / kTileSide) * std::size_t(view.tilesX) + std::size_t(x / kTileSide),
          y % kTileSide * kTileSide + x % kTileSide};
}

bool isLit(const ViewSamples& view, Place p) { return view.tiles[p.tile].pixel[p.lane] != kNoPixel; }

/// The pixel that stands for a cell: the one at its offset, or the first where that shows no surface.
bool findPixel(const ViewSamples& view, const Cells& grid, int column, int row, Place& found) {
  const int x0 = column * grid.side, y0 = row * grid.side;
  const int x1 = std::min(x0 + grid.side, view.width), y1 = std::min(y0 + grid.side, view.height);
  if (x0 + grid.offsetX < x1 && y0 + grid.offsetY < y1) {
    found = placeOf(view, x0 + grid.offsetX, y0 + grid.offsetY);
    if (isLit(view, found)) return true;
  }
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      found = placeOf(view, x, y);
      if (isLit(view, found)) return true;
    }
  return false;
}

Cells gridOf(const ViewSamples& view, int side, std::uint32_t pass, uint weights) {
  Cells grid{};
  grid.width = (view.width + side - 1) / side;
  grid.height = (view.height + side - 1) / side;
  grid.side = side;
  // The middle of the cell first, then all over it.
  const auto offset = [&](std::uint32_t dimension) {
    constexpr float kFromBits = 1.0f / 4294967296.0f;
    return (side / 2 + int(float(sobolBits(pass, dimension)) * kFromBits * float(side))) % side;
  };
  grid.offsetX = offset(0);
  grid.offsetY = offset(1);
  grid.weights = weights;
  grid.eye = view.camera.eye;
  grid.forward = view.camera.forward;
  grid.orthographic = view.camera.orthographic;
  grid.cellSize = 2.0f * length(view.camera.up) * float(side) / float(view.height);
  return grid;
}

/// What of a sample's glossy reflection is estimated on its own.
bool reflectsGlossily(const Bsdf& bsdf) { return bsdf.alpha > 0.0f && bsdf.f90 > 0.0f; }

}  // namespace

void SparseView::chooseCells(const ViewSamples& view, std::uint32_t side, std::uint32_t pass, uint weights) {
  grid_ = gridOf(view, int(side), pass, weights);
  cells_.resize(std::size_t(grid_.width) * std::size_t(grid_.height));
  grid_.cells = cells_.data();
  view_.width = grid_.width;
  view_.height = grid_.height;
  view_.camera = view.camera;
  view_.tilesX = (grid_.width + kTileSide - 1) / kTileSide;
  view_.tilesY = (grid_.height + kTileSide - 1) / kTileSide;
  view_.primaryTiles = std::size_t(view_.tilesX) * std::size_t(view_.tilesY);
  if (view_.tiles.size() < view_.primaryTiles) view_.tiles.resize(view_.primaryTiles);
  glossy_.resize(view_.primaryTiles);
  tbb::parallel_for(std::size_t(0), view_.primaryTiles, [&](std::size_t tile) { chooseTile(view, tile); });
}

void SparseView::chooseTile(const ViewSamples& view, std::size_t index) {
  ViewTile& tile = view_.tiles[index];
  ViewTile& glossy = glossy_[index];
  clearTile(tile);
  glossy.count = 0;
  const int column0 = int(index % std::size_t(view_.tilesX)) * kTileSide;
  const int row0 = int(index / std::size_t(view_.tilesX)) * kTileSide;
  const auto want = [&](int lane) {
    const int x = (column0 + lane % kTileSide) * grid_.side + grid_.offsetX;
    const int y = (row0 + lane / kTileSide) * grid_.side + grid_.offsetY;
    const Place place = placeOf(view, std::min(x, view.width - 1), std::min(y, view.height - 1));
    wantLane(view.tiles[place.tile], place.lane);
  };
  for (int lane = 0; lane < kWantedAhead; ++lane) want(lane);
  for (int lane = 0; lane < kTileLanes; ++lane) {
    if (lane + kWantedAhead < kTileLanes) want(lane + kWantedAhead);
    const int column = column0 + lane % kTileSide;
    const int row = row0 + lane / kTileSide;
    if (column >= grid_.width || row >= grid_.height) continue;
    const std::size_t at = std::size_t(row) * std::size_t(grid_.width) + std::size_t(column);
    Cell& cell = cells_[at];
    Place place{};
    cell.present = findPixel(view, grid_, column, row, place) ? 1.0f : 0.0f;
    if (cell.present == 0.0f) continue;
    ViewSample sample = laneOf(view.tiles[place.tile], place.lane);
    const Bsdf bsdf = sample.bsdf;
    const float cosO = std::abs(dot(sample.wo, sample.ns));
    cell.position = sample.position;
    cell.ns = sample.ns;
    cell.alpha = reflectsGlossily(bsdf) ? bsdf.alpha : 0.0f;
    cell.glossy = upsampleGlossy(bsdf, cosO);  // Until takeLight().
    sample.pixel = std::uint32_t(at);
    sample.throughput = vec3(1.0f);
    sample.bsdf = upsampleDiffuse(bsdf, cosO);
    setLane(tile, lane, sample);
    if (cell.alpha == 0.0f) continue;
    if (glossy.count == 0) clearTile(glossy);
    sample.bsdf = bsdf;
    sample.bsdf.diffuse = sample.bsdf.transmission = vec3(0.0f);
    sample.bsdf.through = 0.0f;
    setLane(glossy, lane, sample);
  }
}

void SparseView::addGlossyTiles() {
  glossyTile_.assign(view_.primaryTiles, kNoTile);
  std::size_t next = view_.primaryTiles;
  for (std::size_t t = 0; t < view_.primaryTiles; ++t)
    if (glossy_[t].count > 0) glossyTile_[t] = std::uint32_t(next++);
  firstSingleTile_ = next;
}

/// Neighbours in space next to each other, those of tiles that reflect glossily apart from the others: a tile
/// of samples that lie far apart meets many photons that light few of them.
void SparseView::orderSingles(const ViewSamples& view, std::span<const std::uint64_t> lanes) {
  Bounds bounds;
  for (std::size_t t = 0; t < lanes.size(); ++t)
    if (lanes[t] != 0) bounds.extend(view.tiles[t].bounds);
  constexpr std::uint32_t kAxisBits = 7;
  const vec3 scale = vec3(float(1u << kAxisBits)) / max(bounds.size(), vec3(1e-20f));
  singles_.resize(singles());
  places_.resize(singles());
  order_.resize(singles());
  tbb::parallel_for(std::size_t(0), lanes.size(), [&](std::size_t t) {
    const ViewTile& tile = view.tiles[t];
    std::uint32_t single = singleBegin_[t];
    for (std::uint64_t left = lanes[t]; left != 0; left &= left - 1, ++single) {
      const int lane = std::countr_zero(left);
      const std::uint32_t cell = mortonCode((positionOf(tile, lane) - bounds.lower) * scale, kAxisBits);
      singles_[single] = {t, lane};
      order_[single] = {cell | (tile.lambertian != 0 ? 0u : 1u << 3 * kAxisBits), single};
    }
  });
  sort_.sort(order_, 3 * kAxisBits + 1);
}

void SparseView::addSingle(const ViewSamples& view, std::span<const std::uint64_t> lanes) {
  addGlossyTiles();
  singleBegin_.resize(lanes.size() + 1);
  singleBegin_[0] = 0;
  for (std::size_t t = 0; t < lanes.size(); ++t)
    singleBegin_[t + 1] = singleBegin_[t] + std::uint32_t(std::popcount(lanes[t]));
  const std::size_t secondaryTile = firstSingleTile_ + (singles() + kTileLanes - 1) / kTileLanes;
  const std::size_t secondary = view.tiles.size() - view.primaryTiles;
  view_.tiles.resize(secondaryTile + secondary);
  view_.directTiles = secondaryTile;

  tbb::parallel_for(std::size_t(0), view_.primaryTiles, [&](std::size_t t) {
    if (glossyTile_[t] != kNoTile) view_.tiles[glossyTile_[t]] = glossy_[t];
  });
  orderSingles(view, lanes);
  tbb::parallel_for(firstSingleTile_, secondaryTile, [&](std::size_t t) {
    ViewTile& tile = view_.tiles[t];
    clearTile(tile);
    const std::size_t first = (t - firstSingleTile_) * kTileLanes;
    const std::size_t count = std::min(singles() - first, std::size_t(kTileLanes));
    const auto from = [&](std::size_t i) { return singles_[order_[first + i].index]; };
    const auto want = [&](std::size_t i) {
      if (i < count) wantLane(view.tiles[from(i).tile], from(i).lane);
    };
    for (std::size_t i = 0; i < kWantedAhead; ++i) want(i);
    for (std::size_t i = 0; i < count; ++i) {
      want(i + kWantedAhead);
      places_[order_[first + i].index] = std::uint32_t(first + i);
      setLane(tile, int(i), laneOf(view.tiles[from(i).tile], from(i).lane));
    }
  });
  tbb::parallel_for(std::size_t(0), secondary, [&](std::size_t t) {
    view_.tiles[secondaryTile + t] = view.tiles[view.primaryTiles + t];
  });
}

void SparseView::takeLight(const Radiance& light) {
  tbb::parallel_for(std::size_t(0), view_.primaryTiles, [&](std::size_t t) {
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (view_.tiles[t].pixel[lane] == kNoPixel) continue;
      Cell& cell = cells_[view_.tiles[t].pixel[lane]];
      cell.diffuse = vec3(light[t].r[lane], light[t].g[lane], light[t].b[lane]);
      if (cell.alpha == 0.0f) continue;
      const RadianceTile& glossy = light[glossyTile_[t]];
      cell.glossy = vec3(glossy.r[lane], glossy.g[lane], glossy.b[lane]) / cell.glossy;
    }
  });
}

vec3 SparseView::singleLight(const Radiance& light, std::size_t single) const {
  const RadianceTile& tile = light[firstSingleTile_ + places_[single] / kTileLanes];
  const std::size_t lane = places_[single] % kTileLanes;
  return vec3(tile.r[lane], tile.g[lane], tile.b[lane]);
}

}  // namespace isophote::upsample

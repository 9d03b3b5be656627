// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/lanes.h"
#include "stages/upsample/sparse_view.h"
#include "stages/upsample/upsample.h"
#include "stages/upsample/upsample_body.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace isophote {

using namespace upsample;

namespace {

ISOPHOTE_SIMD(meet, meetBody,
              (const ViewTile& tile, const Cells& cells, TilePlace place, std::uint64_t& unmet),
              (tile, cells, place, unmet))
ISOPHOTE_SIMD(interpolateLambertian, lambertianBody,
              (const ViewTile& tile, const Cells& cells, TilePlace place, RadianceTile& out),
              (tile, cells, place, out))
ISOPHOTE_SIMD(interpolateGlossy, glossyBody,
              (const ViewTile& tile, const Cells& cells, TilePlace place, RadianceTile& out),
              (tile, cells, place, out))

TilePlace placeOf(const ViewSamples& view, std::size_t tile) {
  return {int(tile % std::size_t(view.tilesX)) * kTileSide, int(tile / std::size_t(view.tilesX)) * kTileSide};
}

/// Lanes that light reaches from behind, by rough facets: of that, cells know nothing.
std::uint64_t transmittingLanes(const ViewTile& tile) {
  return bitsWhere([&](int lane) { return tile.through[lane] > 0.0f && tile.pixel[lane] != kNoPixel; });
}

}  // namespace

struct Upsample::Scratch {
  SparseView sparse;
  std::vector<std::uint64_t> unmet;  ///< Of each primary tile: lanes whose surface no cell's sample lies on.
};

Upsample::Upsample(UpsampleSettings settings) : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
Upsample::~Upsample() = default;
Upsample::Upsample(Upsample&&) noexcept = default;
Upsample& Upsample::operator=(Upsample&&) noexcept = default;

const ViewSamples& Upsample::choose(const ChooseIn& in, Stats& stats, const Job& job) {
  const auto scope = stats.scope("upsample.choose");
  Scratch& s = *scratch_;
  s.sparse.chooseCells(in.view, in.side, in.pass, uint(settings_.weights));
  job.throwIfStopped();
  const Cells& cells = s.sparse.cells();
  s.unmet.resize(in.view.primaryTiles);
  const auto meetTile = meetFor(in.simd);
  tbb::parallel_for(std::size_t(0), in.view.primaryTiles, [&](std::size_t t) {
    const ViewTile& tile = in.view.tiles[t];
    if (t + 1 < in.view.primaryTiles) wantPlaces(in.view.tiles[t + 1]);
    meetTile(tile, cells, placeOf(in.view, t), s.unmet[t]);
    if (tile.transmits != 0) s.unmet[t] |= transmittingLanes(tile);
  });
  job.throwIfStopped();
  s.sparse.addSingle(in.view, s.unmet);
  stats.setCounter("upsample.cells", double(cells.width) * double(cells.height));
  stats.setCounter("upsample.pixelsOfTheirOwn", double(s.sparse.singles()));
  return s.sparse.view();
}

void Upsample::begin(const In& in, Radiance& out, Stats& stats, const Job& job) {
  const auto scope = stats.scope("upsample");
  scratch_->sparse.takeLight(in.sparse);
  out.resize(in.view.tiles.size());
  const std::size_t secondary = in.view.tiles.size() - in.view.primaryTiles;
  std::copy_n(in.sparse.end() - std::ptrdiff_t(secondary), secondary,
              out.begin() + std::ptrdiff_t(in.view.primaryTiles));
  job.throwIfStopped();
}

void Upsample::reconstruct(const In& in, std::size_t t, Radiance& out) const {
  const Scratch& s = *scratch_;
  const ViewTile& tile = in.view.tiles[t];
  if (t + 1 < in.view.primaryTiles) {
    const ViewTile& next = in.view.tiles[t + 1];
    wantPlaces(next);
    want(next.diffuseR, sizeof(next.diffuseR) * 3);
    want(&out[t + 1], sizeof(RadianceTile));
  }
  if (tile.count == 0) return;
  const auto interpolate =
      tile.lambertian != 0 ? interpolateLambertianFor(in.simd) : interpolateGlossyFor(in.simd);
  interpolate(tile, s.sparse.cells(), placeOf(in.view, t), out[t]);
  std::size_t single = s.sparse.firstSingle(t);
  for (std::uint64_t lanes = s.unmet[t]; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    const vec3 light = s.sparse.singleLight(in.sparse, single++);
    out[t].r[lane] = light.x;
    out[t].g[lane] = light.y;
    out[t].b[lane] = light.z;
  }
}

void Upsample::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  begin(in, out, stats, job);
  const auto scope = stats.scope("upsample");
  tbb::parallel_for(std::size_t(0), in.view.primaryTiles, [&](std::size_t t) { reconstruct(in, t, out); });
  job.throwIfStopped();
}

}  // namespace isophote

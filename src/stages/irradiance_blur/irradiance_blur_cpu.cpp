// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/irradiance_blur/blur_group.h"
#include "stages/irradiance_blur/irradiance_blur.h"
#include "stages/irradiance_blur/irradiance_blur.shared.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace isophote {

using namespace irradiance_blur;

namespace {

constexpr int kBlockTiles = 16;                   ///< In a row and in a column.
constexpr int kMargin = kLargestRadius + kGroup;  ///< Pixels without a surface at both ends of a row.

/// Depths and normals of the lanes of a tile as the blur wants them.
struct TileSurface {
  float depth[kTileLanes];
  std::uint32_t normal[kTileLanes];
};

SHARED_FN void surfaceBody(const ViewTile& tile, vec3 eye, vec3 forward, bool orthographic,
                           TileSurface& out) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const vec3 n = ngOf(tile, lane);
    const float depth = dot(positionOf(tile, lane) - eye, forward);
    const bool has = tile.pixel[lane] != kNoPixel;
    const float kept = orthographic ? depth : 1.0f / max(depth, 1e-12f);
    out.depth[lane] = has ? kept : 0.0f;
    out.normal[lane] = has ? packBlurNormal(n) : 0u;
  }
}

ISOPHOTE_SIMD(surface, surfaceBody,
              (const ViewTile& tile, vec3 eye, vec3 forward, bool orthographic, TileSurface& out),
              (tile, eye, forward, orthographic, out))

/// Light of pixels, row by row.
struct LightRows {
  std::vector<float> r, g, b;
  void resize(std::size_t pixels) {
    for (std::vector<float>* channel : {&r, &g, &b})
      if (channel->size() < pixels) channel->resize(pixels);
  }
};

void multiply(const RadianceTile& by, RadianceTile& light) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    light.r[lane] *= by.r[lane];
    light.g[lane] *= by.g[lane];
    light.b[lane] *= by.b[lane];
  }
}

/// The same of a row of a tile, from `lane` on, by pixels from `pixel` on.
void multiplyRow(const Mixed& by, int pixel, int lane, RadianceTile& light) {
  for (int i = 0; i < kTileSide; ++i) {
    light.r[lane + i] *= by.r[pixel + i];
    light.g[lane + i] *= by.g[pixel + i];
    light.b[lane + i] *= by.b[pixel + i];
  }
}

/// Tiles that are worked on together, from this row and column of tiles on: small enough that their pixels
/// stay in the cache.
struct Block {
  int row, column;
};

Screen screenOf(const ViewSamples& view, std::uint32_t radius) {
  const CameraRays& camera = view.camera;
  Screen screen{};
  screen.stepX = camera.right * (2.0f / float(view.width));
  screen.stepY = camera.up * (-2.0f / float(view.height));
  screen.orthographic = camera.orthographic > 0.5f;
  screen.first = camera.forward;
  if (!screen.orthographic) screen.first += camera.up - camera.right + 0.5f * (screen.stepX + screen.stepY);
  screen.inverseReach = 1.0f / std::max(kBlurDepthReach * float(radius) * length(screen.stepY), 1e-12f);
  return screen;
}

Taps tapsAlong(vec3 step, std::ptrdiff_t stride, IrradianceBlurSettings settings) {
  Taps taps{};
  taps.step = step;
  const int spacing = int(settings.step), side = int(settings.radius) / spacing;
  for (int k = -side; k <= side; ++k) {
    const int distance = k * spacing;
    taps.offset[taps.last] = distance * stride;
    taps.distance[taps.last] = float(distance);
    taps.weight[taps.last++] = blurScreenWeight(float(distance) / float(settings.radius + 1));
  }
  return taps;
}

}  // namespace

struct IrradianceBlur::Scratch {
  std::size_t stride = 0;  ///< Pixels from row to row.
  int tilesX = 0;          ///< Of the last view.
  LargeVector<float> depth;
  LargeVector<std::uint32_t> normal;
  LargeVector<float> r, g, b;  ///< Mixed along rows.
  Screen screen{};
  Taps alongRow{}, alongColumn{};
  tbb::enumerable_thread_specific<LightRows> workspaces;

  void prepare(const ViewSamples& view, IrradianceBlurSettings settings);
  /// The rows of pixels of a row of tiles: mixed along themselves.
  void mixRows(const In& in, int tileRow);
  /// Then along the columns, and multiplied into the light of the tiles.
  void mixColumns(const In& in, Block block, Radiance& light);
};

void IrradianceBlur::Scratch::prepare(const ViewSamples& view, IrradianceBlurSettings settings) {
  const std::size_t width = std::size_t(view.tilesX + 1) / 2 * kGroup;
  const std::size_t rows = std::size_t(view.tilesY) * kTileSide;
  const std::size_t pixels = (width + 2 * kMargin) * rows;
  // What lies beyond the tiles of a row must have no surface.
  if (stride != width + 2 * kMargin || normal.size() != pixels || tilesX != view.tilesX) {
    stride = width + 2 * kMargin;
    tilesX = view.tilesX;
    normal.assign(pixels, 0u);
    for (LargeVector<float>* plane : {&depth, &r, &g, &b}) plane->assign(pixels, 0.0f);
  }
  screen = screenOf(view, settings.radius);
  alongRow = tapsAlong(screen.stepX, 1, settings);
  alongColumn = tapsAlong(screen.stepY, std::ptrdiff_t(stride), settings);
}

void IrradianceBlur::Scratch::mixRows(const In& in, int tileRow) {
  const ViewSamples& view = in.view;
  LightRows& rows = workspaces.local();
  rows.resize(stride * kTileSide);
  const std::size_t first = std::size_t(tileRow) * kTileSide * stride;
  for (int column = 0; column < view.tilesX; ++column) {
    const std::size_t index = std::size_t(tileRow) * std::size_t(view.tilesX) + std::size_t(column);
    const ViewTile& tile = view.tiles[index];
    if (column + 1 < view.tilesX) {
      const ViewTile& next = view.tiles[index + 1];
      want(&next, offsetof(ViewTile, nsX));
      want(next.pixel, sizeof(next.pixel));
      want(&in.irradiance[index + 1], sizeof(RadianceTile));
    }
    TileSurface surfaces;
    surfaceFor(in.simd)(tile, view.camera.eye, view.camera.forward, screen.orthographic, surfaces);
    const RadianceTile& light = in.irradiance[index];
    for (int y = 0; y < kTileSide; ++y) {
      const std::size_t at = std::size_t(y) * stride + kMargin + std::size_t(column) * kTileSide;
      const int lane = y * kTileSide;
      std::copy_n(surfaces.depth + lane, kTileSide, depth.data() + first + at);
      std::copy_n(surfaces.normal + lane, kTileSide, normal.data() + first + at);
      std::copy_n(light.r + lane, kTileSide, rows.r.data() + at);
      std::copy_n(light.g + lane, kTileSide, rows.g.data() + at);
      std::copy_n(light.b + lane, kTileSide, rows.b.data() + at);
    }
  }
  const MixFn mix = mixFor(in.simd);
  for (int y = 0; y < kTileSide; ++y) {
    const vec3 start =
        screen.first + screen.stepY * (screen.orthographic ? 0.0f : float(tileRow * kTileSide + y));
    for (int x = 0; x < view.width; x += kGroup) {
      const std::size_t row = std::size_t(y) * stride + kMargin + std::size_t(x), at = first + row;
      Mixed mixed;
      mix({depth.data() + at, normal.data() + at, rows.r.data() + row, rows.g.data() + row,
           rows.b.data() + row},
          screen, alongRow, start + screen.stepX * (screen.orthographic ? 0.0f : float(x)), mixed);
      std::copy_n(mixed.r, kGroup, r.data() + at);
      std::copy_n(mixed.g, kGroup, g.data() + at);
      std::copy_n(mixed.b, kGroup, b.data() + at);
    }
  }
}

void IrradianceBlur::Scratch::mixColumns(const In& in, Block block, Radiance& light) {
  const ViewSamples& view = in.view;
  const MixFn mix = mixFor(in.simd);
  const float moves = screen.orthographic ? 0.0f : 1.0f;
  Taps taps = alongColumn;
  const int lastColumn = std::min(block.column + kBlockTiles, view.tilesX);
  const int lastRow = std::min((block.row + kBlockTiles) * kTileSide, view.height);
  for (int y = block.row * kTileSide; y < lastRow; ++y) {
    taps.first = alongColumn.first;
    taps.last = alongColumn.last;
    while (float(y) + taps.distance[taps.first] < 0.0f) ++taps.first;
    while (float(y) + taps.distance[taps.last - 1] >= float(view.height)) --taps.last;
    for (int column = block.column; column < lastColumn; column += kGroup / kTileSide) {
      const int x = column * kTileSide;
      const std::size_t at = std::size_t(y) * stride + kMargin + std::size_t(x);
      const vec3 direction = screen.first + (screen.stepX * float(x) + screen.stepY * float(y)) * moves;
      Mixed mixed;
      mix({depth.data() + at, normal.data() + at, r.data() + at, g.data() + at, b.data() + at}, screen, taps,
          direction, mixed);
      for (int half = 0; half < kGroup / kTileSide && column + half < view.tilesX; ++half)
        multiplyRow(
            mixed, half * kTileSide, y % kTileSide * kTileSide,
            light[std::size_t(y / kTileSide) * std::size_t(view.tilesX) + std::size_t(column + half)]);
    }
  }
}

IrradianceBlur::IrradianceBlur(IrradianceBlurSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
IrradianceBlur::~IrradianceBlur() = default;
IrradianceBlur::IrradianceBlur(IrradianceBlur&&) noexcept = default;
IrradianceBlur& IrradianceBlur::operator=(IrradianceBlur&&) noexcept = default;

void IrradianceBlur::run(const In& in, Radiance& light, Stats& stats, const Job& job) {
  const auto scope = stats.scope("irradiance_blur");
  Scratch& s = *scratch_;
  const bool mixes = settings_.radius >= settings_.step;
  if (mixes) {
    s.prepare(in.view, settings_);
    tbb::parallel_for(0, in.view.tilesY, [&](int row) {
      job.throwIfStopped();
      s.mixRows(in, row);
    });
    const int across = (in.view.tilesX + kBlockTiles - 1) / kBlockTiles;
    const int down = (in.view.tilesY + kBlockTiles - 1) / kBlockTiles;
    tbb::parallel_for(0, across * down, [&](int block) {
      job.throwIfStopped();
      s.mixColumns(in, {block / across * kBlockTiles, block % across * kBlockTiles}, light);
    });
  }
  const std::size_t alone = mixes ? in.view.primaryTiles : 0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(alone, light.size(), 64), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) multiply(in.irradiance[i], light[i]);
  });
  stats.peakBytes("irradiance_blur.pixels", s.normal.size() * 5 * sizeof(float));
}

}  // namespace isophote

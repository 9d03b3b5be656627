// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/eye_paths.h"
#include "stages/gbuffer/gbuffer.h"
#include "stages/gbuffer/secondary_tiles.h"
#include "trace/raster.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace isophote {

using namespace gbuffer;

namespace {

/// The primary rays of one tile and what they met; lanes outside the picture met nothing.
struct PrimaryHits {
  std::array<Ray, kTileLanes> rays;
  std::array<Hit, kTileLanes> hits;
};

/// Upper left pixel of a primary tile.
struct TileCorner {
  int x, y;
};

TileCorner cornerOf(const ViewSamples& view, std::size_t tile) {
  return {int(tile % std::size_t(view.tilesX)) * kTileSide, int(tile / std::size_t(view.tilesX)) * kTileSide};
}

void sizeFor(const Gbuffer::In& in, ViewSamples& out) {
  out.width = in.width;
  out.height = in.height;
  out.tilesX = (in.width + kTileSide - 1) / kTileSide;
  out.tilesY = (in.height + kTileSide - 1) / kTileSide;
  out.camera = in.camera;
  out.primaryTiles = std::size_t(out.tilesX) * std::size_t(out.tilesY);
  out.tiles.resize(out.primaryTiles);
  out.emits.resize(out.primaryTiles);
  const auto size = [&](Image& image, bool wanted) {
    image.width = wanted ? in.width : 0;
    image.height = wanted ? in.height : 0;
    image.pixels.resize(std::size_t(image.width) * std::size_t(image.height));
  };
  size(out.emitted, true);
  for (Image* image : {&out.albedo, &out.normal, &out.depth}) size(*image, in.surfaceLayers);
}

/// `seen`: triangles of the whole picture, null where rays are to find them.
void findHits(const Gbuffer::In& in, TileCorner corner, const LargeVector<std::uint32_t>* seen,
              PrimaryHits& out) {
  const RasterView view{in.camera, in.width, in.height, in.subpixel};
  for (int lane = 0; lane < kTileLanes; ++lane)
    out.rays[std::size_t(lane)] = rasterRay(view, corner.x + lane % kTileSide, corner.y + lane / kTileSide);
  if (!seen) {
    constexpr std::size_t kPacket = 16;
    for (std::size_t first = 0; first < kTileLanes; first += kPacket)
      in.trace.closestHits(std::span(out.rays).subspan(first, kPacket),
                           std::span(out.hits).subspan(first, kPacket), true, Blended::kAlways);
    return;
  }
  std::array<std::uint32_t, kTileLanes> triangles;
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const int x = corner.x + lane % kTileSide, y = corner.y + lane / kTileSide;
    const bool inside = x < in.width && y < in.height;
    triangles[std::size_t(lane)] =
        inside ? (*seen)[std::size_t(y) * std::size_t(in.width) + std::size_t(x)] : kNoTriangle;
  }
  in.trace.raster().hits(out.rays, triangles, out.hits);
}

void writeLayers(const FirstSurface& first, const Hit& hit, std::uint32_t pixel, ViewSamples& out) {
  out.albedo.pixels[pixel] = first.baseColour;
  out.normal.pixels[pixel] = first.ns;
  out.depth.pixels[pixel] = vec3(first.met ? hit.t : 0.0f, 0.0f, 0.0f);
}

/// Fills a primary tile, and what comes with it, from its hits.
void shadeTile(const EyePaths::Options& options, const PrimaryHits& primary, std::size_t index,
               EyePaths& paths, ViewSamples& out, std::vector<ViewSample>& secondary) {
  ViewTile& tile = out.tiles[index];
  clearTile(tile);
  secondary.clear();
  const TileCorner corner = cornerOf(out, index);
  std::array<vec3, kTileLanes> emitted{};
  bool emits = false;
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const int x = corner.x + lane % kTileSide;
    const int y = corner.y + lane / kTileSide;
    if (x >= out.width || y >= out.height) continue;
    const auto pixel = std::uint32_t(y) * std::uint32_t(out.width) + std::uint32_t(x);
    const Hit& hit = primary.hits[std::size_t(lane)];
    const FirstSurface first = paths.follow(options, pixel, primary.rays[std::size_t(lane)], hit, secondary);
    if (first.lit) setLane(tile, lane, first.sample);
    emitted[std::size_t(lane)] = first.emitted;
    emits |= first.emitted != vec3(0.0f);
    if (!out.albedo.pixels.empty()) writeLayers(first, hit, pixel, out);
  }
  out.emits[index] = emits ? 1 : 0;
  if (!emits) return;
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const int x = corner.x + lane % kTileSide;
    const int y = corner.y + lane / kTileSide;
    if (x < out.width && y < out.height) out.emitted.at(x, y) = emitted[std::size_t(lane)];
  }
}

}  // namespace

struct Gbuffer::Scratch {
  Rasteriser rasteriser;
  LargeVector<std::uint32_t> seen;                 ///< The triangle in each pixel.
  std::vector<std::vector<ViewSample>> secondary;  ///< Of each primary tile.
  tbb::enumerable_thread_specific<EyePaths> paths;
  SecondaryTiles secondaryTiles;
};

Gbuffer::Gbuffer(GbufferSettings settings) : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
Gbuffer::~Gbuffer() = default;
Gbuffer::Gbuffer(Gbuffer&&) noexcept = default;
Gbuffer& Gbuffer::operator=(Gbuffer&&) noexcept = default;

void Gbuffer::run(const In& in, ViewSamples& out, Stats& stats, const Job& job) {
  const auto scope = stats.scope("gbuffer");
  Scratch& s = *scratch_;
  sizeFor(in, out);
  s.secondary.resize(out.primaryTiles);
  const EyePaths::Options options{in.trace, settings_.mirrorDepth, in.seed, in.pass};
  // The rasteriser sees blended surfaces as masks.
  const bool rastered = settings_.visibility == PrimaryVisibility::kRaster && !in.trace.blends();
  if (rastered)
    s.rasteriser.run(in.trace.raster(), {in.camera, in.width, in.height, in.subpixel}, {&s.seen, nullptr},
                     job);
  tbb::parallel_for(std::size_t(0), out.primaryTiles, [&](std::size_t tile) {
    if (job.stop.stop_requested()) return;
    PrimaryHits primary;
    findHits(in, cornerOf(out, tile), rastered ? &s.seen : nullptr, primary);
    shadeTile(options, primary, tile, s.paths.local(), out, s.secondary[tile]);
  });
  job.throwIfStopped();
  s.secondaryTiles.append(s.secondary, out.tiles);

  std::uint64_t samples = 0;
  for (const ViewTile& tile : out.tiles) samples += tile.count;
  stats.setCounter("gbuffer.viewSamples", double(samples));
  stats.setCounter("gbuffer.tiles", double(out.tiles.size()));
}

}  // namespace isophote

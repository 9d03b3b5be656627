// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/eye_paths.h"
#include "stages/gbuffer/gbuffer.h"
#include "stages/gbuffer/primary_tile.h"
#include "stages/gbuffer/secondary_tiles.h"
#include "trace/light_sampler.h"
#include "trace/raster.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>

namespace isophote {

using namespace gbuffer;

namespace {

void sizeFor(const Gbuffer::In& in, ViewSamples& out) {
  out.width = in.width;
  out.height = in.height;
  out.tilesX = (in.width + kTileSide - 1) / kTileSide;
  out.tilesY = (in.height + kTileSide - 1) / kTileSide;
  out.camera = in.camera;
  out.primaryTiles = out.directTiles = std::size_t(out.tilesX) * std::size_t(out.tilesY);
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
              const PrimaryRays& rays, SurfaceLanes& out) {
  if (!seen) {
    constexpr std::size_t kPacket = 16;
    std::array<Ray, kTileLanes> each;
    std::array<Hit, kTileLanes> hits;
    for (int lane = 0; lane < kTileLanes; ++lane) each[std::size_t(lane)] = rays[lane];
    for (std::size_t first = 0; first < kTileLanes; first += kPacket)
      in.trace.closestHits(std::span(each).subspan(first, kPacket), std::span(hits).subspan(first, kPacket),
                           true, Blended::kAlways);
    out.take(in.trace, hits);
    return;
  }
  SurfaceWords ids;
  for (int y = 0; y < kTileSide; ++y) {
    const int columns = corner.y + y < in.height ? std::min(kTileSide, in.width - corner.x) : 0;
    const std::size_t first = std::size_t(corner.y + y) * std::size_t(in.width) + std::size_t(corner.x);
    for (int x = 0; x < kTileSide; ++x)
      ids[std::uint32_t(y * kTileSide + x)] = x < columns ? (*seen)[first + std::size_t(x)] : kNoTriangle;
  }
  out.meet(in.trace.raster(), ids, rays.origin, rays.direction);
}

/// What one thread shades tiles with.
struct TileShader {
  PrimaryRays rays;
  SurfaceLanes surfaces;
  EyePaths paths;
};

/// Fills a primary tile, and what comes with it, from its hits.
class ShadeTile {
 public:
  ShadeTile(const Gbuffer::In& in, std::uint32_t mirrorDepth, bool shapeLights, std::size_t index,
            TileShader& shader, ViewSamples& out, std::vector<ViewSample>& secondary)
      : in_(in),
        options_{in.trace, mirrorDepth, in.seed, in.pass},
        shapeLights_(shapeLights),
        index_(index),
        corner_(cornerOf(out, index)),
        shader_(shader),
        out_(out),
        secondary_(secondary) {}

  void run() {
    const std::uint64_t inside = lanesInside(out_, corner_);
    const std::uint64_t plain = shadePlainLanes(inside);
    secondary_.clear();
    for (std::uint64_t rest = inside & ~plain; rest != 0; rest &= rest - 1)
      followLane(std::countr_zero(rest));
    out_.emits[index_] = emits_ ? 1 : 0;
    if (!emits_) return;
    for (std::uint64_t rest = inside; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      out_.emitted.pixels[pixelOf(lane)] = emitted_[std::size_t(lane)];
    }
  }

 private:
  std::uint32_t pixelOf(int lane) const {
    return std::uint32_t(corner_.y + lane / kTileSide) * std::uint32_t(out_.width) +
           std::uint32_t(corner_.x + lane % kTileSide);
  }
  Hit hitOf(int lane) const { return shader_.surfaces.hit(lane); }

  /// Fills the tile with the lanes that send no path on and emit nothing, and returns them.
  std::uint64_t shadePlainLanes(std::uint64_t inside) {
    SurfaceLanes& s = shader_.surfaces;
    s.plain &= inside;
    s.shade(shader_.rays.direction);
    fillTile(s, shader_.rays.direction, s.plain, out_.width, corner_, out_.tiles[index_]);
    const std::uint64_t done = s.plain | (inside & ~s.met);
    if (shapeLights_) meetShapeLights(done);
    if (!out_.albedo.pixels.empty()) writeLayers(done);
    return done;
  }

  void meetShapeLights(std::uint64_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      emit(lane, shapeLightRadiance(in_.trace, shader_.rays[lane], hitOf(lane)));
    }
  }

  void writeLayers(std::uint64_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const SurfaceLanes& s = shader_.surfaces;
      const bool met = hitOf(lane).valid();
      writeLayers(lane, met ? s.baseColour[lane] : vec3(0.0f), met ? s.points.ns[lane] : vec3(0.0f));
    }
  }

  void writeLayers(int lane, vec3 baseColour, vec3 ns) {
    const std::uint32_t pixel = pixelOf(lane);
    out_.albedo.pixels[pixel] = baseColour;
    out_.normal.pixels[pixel] = ns;
    out_.depth.pixels[pixel] = vec3(hitOf(lane).valid() ? hitOf(lane).t : 0.0f, 0.0f, 0.0f);
  }

  /// Any surface, and on from there.
  void followLane(int lane) {
    const FirstSurface first =
        shader_.paths.follow(options_, pixelOf(lane), shader_.rays[lane], hitOf(lane), secondary_);
    if (first.lit) setLane(out_.tiles[index_], lane, first.sample);
    emit(lane, first.emitted);
    if (!out_.albedo.pixels.empty()) writeLayers(lane, first.baseColour, first.ns);
  }

  void emit(int lane, vec3 radiance) {
    emitted_[std::size_t(lane)] = radiance;
    emits_ |= radiance != vec3(0.0f);
  }

  const Gbuffer::In& in_;
  EyePaths::Options options_;
  bool shapeLights_;
  std::size_t index_;
  TileCorner corner_;
  TileShader& shader_;
  ViewSamples& out_;
  std::vector<ViewSample>& secondary_;
  bool emits_ = false;
  std::array<vec3, kTileLanes> emitted_{};
};

}  // namespace

struct Gbuffer::Scratch {
  Rasteriser rasteriser;
  LargeVector<std::uint32_t> seen;                 ///< The triangle in each pixel.
  std::vector<std::vector<ViewSample>> secondary;  ///< Of each primary tile.
  tbb::enumerable_thread_specific<TileShader> shaders;
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
  // The rasteriser sees blended surfaces as masks.
  const bool rastered = settings_.visibility == PrimaryVisibility::kRaster && !in.trace.blends();
  if (rastered)
    s.rasteriser.run(in.trace.raster(), {in.camera, in.width, in.height, in.subpixel}, {&s.seen, nullptr},
                     job);
  const bool shapeLights = hasShapeLights(in.trace);
  tbb::parallel_for(std::size_t(0), out.primaryTiles, [&](std::size_t tile) {
    if (job.stop.stop_requested()) return;
    TileShader& shader = s.shaders.local();
    if (tile + 1 < out.primaryTiles) wantTile(out.tiles[tile + 1]);
    const TileCorner corner = cornerOf(out, tile);
    primaryRays(in.camera, in.width, in.height, in.subpixel, corner, shader.rays);
    findHits(in, corner, rastered ? &s.seen : nullptr, shader.rays, shader.surfaces);
    ShadeTile(in, settings_.mirrorDepth, shapeLights, tile, shader, out, s.secondary[tile]).run();
  });
  job.throwIfStopped();
  s.secondaryTiles.append(s.secondary, out.tiles);

  std::uint64_t samples = 0;
  for (const ViewTile& tile : out.tiles) samples += tile.count;
  stats.setCounter("gbuffer.viewSamples", double(samples));
  stats.setCounter("gbuffer.tiles", double(out.tiles.size()));
}

}  // namespace isophote

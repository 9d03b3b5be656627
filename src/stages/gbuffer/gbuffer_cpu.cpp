// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/rng.shared.h"
#include "stages/gbuffer/gbuffer.h"
#include "trace/light_sampler.h"
#include "trace/surface.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>

namespace isophote {

namespace {

/// Stands for "the eye" where random numbers are keyed by light.
constexpr std::uint32_t kEyeStream = 0xfffffffeu;
/// Up to this depth a path through glass follows both the reflection and the refraction; deeper it chooses
/// one.
constexpr std::uint32_t kSplitDepth = 2;
/// A path of less throughput survives with a probability in proportion.
constexpr float kRouletteThroughput = 0.02f;

struct EyePath {
  Ray ray;
  vec3 throughput;
  std::uint32_t depth;  ///< Specular events so far.
};

/// Follows the eye paths of one pixel from their first hit on.
class PixelPaths {
 public:
  PixelPaths(const Gbuffer::In& in, std::uint32_t mirrorDepth, std::uint32_t pixel,
             std::vector<ViewSample>& secondary)
      : in_(in),
        mirrorDepth_(mirrorDepth),
        pixel_(pixel),
        key_(pathKey(in.seed, in.pass, kEyeStream, pixel)),
        secondary_(secondary) {}

  /// Radiance that reaches the eye straight from emitters.
  vec3 emitted = vec3(0.0f);

  /// Primary ray; its surface, where it can be lit, goes to `lane`, all that follow to the secondary samples.
  void follow(const Ray& ray, const Hit& hit, ViewTile& tile, int lane, ViewSamples& out) {
    shade({ray, vec3(1.0f), 0}, hit, &tile, lane, &out);
    while (!pending_.empty()) {
      const EyePath path = pending_.back();
      pending_.pop_back();
      shade(path, in_.trace.closestHit(path.ray), nullptr, 0, nullptr);
    }
  }

 private:
  void shade(const EyePath& path, const Hit& hit, ViewTile* tile, int lane, ViewSamples* out) {
    emitted += path.throughput * shapeLightRadiance(in_.trace.scene(), path.ray, hit);
    if (!hit.valid()) return;
    const Surface s = surfaceAt(in_.trace, path.ray, hit);
    emitted += path.throughput * s.emission;
    if (out) {
      out->albedo.pixels[pixel_] = s.baseColour;
      out->normal.pixels[pixel_] = s.ns;
      out->depth.pixels[pixel_] = vec3(hit.t, 0.0f, 0.0f);
    }
    const vec3 wo = -path.ray.direction;
    if (hasNonDeltaLobe(s.bsdf) > 0.5f) {
      const ViewSample sample{s.position, s.ng, s.ns, wo, s.bsdf, path.throughput, pixel_};
      if (tile)
        setLane(*tile, lane, sample);
      else
        secondary_.push_back(sample);
    }
    if (hasDeltaLobe(s.bsdf) > 0.5f && path.depth < mirrorDepth_) scatterSpecularly(path, s, wo);
  }

  void scatterSpecularly(const EyePath& path, const Surface& s, vec3 wo) {
    const float cosO = abs(dot(wo, s.ns));
    const vec3 reflected = s.bsdf.alpha > 0.0f ? vec3(0.0f) : mirrorReflectance(s.bsdf, cosO, s.entering);
    const vec3 refracted = refractedPart(s.bsdf, cosO, s.entering);
    const float r = meanOf(reflected);
    const float t = meanOf(refracted);
    if (r + t <= 0.0f) return;
    const vec3 u = random3(key_, event_++, 0);
    const bool both = path.depth < kSplitDepth;
    const bool reflect = u.x * (r + t) < r;
    const float odds = both ? 1.0f : reflect ? (r + t) / r : (r + t) / t;
    if (r > 0.0f && (both || reflect)) {
      const vec3 direction = mirrorDirection(wo, s.ng, s.ns);
      push(path, s, direction, reflected * odds, u.y);
    }
    if (t > 0.0f && (both || !reflect)) {
      float etaScale = 1.0f;
      const vec3 direction = refractionOf(s.bsdf, wo, s.ng, s.ns, s.entering, etaScale);
      push(path, s, direction, refracted * (odds * etaScale), u.z);
    }
  }

  void push(const EyePath& path, const Surface& s, vec3 direction, vec3 weight, float u) {
    vec3 throughput = path.throughput * weight;
    const float survival = min(maxOf(throughput) / kRouletteThroughput, 1.0f);
    if (u >= survival) return;
    throughput = throughput / survival;
    pending_.push_back({rayFrom(s.position, s.ng, direction), throughput, path.depth + 1});
  }

  const Gbuffer::In& in_;
  std::uint32_t mirrorDepth_;
  std::uint32_t pixel_;
  std::uint32_t key_;
  std::uint32_t event_ = 0;
  std::vector<ViewSample>& secondary_;
  std::vector<EyePath> pending_;
};

void sizeFor(const Gbuffer::In& in, ViewSamples& out) {
  out.width = in.width;
  out.height = in.height;
  out.tilesX = (in.width + kTileSide - 1) / kTileSide;
  out.tilesY = (in.height + kTileSide - 1) / kTileSide;
  out.camera = in.camera;
  out.primaryTiles = std::size_t(out.tilesX) * std::size_t(out.tilesY);
  out.tiles.resize(out.primaryTiles);
  for (Image* image : {&out.emitted, &out.albedo, &out.normal, &out.depth}) {
    image->width = in.width;
    image->height = in.height;
    image->pixels.assign(std::size_t(in.width) * std::size_t(in.height), vec3(0.0f));
  }
}

void traceTile(const Gbuffer::In& in, std::uint32_t mirrorDepth, std::size_t index, ViewSamples& out,
               std::vector<ViewSample>& secondary) {
  ViewTile& tile = out.tiles[index];
  clearTile(tile);
  const int x0 = int(index % std::size_t(out.tilesX)) * kTileSide;
  const int y0 = int(index / std::size_t(out.tilesX)) * kTileSide;
  const vec2 size(float(in.width), float(in.height));
  constexpr int kPacket = 16;
  for (int first = 0; first < kTileLanes; first += kPacket) {
    std::array<Ray, kPacket> rays;
    std::array<Hit, kPacket> hits;
    for (int i = 0; i < kPacket; ++i) {
      const vec2 pixel(float(x0 + (first + i) % kTileSide), float(y0 + (first + i) / kTileSide));
      const vec2 p = imagePlaneFromPixel(pixel + in.subpixel, size);
      rays[std::size_t(i)] = {cameraRayOrigin(in.camera, p), 0.0f, cameraRayDirection(in.camera, p), 1e30f};
    }
    in.trace.closestHits(rays, hits, true);
    for (int i = 0; i < kPacket; ++i) {
      const int lane = first + i;
      const int x = x0 + lane % kTileSide;
      const int y = y0 + lane / kTileSide;
      if (x >= in.width || y >= in.height) continue;
      const auto pixel = std::uint32_t(y) * std::uint32_t(in.width) + std::uint32_t(x);
      PixelPaths paths(in, mirrorDepth, pixel, secondary);
      paths.follow(rays[std::size_t(i)], hits[std::size_t(i)], tile, lane, out);
      out.emitted.pixels[pixel] = paths.emitted;
    }
  }
}

std::uint32_t spreadBits(std::uint32_t x) {
  x &= 0x3ffu;
  x = (x | (x << 16)) & 0x030000ffu;
  x = (x | (x << 8)) & 0x0300f00fu;
  x = (x | (x << 4)) & 0x030c30c3u;
  return (x | (x << 2)) & 0x09249249u;
}

/// Packs the samples into tiles along a Morton curve, so that the lanes of a tile lie close together.
void appendSecondaryTiles(const std::vector<std::vector<ViewSample>>& perTile, ViewSamples& out) {
  struct Key {
    std::uint32_t morton;
    std::uint32_t order;
    const ViewSample* sample;
  };
  Bounds bounds;
  std::vector<Key> keys;
  for (const auto& samples : perTile)
    for (const ViewSample& s : samples) {
      bounds.extend(s.position);
      keys.push_back({0, std::uint32_t(keys.size()), &s});
    }
  const vec3 scale = vec3(1023.0f) / max(bounds.size(), vec3(1e-20f));
  for (Key& key : keys) {
    const vec3 p = (key.sample->position - bounds.lower) * scale;
    key.morton = spreadBits(std::uint32_t(p.x)) | (spreadBits(std::uint32_t(p.y)) << 1) |
                 (spreadBits(std::uint32_t(p.z)) << 2);
  }
  tbb::parallel_sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return a.morton != b.morton ? a.morton < b.morton : a.order < b.order;
  });
  const std::size_t tiles = (keys.size() + kTileLanes - 1) / kTileLanes;
  out.tiles.resize(out.primaryTiles + tiles);
  for (std::size_t t = 0; t < tiles; ++t) {
    ViewTile& tile = out.tiles[out.primaryTiles + t];
    clearTile(tile);
    for (std::size_t lane = 0; lane < kTileLanes && t * kTileLanes + lane < keys.size(); ++lane)
      setLane(tile, int(lane), *keys[t * kTileLanes + lane].sample);
  }
}

}  // namespace

void Gbuffer::run(const In& in, ViewSamples& out, Stats& stats, const Job& job) const {
  const auto scope = stats.scope("gbuffer");
  sizeFor(in, out);
  std::vector<std::vector<ViewSample>> secondary(out.primaryTiles);
  tbb::parallel_for(std::size_t(0), out.primaryTiles, [&](std::size_t tile) {
    if (job.stop.stop_requested()) return;
    traceTile(in, settings_.mirrorDepth, tile, out, secondary[tile]);
  });
  job.throwIfStopped();
  appendSecondaryTiles(secondary, out);

  std::uint64_t samples = 0;
  for (const ViewTile& tile : out.tiles) samples += tile.count;
  stats.setCounter("gbuffer.viewSamples", double(samples));
  stats.setCounter("gbuffer.tiles", double(out.tiles.size()));
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/direct/soft_shadows.h"

#include "math/rng.shared.h"
#include "trace/surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace isophote::direct {

namespace {

constexpr std::uint32_t kTurnStream = 0x7475726eu;
/// Widest penumbra that is looked for, in widths of the picture: wider ones are cut.
constexpr float kWidestPart = 0.5f;

template <class Sample>
SHARED_FN void aimAt(const ViewTile& tile, LightAim& __restrict out, Sample&& sample) {
  alignas(64) float shines[kTileLanes];
  for (int i = 0; i < kTileLanes; ++i) {
    const vec3 position = positionOf(tile, i);
    const vec3 ng = ngOf(tile, i);
    const LightSample l = sample(position);
    out.origin.set(i, offsetFrom(position, ng, l.wi));
    out.wiX[i] = l.wi.x;
    out.wiY[i] = l.wi.y;
    out.wiZ[i] = l.wi.z;
    out.distance[i] = l.distance;
    shines[i] = dot(l.wi, ng) > 0.0f ? max(l.radiance.x, max(l.radiance.y, l.radiance.z)) : 0.0f;
  }
  out.lit = bitsWhere([&](int i) __attribute__((always_inline)) {
    return shines[i] > 0.0f && tile.pixel[i] != kNoPixel;
  });
}

SHARED_FN void aimBody(const Light& light, const ViewTile& tile, LightAim& out) {
  if (light.type == kLightPoint) {
    Light point = light;
    point.radius = 0.0f;
    aimAt(
        tile,
        out, [&](vec3 from) __attribute__((always_inline)) { return samplePoint(point, from, vec2(0.5f)); });
  } else if (light.type == kLightSpot) {
    aimAt(
        tile, out, [&](vec3 from) __attribute__((always_inline)) { return sampleSpot(light, from); });
  } else {
    aimAt(
        tile, out, [&](vec3) __attribute__((always_inline)) { return sampleDirectional(light); });
  }
}

SHARED_FN void lookBody(const ViewTile& tile, vec3 eye, vec3 forward, float* __restrict depth,
                        std::uint32_t* __restrict normal) {
  for (int i = 0; i < kTileLanes; ++i) {
    depth[i] = dot(positionOf(tile, i) - eye, forward);
    normal[i] = packNormal10(ngOf(tile, i));
  }
}

/// How many pixels a radius of a metre on the disc spans at each lane, at most.
SHARED_FN void pixelsBody(const TapLanes& taps, FloatLanes& __restrict out) {
  for (int i = 0; i < kTileLanes; ++i) {
    // Of the disc's image, an ellipse about the point, the change of w over it left out.
    const float w = max(abs(taps.w[i]), 1e-20f), px = taps.x[i] / w, py = taps.y[i] / w;
    const float ux = taps.xU[i] - px * taps.wU[i], vx = taps.xV[i] - px * taps.wV[i];
    const float uy = taps.yU[i] - py * taps.wU[i], vy = taps.yV[i] - py * taps.wV[i];
    out[i] = sqrt(max(ux * ux + vx * vx, uy * uy + vy * vy)) / w;
  }
}

ISOPHOTE_SIMD(aim, aimBody, (const Light& light, const ViewTile& tile, LightAim& out), (light, tile, out))
ISOPHOTE_SIMD(look, lookBody,
              (const ViewTile& tile, vec3 eye, vec3 forward, float* depth, std::uint32_t* normal),
              (tile, eye, forward, depth, normal))
ISOPHOTE_SIMD(pixels, pixelsBody, (const TapLanes& taps, FloatLanes& out), (taps, out))
ISOPHOTE_SIMD(setUpTaps, setUpTapsBody,
              (const Screen& screen, const ViewTile& tile, const LightAim& aim, const FloatLanes& turnSine,
               const FloatLanes& turnCosine, TapLanes& out),
              (screen, tile, aim, turnSine, turnCosine, out))
ISOPHOTE_SIMD(search, searchBody,
              (const Screen& screen, const TapLanes& taps, const LightAim& aim, float size, float parallel,
               float reach, std::span<const DiscTap> disc, const FloatLanes& own, FloatLanes& out),
              (screen, taps, aim, size, parallel, reach, disc, own, out))
ISOPHOTE_SIMD(blur, blurBody,
              (const Screen& screen, const TapLanes& taps, const FloatLanes& radius,
               std::span<const DiscTap> disc, const FloatLanes& own, FloatLanes& out),
              (screen, taps, radius, disc, own, out))
ISOPHOTE_SIMD(smoothen, smoothBody,
              (const Screen& screen, const float* visible, const float* penumbra, const TapLanes& taps,
               int tileX, int tileY, std::size_t first, FloatLanes& out),
              (screen, visible, penumbra, taps, tileX, tileY, first, out))

/// Every pixel of 4 x 4 turns its disc by another sixteenth of a turn, neighbours by far apart ones.
constexpr int kTurns[16] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};

}  // namespace

void SoftShadows::start(const In& in, const Job& job) {
  in_ = &in;
  const std::size_t tiles = in.view.primaryTiles, lanes = tiles * kTileLanes;
  depth_.resize(lanes);
  normal_.resize(lanes);
  occluder_.resize(lanes);
  visible_.resize(lanes);
  penumbra_.resize(lanes);
  own_.resize(tiles);
  inRow_.resize(tiles);
  reaching_.resize(tiles);
  litTiles_.resize(std::size_t(in.view.tilesX + 1) * std::size_t(in.view.tilesY + 1));
  raysOfTile_.resize(tiles);
  blurredTile_.resize(tiles);
  spiralTaps(in.options.searchSamples, true, searchDisc_);
  spiralTaps(in.options.blurSamples, false, blurDisc_);
  const float first = in.pass == 0 ? 0.0f : unitFloat(hash3(uvec3(in.pass, 0u, kTurnStream)).x);
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const int turn = kTurns[((lane >> 3) & 3) * 4 + (lane & 3)];
    const float angle = 2.0f * kPi * (float(turn) / 16.0f + first);
    turnSine_[std::uint32_t(lane)] = std::sin(angle);
    turnCosine_[std::uint32_t(lane)] = std::cos(angle);
  }
  const auto lookAt = lookFor(in.simd);
  tbb::parallel_for(std::size_t(0), tiles, [&](std::size_t t) {
    if (job.stop.stop_requested()) return;
    lookAt(in.view.tiles[t], in.view.camera.eye, in.view.camera.forward, &depth_[t * kTileLanes],
           &normal_[t * kTileLanes]);
  });
  job.throwIfStopped();
}

Screen SoftShadows::screen() const {
  const ViewSamples& v = in_->view;
  const CameraRays& c = v.camera;
  return {depth_.data(), normal_.data(), occluder_.data(), v.width, v.height, v.tilesX,
          in_->subpixel, c.eye,          c.forward,        c.right, c.up,     c.orthographic};
}

void SoftShadows::setUp(const SoftLight& light, std::size_t tile, LightAim& aim, TapLanes& taps) const {
  aimFor(in_->simd)(light.light, in_->view.tiles[tile], aim);
  setUpTapsFor(in_->simd)(screen(), in_->view.tiles[tile], aim, turnSine_, turnCosine_, taps);
}

void SoftShadows::castHardShadow(const SoftLight& light, std::size_t tile) {
  constexpr std::size_t kPacket = 16;
  LightAim aim;
  TapLanes taps;
  FloatLanes pixelsOfMetre;
  setUp(light, tile, aim, taps);
  float* const occluder = &occluder_[tile * kTileLanes];
  std::fill_n(occluder, kTileLanes, kUnlit);
  std::array<int, kTileLanes> lanes;
  std::size_t count = 0;
  Vec3Lanes<kTileLanes> origin, direction;
  for (std::uint64_t left = aim.lit; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    lanes[count] = lane;
    origin.set(std::uint32_t(count), aim.origin[std::uint32_t(lane)]);
    direction.set(std::uint32_t(count), vec3(aim.wiX[lane], aim.wiY[lane], aim.wiZ[lane]));
    ++count;
  }
  TileShadow& own = own_[tile];
  own = {};
  raysOfTile_[tile] = std::uint32_t(count);
  if (count == 0) return;
  pixelsFor(in_->simd)(taps, pixelsOfMetre);
  const float widest = kWidestPart * float(in_->view.width);
  for (std::size_t i = 0; i < count; i += kPacket) {
    std::array<Hit, kPacket> hits;
    const std::size_t rays = std::min(kPacket, count - i);
    const RayColumns columns{{&origin.x.values[i], &origin.y.values[i], &origin.z.values[i]},
                             {&direction.x.values[i], &direction.y.values[i], &direction.z.values[i]}};
    in_->trace.closestHits(columns, std::span(hits).first(rays), true);
    for (std::size_t k = 0; k < rays; ++k) {
      const auto lane = std::uint32_t(lanes[i + k]);
      const bool blocked = hits[k].valid() && hits[k].t < aim.distance[lane] * (1.0f - 1e-4f);
      occluder[lane] = blocked ? std::max(hits[k].t, 1e-20f) : kLit;
      if (!blocked) continue;
      const float fixed = in_->options.fixedRadius;
      const float metres = fixed > 0.0f ? fixed
                                        : penumbraRadius(light.size, light.parallel() ? 1.0f : 0.0f,
                                                         occluder[lane], aim.distance[lane]);
      own.metres = std::max(own.metres, metres);
      own.pixels = std::max(own.pixels, std::min(metres * pixelsOfMetre[lane], widest));
    }
  }
}

void SoftShadows::spreadReach() {
  const int w = in_->view.tilesX, h = in_->view.tilesY;
  float widest = 0.0f;
  for (const TileShadow& shadow : own_) widest = std::max(widest, shadow.pixels);
  const int tiles = int(widest / float(kTileSide)) + 1;
  const auto spread = [&](const TileShadow* from, std::ptrdiff_t step, int at, int count) {
    TileShadow sum;
    for (int k = std::max(at - tiles, 0); k <= std::min(at + tiles, count - 1); ++k) {
      const TileShadow& other = from[(k - at) * step];
      const bool reaches = other.metres > 0.0f && float((std::abs(k - at) - 1) * kTileSide) <= other.pixels;
      sum.metres = reaches ? std::max(sum.metres, other.metres) : sum.metres;
      sum.pixels = reaches ? std::max(sum.pixels, other.pixels) : sum.pixels;
    }
    return sum;
  };
  tbb::parallel_for(0, h, [&](int y) {
    const std::size_t row = std::size_t(y) * std::size_t(w);
    for (int x = 0; x < w; ++x) inRow_[row + std::size_t(x)] = spread(&own_[row + std::size_t(x)], 1, x, w);
  });
  tbb::parallel_for(0, h, [&](int y) {
    const std::size_t row = std::size_t(y) * std::size_t(w);
    for (int x = 0; x < w; ++x)
      reaching_[row + std::size_t(x)] = spread(&inRow_[row + std::size_t(x)], w, y, h);
  });
  // Sums by which any rectangle of tiles tells whether anything in it is lit.
  std::fill_n(litTiles_.begin(), w + 1, 0u);
  for (int y = 0; y < h; ++y) {
    const std::size_t row = std::size_t(y + 1) * std::size_t(w + 1);
    std::uint32_t sum = 0;
    litTiles_[row] = 0;
    for (int x = 0; x < w; ++x) {
      const float* const lanes = &occluder_[(std::size_t(y) * std::size_t(w) + std::size_t(x)) * kTileLanes];
      sum += std::find(lanes, lanes + kTileLanes, kLit) != lanes + kTileLanes;
      litTiles_[row + std::size_t(x) + 1] = litTiles_[row - std::size_t(w) + std::size_t(x)] + sum;
    }
  }
}

bool SoftShadows::anyLit(std::size_t tile) const {
  const int w = in_->view.tilesX, h = in_->view.tilesY;
  const int x = int(tile) % w, y = int(tile) / w, around = int(reaching_[tile].pixels / float(kTileSide)) + 1;
  const auto sumTo = [&](int toX, int toY) {
    return litTiles_[std::size_t(toY) * std::size_t(w + 1) + std::size_t(toX)];
  };
  const int x0 = std::max(x - around, 0), x1 = std::min(x + around + 1, w);
  const int y0 = std::max(y - around, 0), y1 = std::min(y + around + 1, h);
  return sumTo(x1, y1) + sumTo(x0, y0) != sumTo(x0, y1) + sumTo(x1, y0);
}

bool SoftShadows::blurTile(const SoftLight& light, std::size_t tile) {
  const std::size_t first = tile * kTileLanes;
  float* const visible = &visible_[first];
  float* const penumbra = &penumbra_[first];
  FloatLanes own;
  std::copy_n(&occluder_[first], kTileLanes, own.values);
  const TileShadow reach = reaching_[tile];
  if (raysOfTile_[tile] == 0 || reach.metres == 0.0f || !anyLit(tile)) {
    for (int i = 0; i < kTileLanes; ++i) visible[i] = own.values[i] > 0.0f ? 0.0f : 1.0f;
    std::fill_n(penumbra, kTileLanes, 0.0f);
    return false;
  }
  LightAim aim;
  TapLanes taps;
  FloatLanes radius, blurred, pixelsOfMetre;
  setUp(light, tile, aim, taps);
  if (in_->options.fixedRadius > 0.0f)
    std::fill_n(radius.values, kTileLanes, in_->options.fixedRadius);
  else
    searchFor(in_->simd)(screen(), taps, aim, light.size, light.parallel() ? 1.0f : 0.0f, reach.metres,
                         searchDisc_, own, radius);
  blurFor(in_->simd)(screen(), taps, radius, blurDisc_, own, blurred);
  pixelsFor(in_->simd)(taps, pixelsOfMetre);
  for (std::uint32_t i = 0; i < kTileLanes; ++i) {
    visible[i] = blurred[i];
    penumbra[i] = radius[i] * pixelsOfMetre[i];
  }
  return true;
}

void SoftShadows::gather(const SoftLight& light, const Job& job) {
  const std::size_t tiles = in_->view.primaryTiles;
  tbb::parallel_for(std::size_t(0), tiles, [&](std::size_t t) {
    if (job.stop.stop_requested()) return;
    if (t + 1 < tiles) wantPlaces(in_->view.tiles[t + 1]);
    castHardShadow(light, t);
  });
  job.throwIfStopped();
  rays_ = std::accumulate(raysOfTile_.begin(), raysOfTile_.end(), std::uint64_t(0));
  spreadReach();
  job.throwIfStopped();
  tbb::parallel_for(std::size_t(0), tiles, [&](std::size_t t) {
    if (job.stop.stop_requested()) return;
    blurredTile_[t] = blurTile(light, t);
  });
  job.throwIfStopped();
  blurred_ = std::accumulate(blurredTile_.begin(), blurredTile_.end(), std::uint64_t(0));
}

void SoftShadows::lookUp(const ShadowMaps& maps, std::uint32_t index, const SoftLight& light,
                         const Job& job) {
  rays_ = 0;
  tbb::parallel_for(std::size_t(0), in_->view.primaryTiles, [&](std::size_t t) {
    if (job.stop.stop_requested()) return;
    LightAim aim;
    TapLanes taps;
    FloatLanes visible, metres, pixelsOfMetre;
    setUp(light, t, aim, taps);
    if (aim.lit != 0) {
      maps.softVisibility(index, {light.size, searchDisc_, blurDisc_, turnSine_, turnCosine_},
                          in_->view.tiles[t], aim.lit, visible, metres, in_->simd);
      pixelsFor(in_->simd)(taps, pixelsOfMetre);
    }
    std::uint8_t soft = 0;
    for (std::uint32_t i = 0; i < kTileLanes; ++i) {
      const std::size_t at = t * kTileLanes + i;
      visible_[at] = visible[i];
      penumbra_[at] = metres[i] * pixelsOfMetre[i];
      occluder_[at] = (aim.lit >> i & 1u) != 0u ? kLit : kUnlit;
      soft |= std::uint8_t(penumbra_[at] > 0.0f);
    }
    blurredTile_[t] = soft;
  });
  job.throwIfStopped();
  blurred_ = std::accumulate(blurredTile_.begin(), blurredTile_.end(), std::uint64_t(0));
}

void SoftShadows::visibility(const SoftLight& light, std::size_t tile, FloatLanes& out) const {
  const std::size_t first = tile * kTileLanes;
  if (!in_->options.smooth || blurredTile_[tile] == 0) {
    std::copy_n(&visible_[first], kTileLanes, out.values);
    return;
  }
  LightAim aim;
  TapLanes taps;
  setUp(light, tile, aim, taps);
  const int w = in_->view.tilesX;
  smoothenFor(in_->simd)(screen(), visible_.data(), penumbra_.data(), taps, int(tile) % w * kTileSide,
                         int(tile) / w * kTileSide, first, out);
}

void SoftShadows::visibility(const ShadowMaps& maps, std::uint32_t index, const SoftLight& light,
                             const ViewTile& tile, std::uint64_t lanes, FloatLanes& out) const {
  FloatLanes penumbra;
  maps.softVisibility(index, {light.size, searchDisc_, blurDisc_, turnSine_, turnCosine_}, tile, lanes, out,
                      penumbra, in_->simd);
}

std::uint64_t SoftShadows::bytes() const {
  return (depth_.size() + occluder_.size() + visible_.size() + penumbra_.size() + normal_.size()) * 4;
}

}  // namespace isophote::direct

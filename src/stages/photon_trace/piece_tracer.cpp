// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/piece_tracer.h"

#include "math/simd.h"

#include <algorithm>

namespace isophote {

namespace {

/// Paths of a light, at least, whose first rays Embree follows faster in its mode for coherent rays.
constexpr std::uint32_t kCoherentPaths = 1u << 16;

ISOPHOTE_SIMD(drawSobol, sobolBody,
              (const PathRandom& random, std::uint32_t dimension, const std::uint32_t* paths,
               const std::uint32_t* lights, std::uint32_t count, float* out),
              (random, dimension, paths, lights, count, out))

SHARED_FN void keysOfFirstRays(const float* x, const float* y, std::uint32_t slot, std::uint32_t count,
                               KeyedRay* __restrict rays) {
  constexpr float kCells = float(1u << (kFirstKeyBits / 2));
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t key =
        spreadByOne(std::uint32_t(int(x[i] * kCells))) | spreadByOne(std::uint32_t(int(y[i] * kCells))) << 1;
    rays[i] = {key, slot + i};
  }
}
ISOPHOTE_SIMD(keysOfFirst, keysOfFirstRays,
              (const float* x, const float* y, std::uint32_t slot, std::uint32_t count, KeyedRay* rays),
              (x, y, slot, count, rays))

SHARED_FN void keysOfLanes(const RayKeys& keys, const HitLanes& lanes, HitColumn<std::uint32_t>& out) {
  for (std::uint32_t i = 0; i < kHitLanes; ++i) out[i] = keys.key(lanes.origin[i], lanes.direction[i]);
}
ISOPHOTE_SIMD(keysOf, keysOfLanes,
              (const RayKeys& keys, const HitLanes& lanes, HitColumn<std::uint32_t>& out), (keys, lanes, out))

}  // namespace

void keyFirstRays(const PathRandom& random, const PathRange& range, std::uint32_t slot,
                  std::span<KeyedRay> rays) {
  const SimdLevel level = bestSimdLevel();
  const std::uint32_t count = std::uint32_t(rays.size());
  Column<std::uint32_t> paths, lights;
  Column<float> x, y;
  for (std::uint32_t i = 0; i < count; ++i) {
    paths[i] = range.first + (slot - range.slot) + i;
    lights[i] = range.light;
  }
  drawSobolFor(level)(random, kMainDimension, paths.values, lights.values, count, x.values);
  drawSobolFor(level)(random, kMainDimension + 1, paths.values, lights.values, count, y.values);
  keysOfFirstFor(level)(x.values, y.values, slot, count, rays.data());
}

void PieceTracer::emit(const PathTracing& tracing, const PathRange& range, std::span<const KeyedRay> order,
                       PieceResult& result) {
  const Scene& scene = tracing.trace.scene();
  const Light& light = tracing.trace.lights()[range.light];
  const std::uint32_t count = std::uint32_t(order.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    paths_.path[i] = range.first + (order[i].index - range.slot);
    paths_.light[i] = range.light;
    paths_.density[i] = 1.0f;
    paths_.medium[i] = 0u;
  }
  for (std::uint32_t d = 0; d < emissionDimensions(light); ++d)
    drawSobolFor(bestSimdLevel())(tracing.random, d, paths_.path.values, paths_.light.values, count,
                                  u_[d].values);
  emitPaths(scene, light, u_, count, paths_);
  if (tracing.footprints())
    emitDifferentials(scene, light, u_, tracing.photonsOfLight[range.light], paths_, count,
                      differentials().ofPaths.data());
  // Of two numbers that vary, which the rays are sorted by, only direction or position can be made.
  coherent_ = emissionDimensions(light) == 2 && range.count >= kCoherentPaths;
  count_ = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 power = paths_.power[i] * range.share;
    result.powerEmitted += double(meanOf(power));
    if (!(maxOf(power) > 0.0f)) continue;
    paths_.path[count_] = paths_.path[i];
    paths_.origin.set(count_, paths_.origin[i]);
    paths_.direction.set(count_, paths_.direction[i]);
    paths_.power.set(count_, power);
    if (tracing.footprints()) differentials_->ofPaths[count_] = differentials_->ofPaths[i];
    ++count_;
  }
}

void PieceTracer::load(std::span<const PathState> paths, std::span<const KeyedRay> order) {
  constexpr std::size_t kAhead = 12;
  count_ = std::uint32_t(order.size());
  coherent_ = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const PathState& ahead = paths[order[std::min<std::size_t>(i + kAhead, count_ - 1)].index];
    __builtin_prefetch(&ahead);
    __builtin_prefetch(&ahead.light);
    paths_.set(i, paths[order[i].index]);
  }
}

void PieceTracer::loadDifferentials(std::span<const PathDifferential> from, std::span<const KeyedRay> order) {
  std::array<PathDifferential, kRaysPerPiece>& to = differentials().ofPaths;
  for (std::size_t i = 0; i < order.size(); ++i) to[i] = from[order[i].index];
}

PieceTracer::Differentials& PieceTracer::differentials() {
  if (!differentials_) differentials_ = std::make_unique<Differentials>();
  return *differentials_;
}

void PieceTracer::record(PieceResult& result) const {
  for (std::uint32_t i = 0; i < count_; ++i)
    result.rays.push_back(
        {{paths_.origin[i], 0.0f, paths_.direction[i], 1e30f}, paths_.light[i], paths_.path[i]});
}

/// Full lanes of hits wait until the next rays are traced before they are placed, and placed ones until the
/// next are placed before they are shaded.
void PieceTracer::trace(const PathTracing& tracing, std::uint32_t bounce, const PieceRoom& room,
                        PieceResult& result) {
  if (tracing.recordRays) record(result);
  std::array<Hit, kRaysAtOnce> hits;
  std::uint32_t found = 0, placed = 0;  // groups of hits; number `found` is being filled
  mean_ = absorbed_ = {};
  const auto group = [&](std::uint32_t i) -> HitLanes& { return lanes_[i % lanes_.size()]; };
  const auto placeNext = [&] {
    group(placed).place(tracing.trace, paths_, queue_);
    if (placed > 0) shade(tracing, bounce, group(placed - 1), room, result);
    ++placed;
  };
  group(0).clear();
  for (std::uint32_t first = 0; first < count_; first += kRaysAtOnce) {
    const std::uint32_t count = std::min(count_ - first, kRaysAtOnce);
    traceRays(tracing.trace, first, {hits.data(), count});
    const bool ready = placed < found;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!hits[i].valid()) {
        result.powerEscaped += double(meanOf(paths_.power[first + i]));
        continue;
      }
      group(found).add(tracing.trace, hits[i], first + i, queue_);
      if (group(found).count == kHitLanes) group(++found).clear();
    }
    if (ready) placeNext();
  }
  const std::uint32_t rest = group(found).count;
  result.hits += found * kHitLanes + rest;
  if (placed < found) placeNext();
  if (rest > 0) placeNext();
  if (placed > 0) shade(tracing, bounce, group(placed - 1), room, result);
  for (std::uint32_t i = 0; i < kHitLanes; ++i) {
    if (bounce == tracing.bounces) result.powerEnded += double(mean_[i]);
    result.powerAbsorbed += double(absorbed_[i]);
  }
}

void PieceTracer::traceRays(const TraceScene& trace, std::uint32_t first, std::span<Hit> hits) {
  const VectorColumn &o = paths_.origin, &d = paths_.direction;
  queue_.ask(kHitLanes * kAskedAtOnce);
  trace.closestHits({{&o.x[first], &o.y[first], &o.z[first]}, {&d.x[first], &d.y[first], &d.z[first]}}, hits,
                    coherent_);
}

void PieceTracer::store(const HitLanes& lanes, std::uint32_t bounce, const PieceRoom& room,
                        PieceResult& result) const {
  // Written whether it is kept or not: cheaper than a branch that fails to be foreseen. Never beyond the
  // room, as no more have been stored than rays came before this one.
  for (std::uint32_t i = 0; i < lanes.count; ++i) {
    room.photons[result.stored] = {
        lanes.points.position[i], lanes.density[i],      lanes.power[i] * lanes.storedShare[i],
        lanes.packedDirection[i], lanes.packedNormal[i], bounce};
    result.stored += lanes.stores[i];
  }
}

/// Of the photons that store() stores from place `stored` on.
void PieceTracer::storeFootprints(const HitLanes& lanes, const PieceRoom& room, std::uint32_t stored) const {
  for (std::uint32_t i = 0; i < lanes.count; ++i) {
    room.footprints[stored] = differentials_->lanes.footprint(lanes, i);
    stored += lanes.stores[i];
  }
}

/// Of the photons that shade() hands on from place `survivors` on.
void PieceTracer::handOnDifferentials(const HitLanes& lanes, const PieceRoom& room, std::uint32_t survivors) {
  differentials_->lanes.leave(lanes);
  for (std::uint32_t i = 0; i < lanes.count; ++i) {
    room.differentials[survivors] = differentials_->lanes.leaving(i);
    survivors += lanes.survives[i];
  }
}

/// Stores what arrived, and hands on the photons that are scattered.
void PieceTracer::shade(const PathTracing& tracing, std::uint32_t bounce, HitLanes& lanes,
                        const PieceRoom& room, PieceResult& result) {
  lanes.arrive(tracing.trace, queue_);
  queue_.ask(kAskedAtOnce);
  if (tracing.footprints())
    differentials_->lanes.arrive(lanes, paths_, differentials_->ofPaths.data(), tracing.photonsOfLight);
  if (bounce > 0) {
    if (tracing.footprints()) storeFootprints(lanes, room, result.stored);
    store(lanes, bounce, room, result);
  }
  if (bounce == tracing.bounces) {
    lanes.addTo(mean_, lanes.mean);
    return;
  }
  lanes.scatter(tracing.random, bounce);
  lanes.addTo(absorbed_, lanes.absorbed);
  queue_.ask(kAskedAtOnce);
  if (tracing.footprints()) handOnDifferentials(lanes, room, result.survivors);
  HitColumn<std::uint32_t> keys;
  keysOfFor(bestSimdLevel())(tracing.keys, lanes, keys);
  for (std::uint32_t i = 0; i < lanes.count; ++i) {
    const std::uint32_t next = result.survivors;
    room.paths[next] = {lanes.origin[i], lanes.density[i], lanes.direction[i], lanes.path[i],
                        lanes.power[i],  lanes.light[i],   lanes.medium[i]};
    room.rays[next] = {keys[i], room.firstIndex + next};
    result.survivors += lanes.survives[i];
  }
}

}  // namespace isophote

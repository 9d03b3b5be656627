// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/path_block.h"

#include <algorithm>
#include <numeric>

namespace isophote {

namespace {

ISOPHOTE_SIMD(drawSobol, sobolBody,
              (const BlockRandom& random, std::uint32_t dimension, const std::uint32_t* paths,
               std::uint32_t count, float* out),
              (random, dimension, paths, count, out))
/// Interleaves the bits of x and y, both below 32.
std::uint32_t mortonCode(std::uint32_t x, std::uint32_t y) {
  const auto spread = [](std::uint32_t v) {
    v = (v | (v << 4)) & 0x0f0fu;
    v = (v | (v << 2)) & 0x3333u;
    return (v | (v << 1)) & 0x5555u;
  };
  return spread(x) | (spread(y) << 1);
}

}  // namespace

void PathBlock::trace(const PathTracing& tracing, const PathRange& range, const Job& job, RangeOutput& out) {
  out.photons.clear();
  out.rays.clear();
  out.hitsPerBounce.assign(std::size_t(tracing.bounces) + 1, 0);
  out.powerEmitted = out.powerAbsorbed = out.powerEscaped = out.powerEnded = 0;
  const std::uint32_t base = range.first / kPathsPerBlock * kPathsPerBlock;
  const BlockRandom random(tracing.sobol, tracing.seed, tracing.pass, range.light, base);
  emit(tracing, random, range, out);
  for (std::uint32_t bounce = 0; live_ > 0; ++bounce) {
    job.throwIfStopped();
    if (tracing.recordRays) record(out);
    traceSegment(tracing, random, bounce, out);
  }
}

/// Puts the paths in an order in which neighbours leave the light in similar directions, and draws their main
/// dimensions: along a Morton curve over these two, of which a whole block has one path in each of 32 x 32
/// cells.
void PathBlock::orderPaths(const BlockRandom& random, const PathRange& range) {
  const std::uint32_t first = range.first - random.base;
  std::iota(paths_.path.values, paths_.path.values + range.count, first);
  Column<float> x, y;
  const auto draw = drawSobolFor(bestSimdLevel());
  draw(random, kMainDimension, paths_.path.values, range.count, x.values);
  draw(random, kMainDimension + 1, paths_.path.values, range.count, y.values);
  std::array<std::uint32_t, kPathsPerBlock> pathOfCell;
  pathOfCell.fill(kPathsPerBlock);
  for (std::uint32_t i = 0; i < range.count; ++i)
    pathOfCell[mortonCode(std::uint32_t(x[i] * 32.0f), std::uint32_t(y[i] * 32.0f))] = i;
  std::uint32_t count = 0;
  for (const std::uint32_t i : pathOfCell) {
    if (i == kPathsPerBlock) continue;
    paths_.path[count] = first + i;
    u_[kMainDimension][count] = x[i];
    u_[kMainDimension + 1][count] = y[i];
    ++count;
  }
}

void PathBlock::emit(const PathTracing& tracing, const BlockRandom& random, const PathRange& range,
                     RangeOutput& out) {
  const Scene& scene = tracing.trace.scene();
  const Light& light = scene.lights[range.light];
  orderPaths(random, range);
  for (std::uint32_t d = kMainDimension + 2; d < emissionDimensions(light); ++d)
    drawSobolFor(bestSimdLevel())(random, d, paths_.path.values, range.count, u_[d].values);
  emitPaths(scene, light, u_, range.count, paths_);
  std::fill_n(paths_.density.values, range.count, 1.0f);
  live_ = 0;
  for (std::uint32_t i = 0; i < range.count; ++i) {
    const vec3 power = paths_.power[i];
    out.powerEmitted += double(meanOf(power));
    if (!(maxOf(power) > 0.0f)) continue;
    if (live_ < i) {
      paths_.path[live_] = paths_.path[i];
      paths_.origin.set(live_, paths_.origin[i]);
      paths_.direction.set(live_, paths_.direction[i]);
      paths_.power.set(live_, power);
    }
    ++live_;
  }
}

void PathBlock::record(RangeOutput& out) const {
  for (std::uint32_t i = 0; i < live_; ++i)
    out.rays.push_back({paths_.origin[i], 0.0f, paths_.direction[i], 1e30f});
}

/// Full lanes of hits wait until the next rays are traced before they are placed, and placed ones until the
/// next are placed before they are shaded. Slots are filled again from the front: fewer than hits have been
/// shaded, and so none whose ray or hit is still waiting.
void PathBlock::traceSegment(const PathTracing& tracing, const BlockRandom& random, std::uint32_t bounce,
                             RangeOutput& out) {
  std::array<Hit, kRaysAtOnce> hits;
  std::uint32_t found = 0, placed = 0;  // groups of hits; number `found` is being filled
  alive_ = 0;
  mean_ = absorbed_ = {};
  const auto group = [&](std::uint32_t i) -> HitLanes& { return lanes_[i % lanes_.size()]; };
  const auto placeNext = [&] {
    group(placed).place(tracing.trace, paths_, queue_);
    if (placed > 0) shade(tracing, random, bounce, group(placed - 1), out);
    ++placed;
  };
  group(0).clear();
  for (std::uint32_t first = 0; first < live_; first += kRaysAtOnce) {
    const std::uint32_t count = std::min(live_ - first, kRaysAtOnce);
    traceRays(tracing.trace, first, bounce == 0, {hits.data(), count});
    const bool ready = placed < found;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!hits[i].valid()) {
        out.powerEscaped += double(meanOf(paths_.power[first + i]));
        continue;
      }
      group(found).add(tracing.trace, hits[i], first + i, queue_);
      if (group(found).count == kLanes) group(++found).clear();
    }
    if (ready) placeNext();
  }
  const std::uint32_t rest = group(found).count;
  out.hitsPerBounce[bounce] += found * kLanes + rest;
  if (placed < found) placeNext();
  if (rest > 0) placeNext();
  if (placed > 0) shade(tracing, random, bounce, group(placed - 1), out);
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    if (bounce == tracing.bounces) out.powerEnded += double(mean_[i]);
    out.powerAbsorbed += double(absorbed_[i]);
  }
  live_ = alive_;
}

/// First segments, which leave one light in similar directions, go 16 at once. (Embree's mode for coherent
/// rays was measured slower than its plain one: a block's rays are too far apart for it.)
void PathBlock::traceRays(const TraceScene& trace, std::uint32_t first, bool sixteen, std::span<Hit> hits) {
  const VectorColumn &o = paths_.origin, &d = paths_.direction;
  if (sixteen) {
    queue_.ask(kLanes * kAskedAtOnce);
    trace.closestHits({{&o.x[first], &o.y[first], &o.z[first]}, {&d.x[first], &d.y[first], &d.z[first]}},
                      hits);
    return;
  }
  for (std::uint32_t i = 0; i < hits.size(); ++i) {
    queue_.ask(kAskedAtOnce);
    hits[i] = trace.closestHit({o[first + i], 0.0f, d[first + i]});
  }
}

/// Stores what arrived, and gives each photon that goes on the next slot of the next segment.
void PathBlock::shade(const PathTracing& tracing, const BlockRandom& random, std::uint32_t bounce,
                      HitLanes& lanes, RangeOutput& out) {
  lanes.arrive(tracing.trace, queue_);
  queue_.ask(kAskedAtOnce);
  if (bounce > 0) {
    std::array<Photon, kLanes> photons;
    std::size_t stored = 0;
    // Written whether it is kept or not: cheaper than a branch that fails to be foreseen.
    for (std::uint32_t i = 0; i < lanes.count; ++i) {
      photons[stored] = {lanes.position[i],        lanes.density[i],      lanes.power[i],
                         lanes.packedDirection[i], lanes.packedNormal[i], bounce};
      stored += lanes.stores[i];
    }
    out.photons.insert(out.photons.end(), photons.begin(), photons.begin() + std::ptrdiff_t(stored));
  }
  if (bounce == tracing.bounces) {
    lanes.addTo(mean_, lanes.mean);
    return;
  }
  lanes.scatter(random, bounce);
  lanes.addTo(absorbed_, lanes.absorbed);
  queue_.ask(kAskedAtOnce);
  for (std::uint32_t i = 0; i < lanes.count; ++i) {
    paths_.path[alive_] = lanes.path[i];
    paths_.origin.set(alive_, lanes.origin[i]);
    paths_.direction.set(alive_, lanes.direction[i]);
    paths_.power.set(alive_, lanes.power[i]);
    paths_.density[alive_] = lanes.density[i];
    alive_ += lanes.survives[i];
  }
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/path_block.h"

#include "physics/emission.shared.h"
#include "trace/surface.h"

#include <algorithm>
#include <numeric>

namespace isophote {

namespace {

ISOPHOTE_SIMD(drawSobol, sobolBody,
              (const BlockRandom& random, std::uint32_t dimension, const std::uint32_t* paths,
               std::uint32_t count, float* out),
              (random, dimension, paths, count, out))
/// A photon that leaves its light.
struct Emission {
  Ray ray;
  vec3 power;
};

/// The triangle of a mesh light that `choice` picks in proportion to its power, as index into the light's
/// range.
std::uint32_t chooseTriangle(std::span<const EmissiveTriangle> triangles, float choice) {
  const auto found =
      std::upper_bound(triangles.begin(), triangles.end(), choice,
                       [](float u, const EmissiveTriangle& t) { return u < t.cumulativePower; });
  return std::uint32_t(std::min<std::ptrdiff_t>(found - triangles.begin(), std::ssize(triangles) - 1));
}

Emission fromPhoton(const EmittedPhoton& e) { return {{e.origin, 0.0f, e.direction, 1e30f}, e.power}; }
Emission fromSurface(const EmittedPhoton& e, vec3 normal) {
  return {rayFrom(e.origin, normal, e.direction), e.power};
}

Emission emitFromMesh(const Scene& scene, const Light& light, vec2 main, vec2 other, float choice,
                      float side) {
  const std::span<const EmissiveTriangle> triangles(&scene.emissiveTriangles[light.firstTriangle],
                                                    light.triangleCount);
  const std::uint32_t chosen = chooseTriangle(triangles, choice);
  const EmissiveTriangle& t = triangles[chosen];
  const float before = chosen > 0 ? triangles[chosen - 1].cumulativePower : 0.0f;
  const EmittedPhoton e = emitTriangle(t, max(t.cumulativePower - before, 1e-30f), side, other, main);
  return fromSurface(e, normalize(cross(t.edge1, t.edge2)));
}

Emission emitFrom(const Scene& scene, const Light& light, vec2 main, vec2 other, float choice, float side) {
  switch (light.type) {
    case kLightPoint:
      return fromPhoton(emitPoint(light, other, main));
    case kLightSpot:
      return fromPhoton(emitSpot(light, main));
    case kLightDirectional:
      return fromPhoton(emitDirectional(light, scene.bounds.centre(), 0.5f * scene.bounds.size(), main));
    case kLightRectangle:
      return fromSurface(emitRectangle(light, other, main), light.direction);
    case kLightMesh:
      return emitFromMesh(scene, light, main, other, choice, side);
    default:
      return fromPhoton(emitEnvironment(light, scene.bounds.centre(), scene.bounds.radius(), other, main));
  }
}

/// Random dimensions that a light of that type uses.
std::uint32_t emissionDimensions(std::uint32_t type) {
  switch (type) {
    case kLightSpot:
    case kLightDirectional:
      return 2;
    case kLightMesh:
      return 6;
    default:
      return 4;
  }
}

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
    if (tracing.recordRays) out.rays.insert(out.rays.end(), rays_.begin(), rays_.begin() + live_);
    traceSegment(tracing, random, bounce, out);
  }
}

/// Fills path_ so that neighbours leave the light in similar directions: along a Morton curve over the two
/// main dimensions, of which a whole block has one path in each of 32 x 32 cells.
void PathBlock::orderPaths(const BlockRandom& random, const PathRange& range) {
  const std::uint32_t first = range.first - random.base;
  std::iota(path_.begin(), path_.begin() + range.count, first);
  auto draw = drawSobolFor(bestSimdLevel());
  draw(random, kMainDimension, path_.data(), range.count, u_[0].data());
  draw(random, kMainDimension + 1, path_.data(), range.count, u_[1].data());
  Slots<std::uint32_t> pathOfCell;
  pathOfCell.fill(kPathsPerBlock);
  for (std::uint32_t i = 0; i < range.count; ++i)
    pathOfCell[mortonCode(std::uint32_t(u_[0][i] * 32.0f), std::uint32_t(u_[1][i] * 32.0f))] = first + i;
  std::uint32_t count = 0;
  for (const std::uint32_t path : pathOfCell)
    if (path < kPathsPerBlock) path_[count++] = path;
}

void PathBlock::emit(const PathTracing& tracing, const BlockRandom& random, const PathRange& range,
                     RangeOutput& out) {
  const Scene& scene = tracing.trace.scene();
  const Light light = scene.lights[range.light];
  orderPaths(random, range);
  auto draw = drawSobolFor(bestSimdLevel());
  for (std::uint32_t d = 0; d < emissionDimensions(light.type); ++d)
    draw(random, d, path_.data(), range.count, u_[d].data());
  std::uint32_t alive = 0;
  for (std::uint32_t i = 0; i < range.count; ++i) {
    const Emission e =
        emitFrom(scene, light, vec2(u_[0][i], u_[1][i]), vec2(u_[2][i], u_[3][i]), u_[4][i], u_[5][i]);
    out.powerEmitted += double(meanOf(e.power));
    if (!(maxOf(e.power) > 0.0f)) continue;
    path_[alive] = path_[i];
    rays_[alive] = e.ray;
    power_[alive] = e.power;
    density_[alive] = 1.0f;
    ++alive;
  }
  live_ = alive;
}

/// Hits wait until the next rays are traced before they are placed, and placed ones until the next are placed
/// before they are shaded. Slots are filled again from the front: fewer than hits have been shaded, and so
/// none whose ray or hit is still waiting.
void PathBlock::traceSegment(const PathTracing& tracing, const BlockRandom& random, std::uint32_t bounce,
                             RangeOutput& out) {
  std::uint32_t found = 0, placed = 0, groups = 0;
  alive_ = 0;
  const auto placeNext = [&](std::uint32_t count) {
    place(tracing.trace, placed, count, lanes_[groups % 2]);
    placed += count;
    ++groups;
    if (groups > 1) shade(tracing, random, bounce, lanes_[groups % 2], out);
  };
  for (std::uint32_t first = 0; first < live_; first += kLanes) {
    const std::uint32_t foundBefore = found;
    found = traceRays(tracing.trace, first, bounce == 0, found, out);
    while (placed + kLanes <= foundBefore) placeNext(kLanes);
  }
  while (placed < found) placeNext(std::min(found - placed, kLanes));
  if (groups > 0) shade(tracing, random, bounce, lanes_[(groups - 1) % 2], out);
  out.hitsPerBounce[bounce] += found;
  live_ = alive_;
}

/// Traces the rays of 16 slots, and adds their hits to the `found` ones of before. First segments, which
/// leave one light in similar directions, go 16 at once. (Embree's mode for coherent rays was measured slower
/// than its plain one: a block's rays are too far apart for it.)
std::uint32_t PathBlock::traceRays(const TraceScene& trace, std::uint32_t first, bool sixteen,
                                   std::uint32_t found, RangeOutput& out) {
  const std::uint32_t count = std::min(live_ - first, kLanes);
  std::array<Hit, kLanes> hits;
  if (sixteen) {
    trace.closestHits({&rays_[first], count}, {hits.data(), count}, false);
  } else {
    for (std::uint32_t i = 0; i < count; ++i) hits[i] = trace.closestHit(rays_[first + i]);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (hits[i].valid()) {
      prefetchTriangle(trace, hits[i]);
      waiting_[found % kMostWaiting] = {hits[i], first + i};
      ++found;
    } else {
      out.powerEscaped += double(meanOf(power_[first + i]));
    }
  }
  return found;
}

void PathBlock::place(const TraceScene& trace, std::uint32_t first, std::uint32_t count, HitLanes& lanes) {
  lanes.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const Waiting& w = waiting_[(first + i) % kMostWaiting];
    lanes.load(trace, w.hit, rays_[w.slot].direction, path_[w.slot], power_[w.slot], density_[w.slot]);
  }
  lanes.place();
}

/// Stores what arrived, and gives each photon that goes on the next slot of the next segment.
void PathBlock::shade(const PathTracing& tracing, const BlockRandom& random, std::uint32_t bounce,
                      HitLanes& lanes, RangeOutput& out) {
  lanes.arrive(tracing.trace);
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
    out.powerEnded += double(lanes.sumOf(lanes.mean));
    return;
  }
  lanes.scatter(random, bounce);
  out.powerAbsorbed += double(lanes.sumOf(lanes.absorbed));
  for (std::uint32_t i = 0; i < lanes.count; ++i) {
    path_[alive_] = lanes.path[i];
    rays_[alive_] = {lanes.origin[i], 0.0f, lanes.direction[i], 1e30f};
    power_[alive_] = lanes.power[i];
    density_[alive_] = lanes.density[i];
    alive_ += lanes.survives[i];
  }
}

}  // namespace isophote

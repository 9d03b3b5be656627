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
ISOPHOTE_SIMD(drawHashed, hashedBody,
              (const BlockRandom& random, std::uint32_t event, const std::uint32_t* paths,
               std::uint32_t count, float* first, float* second, float* third),
              (random, event, paths, count, first, second, third))
ISOPHOTE_SIMD(drawDisc, discBody,
              (const float* first, const float* second, std::uint32_t count, float* x, float* y),
              (first, second, count, x, y))

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

/// The loop over the hits of a segment, compiled for each instruction set.
struct PathShader {
  /// What a scattering event did to one photon.
  struct Event {
    vec3 wi;
    vec3 weight;
    std::uint32_t lobe;
    float roulette;  ///< A number in [0, 1) that the choice of the lobe has left over.
  };

  /// Lambert alone: what sampleBsdf would do, with the direction drawn ahead.
  static SHARED_FN Event scatterDiffuse(const Surface& s, float choice, float x, float y) {
    const vec3 wi = basisAround(s.ns) * vec3(x, y, sqrt(max(0.0f, 1.0f - x * x - y * y)));
    return {dot(wi, s.ng) < 0.0f ? -wi : wi, s.bsdf.diffuse, kLobeDiffuse, choice};
  }

  static SHARED_FN Event scatterAny(const Surface& s, vec3 wo, vec3 u) {
    const BsdfSample sample = sampleBsdf(s.bsdf, wo, s.ng, s.ns, s.entering, u);
    const vec4 p = lobeProbabilities(s.bsdf, abs(dot(wo, s.ns)), s.entering);
    const float low = u.x < p.x               ? 0.0f
                      : u.x < p.x + p.y       ? p.x
                      : u.x < p.x + p.y + p.z ? p.x + p.y
                                              : p.x + p.y + p.z;
    const float width = u.x < p.x ? p.x : u.x < p.x + p.y ? p.y : u.x < p.x + p.y + p.z ? p.z : p.w;
    const float rest = clamp((u.x - low) / max(width, 1e-7f), 0.0f, 1.0f);
    return {sample.wi, sample.weight, sample.lobe, rest};
  }

  static SHARED_FN bool isDiffuse(const Bsdf& b) { return b.f90 == 0.0f && maxOf(b.transmission) == 0.0f; }

  /// Hits ahead of the one being shaded at which its memory is asked for.
  static constexpr std::uint32_t kTexelsAhead = 8;
  static constexpr std::uint32_t kTriangleAhead = 16;

  static SHARED_FN void prefetch(const PathBlock& block, const TraceScene& trace, std::uint32_t i) {
    const auto ahead = [&](std::uint32_t distance) {
      const Hit* hit = i + distance < block.live_ ? &block.hits_[i + distance] : nullptr;
      return hit && hit->valid() ? hit : nullptr;
    };
    if (const Hit* hit = ahead(kTriangleAhead)) prefetchTriangle(trace, *hit);
    if (const Hit* hit = ahead(kTexelsAhead)) prefetchTexels(trace, *hit);
  }

  static SHARED_FN void shade(PathBlock& block, const TraceScene& trace, std::uint32_t bounce, bool last,
                              RangeOutput& out) {
    const std::size_t stored = out.photons.size();
    if (bounce > 0) out.photons.resize(stored + block.live_);
    Photon* photon = out.photons.data() + stored;
    double absorbed = 0, escaped = 0, ended = 0;
    std::uint32_t hits = 0, alive = 0;
    for (std::uint32_t i = 0; i < block.live_; ++i) {
      prefetch(block, trace, i);
      const Hit hit = block.hits_[i];
      const Ray ray = block.rays_[i];
      const vec3 power = block.power_[i];
      const float density = block.density_[i];
      const double mean = double(meanOf(power));
      if (!hit.valid()) {
        escaped += mean;
        continue;
      }
      ++hits;
      const Surface s = surfaceAt(trace, ray, hit);
      const vec3 wo = -ray.direction;
      if (bounce > 0 && hasNonDeltaLobe(s.bsdf) > 0.5f)
        *photon++ = {s.position, density, power, packDirection(wo), packDirection(s.ng), bounce};
      if (last) {
        ended += mean;
        continue;
      }
      const Event e = isDiffuse(s.bsdf)
                          ? scatterDiffuse(s, block.u_[0][i], block.discX_[i], block.discY_[i])
                          : scatterAny(s, wo, vec3(block.u_[0][i], block.u_[1][i], block.u_[2][i]));
      const vec3 weight = e.weight * photonShadingFactor(wo, e.wi, s.ng, s.ns);
      absorbed += mean - double(meanOf(power * weight));
      const float survival = photonSurvival(power, weight);
      // Written whether it survives or not: no branch predictor foresees roulette.
      block.path_[alive] = block.path_[i];
      block.rays_[alive] = rayFrom(s.position, s.ng, e.wi);
      block.power_[alive] = power * weight * (1.0f / max(survival, 1e-37f));
      block.density_[alive] = density * pathDensityFactor(e.lobe, min(meanOf(e.weight), 1.0f));
      alive += e.roulette < survival ? 1u : 0u;
    }
    if (bounce > 0) out.photons.resize(std::size_t(photon - out.photons.data()));
    out.hitsPerBounce[bounce] += hits;
    out.powerAbsorbed += absorbed;
    out.powerEscaped += escaped;
    out.powerEnded += ended;
    block.live_ = alive;
  }
};

namespace {

ISOPHOTE_SIMD(shadeHits, PathShader::shade,
              (PathBlock & block, const TraceScene& trace, std::uint32_t bounce, bool last, RangeOutput& out),
              (block, trace, bounce, last, out))

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
    traceRays(tracing.trace, bounce == 0);
    const bool last = bounce == tracing.bounces;
    if (!last) drawEvent(random, bounce);
    shadeHitsFor(bestSimdLevel())(*this, tracing.trace, bounce, last, out);
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

/// The first segments, which leave one light in similar directions, go 16 at once. (Embree's mode for
/// coherent rays was measured slower than its plain one: a block's rays are too far apart for it.)
void PathBlock::traceRays(const TraceScene& trace, bool sixteen) {
  if (!sixteen) {
    for (std::uint32_t i = 0; i < live_; ++i) hits_[i] = trace.closestHit(rays_[i]);
    return;
  }
  for (std::uint32_t i = 0; i < live_; i += 16) {
    const std::uint32_t count = std::min(live_ - i, 16u);
    trace.closestHits({&rays_[i], count}, {&hits_[i], count}, false);
  }
}

void PathBlock::drawEvent(const BlockRandom& random, std::uint32_t event) {
  const SimdLevel level = bestSimdLevel();
  if (event < kSobolEvents) {
    for (std::uint32_t d = 0; d < 3; ++d)
      drawSobolFor(level)(random, kEventDimension + 3 * event + d, path_.data(), live_, u_[d].data());
  } else {
    drawHashedFor(level)(random, event, path_.data(), live_, u_[0].data(), u_[1].data(), u_[2].data());
  }
  drawDiscFor(level)(u_[1].data(), u_[2].data(), live_, discX_.data(), discY_.data());
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/rng.shared.h"
#include "math/sobol.shared.h"
#include "physics/shading_normal.shared.h"
#include "stages/direct/direct.h"
#include "stages/direct/light_lanes.h"
#include "trace/light_sampler.h"
#include "trace/surface.h"

#include <tbb/parallel_for.h>

#include <array>

namespace isophote {

using namespace direct;

namespace {

bool isSharp(const Bsdf& bsdf) {
  return reflectsSharply(bsdf) ||
         (bsdf.alpha > 0.0f && bsdf.alpha < kSharpAlpha && refractsRoughly(bsdf) > 0.5f);
}

/// Shadow rays of one tile that wait for a full packet, each with the radiance that it brings if nothing is
/// in its way.
class ShadowQueue {
 public:
  ShadowQueue(const TraceScene& trace, RadianceTile& out) : trace_(trace), out_(out) {}
  ~ShadowQueue() { flush(); }

  void push(const Ray& ray, int lane, vec3 radiance) {
    rays_[count_] = ray;
    lanes_[count_] = lane;
    radiances_[count_] = radiance;
    if (++count_ == rays_.size()) flush();
  }

 private:
  void flush() {
    std::array<float, 16> visible{};
    trace_.visibility(std::span(rays_).first(count_), std::span(visible).first(count_));
    for (std::size_t i = 0; i < count_; ++i) {
      if (visible[i] == 0.0f) continue;
      out_.r[lanes_[i]] += radiances_[i].x * visible[i];
      out_.g[lanes_[i]] += radiances_[i].y * visible[i];
      out_.b[lanes_[i]] += radiances_[i].z * visible[i];
    }
    count_ = 0;
  }

  const TraceScene& trace_;
  RadianceTile& out_;
  std::size_t count_ = 0;
  std::array<Ray, 16> rays_;
  std::array<int, 16> lanes_;
  std::array<vec3, 16> radiances_;
};

class TileLight {
 public:
  TileLight(const Direct::In& in, const LightSampler& lights, const ShadowMaps& shadowMaps,
            std::uint32_t areaSamples, const ViewTile& tile, RadianceTile& out)
      : in_(in),
        lights_(lights),
        shadowMaps_(shadowMaps),
        areaSamples_(areaSamples),
        tile_(tile),
        out_(out) {}

  void run() {
    out_ = {};
    if (tile_.count == 0) return;
    ShadowQueue queue(in_.trace, out_);
    for (std::uint32_t light = 0; light < lights_.lightCount(); ++light) {
      if (!shines(light)) continue;
      if (tile_.transmits == 0 && hasNoExtent(in_.trace.lights()[light])) {
        lightAll(light);
        continue;
      }
      if (tile_.transmits == 0 && isSampledInLanes(in_.trace.lights()[light])) {
        sampleAll(light);
        continue;
      }
      for (int lane = 0; lane < kTileLanes; ++lane)
        if (tile_.pixel[lane] != kNoPixel) sampleLight(light, lane, queue);
    }
    if (tile_.lambertian != 0) return;
    for (int lane = 0; lane < kTileLanes; ++lane)
      if (tile_.pixel[lane] != kNoPixel) sampleReflection(lane);
  }

 private:
  std::uint32_t keyOf(int lane) const {
    return laneKey(in_.seed, in_.pass, std::uint32_t(lane), tile_.pixel[lane]);
  }

  /// A light without extent: shaded in lanes, shadows only for those that it would reach.
  void lightAll(std::uint32_t index) const {
    LightLanes lanes;
    lightTile(in_.trace.lights()[index], tile_, lanes);
    if (lanes.lit == 0) return;
    LightVisibility visible;
    if (shadowMaps_.has(index))
      shadowMaps_.visibility(index, tile_, lanes.lit, visible);
    else
      findTraced(lanes, visible);
    addVisible(lanes, visible, out_);
  }

  /// A light with an area: each of its samples from all lanes at once.
  void sampleAll(std::uint32_t index) const {
    const AreaLanes area({.scene = in_.trace.scene(),
                          .light = in_.trace.lights()[index],
                          .tile = tile_,
                          .seed = in_.seed,
                          .pass = in_.pass,
                          .index = index,
                          .samples = areaSamples_});
    for (std::uint32_t i = 0; i < areaSamples_; ++i) {
      LightLanes lanes;
      area.sample(i, lanes);
      if (lanes.lit == 0) continue;
      LightVisibility visible;
      findTraced(lanes, visible);
      addVisible(lanes, visible, out_);
    }
  }

  void findTraced(const LightLanes& lanes, LightVisibility& visible) const {
    constexpr int kPacket = 16;
    const Vec3Lanes<kTileLanes>&o = lanes.origin, &d = lanes.wi;
    for (int i = 0; i < kTileLanes; i += kPacket) {
      const auto lit = std::uint32_t(lanes.lit >> i & 0xffffu);
      if (lit != 0u)
        in_.trace.visibility({{&o.x[i], &o.y[i], &o.z[i]}, {&d.x[i], &d.y[i], &d.z[i]}}, &lanes.distance[i],
                             lit, &visible[i]);
    }
  }

  /// Light of the side that the sample is seen from, and through rough glass that of the other.
  void sampleLight(std::uint32_t index, int lane, ShadowQueue& queue) const {
    const ViewSample s = laneOf(tile_, lane);
    sampleSide(index, lane, s, s.ng, queue);
    if (refractsRoughly(s.bsdf) > 0.5f) sampleSide(index, lane, s, -s.ng, queue);
  }

  /// ng: the geometric normal, on the side whose light is sampled.
  void sampleSide(std::uint32_t index, int lane, const ViewSample& s, vec3 ng, ShadowQueue& queue) const {
    const Light& light = in_.trace.lights()[index];
    const bool delta = hasNoExtent(light);
    const std::uint32_t samples = delta ? 1 : areaSamples_;
    const uvec3 scramble = delta ? uvec3(0u) : lightScramble(ng == s.ng ? keyOf(lane) : ~keyOf(lane), index);
    for (std::uint32_t i = 0; i < samples; ++i) {
      const LightSample l = lights_.sample(index, s.position, ng,
                                           delta ? vec3(0.5f) : scrambled(unscrambledSample(i), scramble));
      if (!(l.pdf > 0.0f) || dot(l.wi, ng) <= 0.0f) continue;
      const bool mapped = shadowMaps_.has(index);
      const float visible = mapped ? shadowMaps_.visibility(index, s.position, ng) : 1.0f;
      if (!(visible > 0.0f)) continue;
      const float ownDensity = l.pdf * float(samples);
      const float weight =
          delta || !isSharp(s.bsdf)
              ? 1.0f
              : ownDensity / (ownDensity + pdfBsdf(s.bsdf, l.wi, s.wo, s.ng, s.ns, s.entering));
      const float cosine = abs(dot(l.wi, s.ns)) * lightFade(l.wi, s.ng, s.ns);
      const vec3 radiance = evalBsdf(s.bsdf, l.wi, s.wo, s.ng, s.ns, s.entering) * l.radiance *
                            (cosine * visible * weight / ownDensity);
      if (maxOf(radiance) <= 0.0f) continue;
      if (mapped)
        add(lane, radiance);
      else
        queue.push(rayFrom(s.position, s.ng, l.wi, l.distance * (1.0f - 1e-4f)), lane, radiance);
    }
  }

  /// One sample of a sharp reflection, weighted against the samples of the lights (balance heuristic).
  void sampleReflection(int lane) const {
    const ViewSample s = laneOf(tile_, lane);
    if (!isSharp(s.bsdf)) return;
    const BsdfSample b = sampleBsdf(s.bsdf, s.wo, s.ng, s.ns, s.entering, random3(keyOf(lane), 1, 0));
    if (b.pdf <= 0.0f || b.lobe == kLobeNone) return;
    const Ray ray = rayFrom(s.position, s.ng, b.wi);
    const Hit hit = in_.trace.closestHit(ray);
    const vec3 ng = dot(b.wi, s.ng) >= 0.0f ? s.ng : -s.ng;
    lights_.visitMet(in_.trace, ray, hit, ng, [&](std::uint32_t light, vec3 radiance, float pdf) {
      if (!shines(light)) return;
      const float weight = b.pdf / (b.pdf + pdf * float(areaSamples_));
      add(lane, b.weight * radiance * (weight * b.etaScale * lightFade(b.wi, s.ng, s.ns)));
    });
  }

  bool shines(std::uint32_t light) const { return in_.shining.empty() || in_.shining[light] != 0; }

  void add(int lane, vec3 radiance) const {
    out_.r[lane] += radiance.x;
    out_.g[lane] += radiance.y;
    out_.b[lane] += radiance.z;
  }

  const Direct::In& in_;
  const LightSampler& lights_;
  const ShadowMaps& shadowMaps_;
  std::uint32_t areaSamples_;
  const ViewTile& tile_;
  RadianceTile& out_;
};

}  // namespace

void Direct::prepare(const RasterScene& scene, std::span<const std::uint8_t> shining, Stats& stats,
                     const Job& job) {
  if (!wantsShadowMaps()) return;
  const auto scope = stats.scope("direct.shadow_maps");
  shadowMaps_.build(scene, shining,
                    {settings_.shadowResolution, settings_.shadowFilter, settings_.shadowBias}, job);
  stats.setCounter("direct.shadowTexels", double(shadowMaps_.texels()));
  stats.peakBytes("direct.shadowMaps", shadowMaps_.texels() * sizeof(float));
}

void Direct::run(const In& in, Radiance& out, Stats& stats, const Job& job) const {
  const auto scope = stats.scope("direct");
  out.resize(in.view.tiles.size());
  const LightSampler lights(in.trace);
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) {
    if (job.stop.stop_requested()) return;
    if (i + 1 < out.size()) {
      wantTile(in.view.tiles[i + 1]);
      want(&out[i + 1], sizeof(RadianceTile));
    }
    TileLight(in, lights, shadowMaps_, settings_.areaSamples, in.view.tiles[i], out[i]).run();
  });
  job.throwIfStopped();
}

}  // namespace isophote

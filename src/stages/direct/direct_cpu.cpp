// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "math/rng.shared.h"
#include "math/sobol.shared.h"
#include "physics/shading_normal.shared.h"
#include "stages/direct/direct.h"
#include "stages/direct/light_lanes.h"
#include "stages/direct/soft_light.shared.h"
#include "trace/light_sampler.h"
#include "trace/surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

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

/// What all tiles have in common.
struct LightsInFrame {
  const Direct::In& in;
  const DirectSettings& settings;
  const LightSampler& lights;
  const ShadowMaps& shadowMaps;
  const std::vector<SoftLight>& softLights;
  const SoftShadows& softShadows;

  bool isGathered(std::uint32_t light) const {
    return softLights[light].size > 0.0f && settings.shadows != Shadows::kArea;
  }
};

class TileLight {
 public:
  TileLight(const LightsInFrame& frame, std::size_t tile, RadianceTile& out)
      : in_(frame.in),
        frame_(frame),
        lights_(frame.lights),
        shadowMaps_(frame.shadowMaps),
        areaSamples_(frame.settings.areaSamples),
        tile_(frame.in.view.tiles[tile]),
        onScreen_(tile < frame.in.view.primaryTiles && tile_.transmits == 0),
        out_(out) {}

  void run() {
    out_ = {};
    if (tile_.count == 0) return;
    ShadowQueue queue(in_.trace, out_);
    for (std::uint32_t light = 0; light < lights_.lightCount(); ++light) {
      if (!shines(light) || comesLater(light)) continue;
      if (tile_.transmits == 0 && !isSampled(light)) {
        lightAll(light);
        continue;
      }
      if (tile_.transmits == 0 && isSampledInLanes(in_.trace.lights()[light], softLight(light).size)) {
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

  const SoftLight& softLight(std::uint32_t light) const { return frame_.softLights[light]; }
  /// With the soft shadows of all view samples in the picture.
  bool comesLater(std::uint32_t light) const { return onScreen_ && frame_.isGathered(light); }
  /// Whether samples of all of its extent are taken.
  bool isSampled(std::uint32_t light) const {
    if (softLight(light).size > 0.0f) return frame_.settings.shadows != Shadows::kPcss;
    return !hasNoExtent(in_.trace.lights()[light]);
  }

  /// A light without extent, or one that is shaded as if it had none: in lanes, shadows only for those that
  /// it would reach.
  void lightAll(std::uint32_t index) const {
    LightLanes lanes;
    const SoftLight& soft = softLight(index);
    lightTile(soft.size > 0.0f ? soft.light : in_.trace.lights()[index], tile_, lanes);
    if (lanes.lit == 0) return;
    LightVisibility visible;
    if (soft.size > 0.0f)
      frame_.softShadows.visibility(shadowMaps_, index, soft, tile_, lanes.lit, visible);
    else if (shadowMaps_.has(index))
      shadowMaps_.visibility(index, tile_, lanes.lit, visible);
    else
      findTraced(lanes, visible);
    addVisible(lanes, visible, out_);
  }

  /// A light with an area, its own or one that it is given: each of its samples from all lanes at once.
  void sampleAll(std::uint32_t index) const {
    const AreaLanes area({.scene = in_.trace.scene(),
                          .light = in_.trace.lights()[index],
                          .tile = tile_,
                          .seed = in_.seed,
                          .pass = in_.pass,
                          .index = index,
                          .samples = areaSamples_,
                          .size = softLight(index).size});
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
    const bool isDelta = hasNoExtent(light);
    const float size = softLight(index).size;
    const bool sized = isDelta && size > 0.0f;
    const bool delta = isDelta && !sized;
    const std::uint32_t samples = delta ? 1 : areaSamples_;
    const uvec3 scramble = delta ? uvec3(0u) : lightScramble(ng == s.ng ? keyOf(lane) : ~keyOf(lane), index);
    for (std::uint32_t i = 0; i < samples; ++i) {
      const vec3 u = delta ? vec3(0.5f) : scrambled(unscrambledSample(i), scramble);
      const LightSample l = sized ? sampleSoftLight(light, size, s.position, vec2(u.y, u.z))
                                  : lights_.sample(index, s.position, ng, u);
      if (!(l.pdf > 0.0f) || dot(l.wi, ng) <= 0.0f) continue;
      const bool mapped = delta && shadowMaps_.has(index);
      const float visible = mapped ? shadowMaps_.visibility(index, s.position, ng) : 1.0f;
      if (!(visible > 0.0f)) continue;
      const float ownDensity = l.pdf * float(samples);
      const float weight =
          isDelta || !isSharp(s.bsdf)
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
      if (!shines(light) || (tile_.transmits == 0 && !isSampled(light)) || comesLater(light)) return;
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
  const LightsInFrame& frame_;
  const LightSampler& lights_;
  const ShadowMaps& shadowMaps_;
  std::uint32_t areaSamples_;
  const ViewTile& tile_;
  bool onScreen_;  ///< Its lanes are neighbours in the picture.
  RadianceTile& out_;
};

/// How much of a shadow map lies beyond what its light lights, where penumbrae may be wide.
constexpr float kBeyondMaps = 0.125f;

/// The size that a light's shadows are to have; 0: they are hard, or those of its own samples.
float softSize(const DirectSettings& settings, const Light& light) {
  if (!areSoft(settings.shadows)) return 0.0f;
  if (light.type == kLightDirectional) return std::tan(settings.lightAngle * (kPi / 180.0f));
  if (light.type == kLightSpot) return settings.lightRadius;
  if (light.type != kLightPoint) return 0.0f;
  const bool own = light.radius > 0.0f;
  if (own && settings.shadows == Shadows::kArea) return 0.0f;
  return own ? light.radius : settings.lightRadius;
}

void findSoftLights(const DirectSettings& settings, std::span<const Light> lights,
                    std::vector<SoftLight>& soft) {
  soft.resize(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    soft[i] = {lights[i], softSize(settings, lights[i])};
    soft[i].light.radius = 0.0f;
  }
}

void addSoftLight(const SoftShadows& shadows, const SoftLight& soft, const ViewTile& tile, std::size_t index,
                  RadianceTile& out) {
  if (tile.count == 0 || tile.transmits != 0) return;
  LightLanes lanes;
  lightTile(soft.light, tile, lanes);
  if (lanes.lit == 0) return;
  LightVisibility visible;
  shadows.visibility(soft, index, visible);
  addVisible(lanes, visible, out);
}

}  // namespace

void Direct::prepare(const RasterScene& scene, std::span<const std::uint8_t> shining, Stats& stats,
                     const Job& job) {
  if (!wantsShadowMaps()) return;
  const auto scope = stats.scope("direct.shadow_maps");
  findSoftLights(settings_, scene.trace().lights(), softLights_);
  ShadowMapOptions options{settings_.shadowResolution, settings_.shadowFilter, settings_.shadowBias};
  lightsOfMaps_.assign(scene.trace().lights().begin(), scene.trace().lights().end());
  for (std::size_t i = 0; i < softLights_.size(); ++i) {
    if (!(softLights_[i].size > 0.0f)) continue;
    options.beyond = kBeyondMaps;
    lightsOfMaps_[i] = softLights_[i].light;
  }
  shadowMaps_.build(scene, lightsOfMaps_, shining, options, job);
  stats.setCounter("direct.shadowTexels", double(shadowMaps_.texels()));
  stats.peakBytes("direct.shadowMaps", shadowMaps_.texels() * sizeof(float));
}

void Direct::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  const auto scope = stats.scope("direct");
  const auto isSoft = [&](const SoftLight& l) {
    const auto index = std::size_t(&l - softLights_.data());
    return l.size > 0.0f && (in.shining.empty() || in.shining[index] != 0);
  };
  out.resize(in.view.tiles.size());
  const LightSampler lights(in.trace);
  findSoftLights(settings_, in.trace.lights(), softLights_);
  const LightsInFrame frame{in, settings_, lights, shadowMaps_, softLights_, softShadows_};
  const bool soft = std::ranges::any_of(softLights_, isSoft) && settings_.shadows != Shadows::kArea;
  const SoftShadows::In softIn{
      in.trace,
      in.view,
      in.subpixel,
      in.pass,
      {settings_.searchSamples, settings_.blurSamples, settings_.blurRadius, settings_.smooth}};
  if (soft) softShadows_.start(softIn, job);
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) {
    if (job.stop.stop_requested()) return;
    if (i + 1 < out.size()) {
      wantTile(in.view.tiles[i + 1]);
      want(&out[i + 1], sizeof(RadianceTile));
    }
    TileLight(frame, i, out[i]).run();
    if (!soft && in.alongside && i < in.view.primaryTiles) in.alongside(i);
  });
  job.throwIfStopped();
  if (soft) addSoftLights(in, out, stats, job);
}

void Direct::addSoftLights(const In& in, Radiance& out, Stats& stats, const Job& job) {
  double rays = 0, tiles = 0;
  std::uint32_t last = 0;
  const auto shines = [&](std::uint32_t i) { return in.shining.empty() || in.shining[i] != 0; };
  for (std::uint32_t i = 0; i < softLights_.size(); ++i)
    if (softLights_[i].size > 0.0f && shines(i)) last = i;
  for (std::uint32_t index = 0; index <= last; ++index) {
    const SoftLight& soft = softLights_[index];
    if (!(soft.size > 0.0f) || !shines(index)) continue;
    if (settings_.shadows == Shadows::kGathered)
      softShadows_.gather(soft, job);
    else
      softShadows_.lookUp(shadowMaps_, index, soft, job);
    rays += double(softShadows_.raysTraced());
    tiles += double(softShadows_.tilesBlurred());
    tbb::parallel_for(std::size_t(0), in.view.primaryTiles, [&](std::size_t i) {
      if (job.stop.stop_requested()) return;
      addSoftLight(softShadows_, soft, in.view.tiles[i], i, out[i]);
      if (index == last && in.alongside) in.alongside(i);
    });
    job.throwIfStopped();
  }
  stats.setCounter("direct.hardShadowRays", rays);
  stats.setCounter("direct.softTiles", tiles);
  stats.peakBytes("direct.softShadows", softShadows_.bytes());
}

}  // namespace isophote

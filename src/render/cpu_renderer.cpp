// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cpu_renderer.h"

#include "base/error.h"
#include "math/rng.shared.h"
#include "math/sobol.shared.h"
#include "render/combinations.h"
#include "render/photon_batches.h"
#include "render/progressive.h"
#include "scene/surface_area.h"
#include "settings/apply.h"
#include "stages/bounce_map/bounce_map.h"
#include "stages/composite/composite.h"
#include "stages/light_gbuffer/light_gbuffer.h"
#include "stages/photon_trace/photon_shares.h"
#include "trace/light_views.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

/// Tell the random numbers of passes apart from those of other things of the same seed.
constexpr std::uint32_t kSubpixelStream = 0x70697865u;
constexpr std::uint32_t kCullStream = 0x63756c6cu;

/// Photons in an estimate that the automatic radius aims at. They grow with the map while the disc that holds
/// them shrinks, so that noise and bias both vanish; the factor is what gave the best PSNR with 200 k photons
/// (150 of them in an estimate) on cornell-box and Dabrovic's Sponza.
float photonsPerEstimate(std::size_t stored) { return 1.15f * std::pow(float(stored), 0.4f); }

/// Position in the pixel of primary sample `index` of `count`: the centre for one, else a stratified set.
vec2 subpixelSample(std::uint32_t index, std::uint32_t count) {
  if (count == 1) return vec2(0.5f);
  constexpr float kFromBits = 1.0f / 4294967296.0f;
  // Half an interval moves the points of the sequence off the pixel's edge.
  const float half = 0.5f / float(count);
  return vec2(float(sobolBits(index, 0)) * kFromBits + half, float(sobolBits(index, 1)) * kFromBits + half);
}

/// The same for a sample of many passes, whose number is open: any 2^n from the first on are stratified.
vec2 subpixelOfPasses(std::uint32_t index, std::uint32_t seed) {
  const auto number = [&](std::uint32_t dimension) {
    const std::uint32_t bits =
        owenScramble(sobolBits(index, dimension), hash3(uvec3(seed, dimension, kSubpixelStream)).x);
    return (float(bits >> 8) + 0.5f) / 16777216.0f;
  };
  return {number(0), number(1)};
}

float radiusSetting(const RenderSettings& settings) {
  switch (settings.frame.estimator) {
    case Estimator::kKdtree:
      return settings.photonKdtree.radius;
    case Estimator::kTiles:
      return settings.photonTiles.radius;
    case Estimator::kClusters:
      return settings.photonClusters.radius;
    case Estimator::kBvh:
      return settings.photonBvh.radius;
    case Estimator::kQuads:
      return settings.photonQuads.radius;
    case Estimator::kDirectional:
      return settings.photonDirectional.radius;
    case Estimator::kVolumes:
      break;
  }
  return settings.photonVolumes.radius;
}

/// The radius that was set, or the automatic one by the first of so many batches of photons; where they are
/// too few to tell one, a twentieth of the scene's diagonal.
float resolvedRadius(const RenderSettings& settings, const PhotonMap& map, std::uint32_t batches,
                     const Scene& scene, const Job& job) {
  const float set = radiusSetting(settings);
  if (set > 0.0f || map.photons.empty()) return set;
  if (settings.frame.estimator == Estimator::kBvh && settings.photonBvh.smoothing > 0.0f) {
    const float bySmoothing = middleRadius(map, settings.photonBvh, settings.photonBvh.smoothing);
    if (bySmoothing > 0.0f) return bySmoothing;
  }
  const float automatic =
      automaticRadius(map, photonsPerEstimate(map.photons.size() * batches) / float(batches));
  if (automatic > 0.0f) return automatic;
  const float byScene = std::max(0.05f * length(scene.bounds.upper - scene.bounds.lower), 1e-3f);
  job.warn(
      fmt::format("{} stored photons are too few to choose a radius by, so it is {:.3g} m; --photons "
                  "emits more, --radius sets it",
                  map.photons.size(), byScene));
  return byScene;
}

void addLight(const Radiance& light, Radiance& sum) {
  tbb::parallel_for(std::size_t(0), sum.size(), [&](std::size_t i) {
    for (const auto channel : {&RadianceTile::r, &RadianceTile::g, &RadianceTile::b})
      for (int lane = 0; lane < kTileLanes; ++lane) (sum[i].*channel)[lane] += (light[i].*channel)[lane];
  });
}

}  // namespace

/// The stages and what they hand to each other.
struct CpuRenderer::Frame {
  const TraceScene& trace;
  RenderSettings settings;
  std::vector<std::pair<std::string, std::string>> metadata;

  Cull cull;
  LightGbuffer lightGbuffer;
  BounceMap bounceMap;
  PhotonTrace photonTrace;
  Gbuffer gbuffer;
  Direct direct;
  PhotonVolumes photonVolumes;
  PhotonKdtree photonKdtree;
  PhotonTiles photonTiles;
  PhotonClusters photonClusters;
  PhotonBvh photonBvh;
  PhotonQuads photonQuads;
  PhotonDirectional photonDirectional;
  IrradianceBlur irradianceBlur;
  Upsample upsample;
  Composite composite;

  Pass pass;
  std::vector<std::uint8_t> shining;         ///< By light, 0 where it is left out; empty: none is.
  std::vector<std::uint32_t> pixels, paths;  ///< By light: photons to emit on a bounce map, and by tracing.
  LightSamples lightSamples;
  BouncedPhotons bounced;
  PhotonMap photons;
  ViewSamples view;
  Radiance directLight;
  Radiance indirectLight;
  Radiance sparseLight;  ///< At what upsample chose.
  Radiance batchLight;   ///< Of one batch of photons.
  Radiance irradiance;   ///< Before it is smoothed.
  std::uint32_t batches = 1;
  std::uint32_t batch = 0;  ///< That `photons` are of.
  Stats batchStats;         ///< What tracing them measured, where there are several.
  double sceneArea = 0;     ///< Of all surfaces [m^2], once it has been asked for.

  Frame(const TraceScene& scene, const RenderSettings& s)
      : trace(scene),
        settings(s),
        metadata(metadataOf(s)),
        cull(s.cull),
        photonTrace(s.photonTrace),
        gbuffer(s.gbuffer),
        direct(s.direct),
        photonVolumes(s.photonVolumes),
        photonKdtree(s.photonKdtree),
        photonTiles(s.photonTiles),
        photonClusters(s.photonClusters),
        photonBvh(s.photonBvh),
        photonQuads(s.photonQuads),
        photonDirectional(s.photonDirectional),
        irradianceBlur(s.irradianceBlur),
        upsample(s.upsample) {}

  /// All of a frame, or of a pass; returns the radius of the estimates.
  float render(const Camera& camera, const Pass* one, Film& film, Stats& stats, const Job& job) {
    const FrameSettings& f = settings.frame;
    refuseWhatCannotCombine(settings);
    pass = one ? *one : Pass{};
    if (cull.cullsLights()) cull.lights(trace.scene(), trace.lights(), camera.eye, shining, stats);
    batches = photonBatches(settings, job.memoryBudgetBytes);
    batchStats = {};
    const double traced = 0.3 / double(batches);
    tracePhotons(0, camera.eye, batches > 1 ? batchStats : stats, job.part(0.0, traced));
    const float radius = radiusOf(stats, job);
    const CameraRays rays = cameraRays(camera, int(f.width), int(f.height));
    if (direct.wantsShadowMaps()) direct.prepare(trace.raster(), shining, stats, job);
    for (std::uint32_t i = 0; i < f.aa; ++i) {
      const double step = (1.0 - traced) / f.aa;
      const Job part = job.part(traced + step * i, traced + step * (i + 1));
      part.report("shading", 0.0);
      const std::uint32_t sample = pass.index * f.aa + i;
      const vec2 subpixel = one ? subpixelOfPasses(sample, f.seed) : subpixelSample(i, f.aa);
      gbuffer.run({trace, rays, int(f.width), int(f.height), subpixel, f.seed, sample, f.layers}, view, stats,
                  part);
      Direct::In lit{trace, view, f.seed, sample, shining, subpixel};
      if (f.subsample == 1) {
        estimateAll(view, camera.eye, radius, indirectLight, stats, part);
      } else {
        const ViewSamples& sparse = upsample.choose({view, f.subsample, sample}, stats, part);
        estimateAll(sparse, camera.eye, radius, sparseLight, stats, part);
        const Upsample::In sparseIn{view, sparseLight};
        if (upsample.isMerged()) {
          upsample.begin(sparseIn, indirectLight, stats, part);
          lit.alongside = [this](std::size_t tile) {
            upsample.reconstruct({view, sparseLight}, tile, indirectLight);
          };
        } else {
          upsample.run(sparseIn, indirectLight, stats, part);
        }
      }
      direct.run(lit, directLight, stats, part);
      composite.run({view, directLight, indirectLight, 1.0f / float(f.aa), i == 0, f.layers}, film, stats,
                    part);
    }
    if (f.densityLayer) film.layers["density"] = photonDensity(radius, job);
    describe(film, stats);
    job.report("done", 1.0);
    return radius;
  }

  void describe(Film& film, Stats& stats) const {
    stats.engine = "cpu";
    stats.device = processorName();
    stats.peakBytes("viewTiles", view.tiles.size() * sizeof(ViewTile));
    stats.peakBytes("radianceTiles",
                    (directLight.size() + indirectLight.size() + sparseLight.size() + irradiance.size()) *
                        sizeof(RadianceTile));
    if (film.metadata != metadata) film.metadata = metadata;
  }

  /// Fills the photon map with a batch.
  void tracePhotons(std::uint32_t which, vec3 eye, Stats& stats, const Job& job) {
    const FrameSettings& f = settings.frame;
    batch = which;
    photons.photons.clear();
    photons.footprints.clear();
    const bool wantsFootprints = f.estimator == Estimator::kBvh;
    if (f.bounces > 0 && f.firstBounce == FirstBounce::kMap) {
      shareBudget();
      lightGbuffer.run({trace, pixels, f.seed, pass.index}, lightSamples, stats, job);
      bounceMap.run({trace, lightSamples, f.seed, pass.index}, bounced, stats, job);
      photonTrace.run({trace, f.seed, pass.index, f.bounces, paths, bounced.photons, wantsFootprints},
                      photons, stats, job);
      addAccount(bounced, photons, stats);
    } else if (f.bounces > 0) {
      if (cull.cullsLights()) shareBudget();
      PhotonTrace::In in{trace, f.seed, pass.index, f.bounces, paths};
      in.footprints = wantsFootprints;
      in.batch = which;
      in.batches = batches;
      photonTrace.run(in, photons, stats, job);
    }
    // Passes leave out other photons.
    cull.photons(eye, pass.index == 0 ? f.seed : hash3(uvec3(f.seed, pass.index, kCullStream)).x, photons,
                 stats);
  }

  /// Of an estimate, by the first batch.
  float radiusOf(Stats& stats, const Job& job) const {
    const auto scope = stats.scope("photon_trace.radius");
    const float radius =
        pass.radius > 0.0f ? pass.radius : resolvedRadius(settings, photons, batches, trace.scene(), job);
    stats.setCounter("radiusMetres", double(radius));
    return radius;
  }

  /// Indirect light of all photons at the view samples. Several batches are traced anew for every view.
  void estimateAll(const ViewSamples& at, vec3 eye, float radius, Radiance& out, Stats& stats,
                   const Job& job) {
    if (batches == 1) return estimate(at, radius, out, stats, job);
    Stats sum;
    for (std::uint32_t i = 0; i < batches; ++i) {
      const Job part = job.part(double(i) / batches, double(i + 1) / batches);
      if (batch != i) {
        batchStats = {};
        tracePhotons(i, eye, batchStats, part.part(0.0, 0.5));
      }
      estimate(at, radius, i == 0 ? out : batchLight, batchStats, part.part(0.5, 1.0));
      sum.addPart(batchStats);
      if (i > 0) addLight(batchLight, out);
    }
    stats.add(sum);
  }

  /// Shares the photons between the lights by their power, and a light's between bounce map and tracing.
  /// Those of lights that are left out are not emitted.
  void shareBudget() {
    const std::span<const Light> lights = trace.lights();
    const bool map = settings.frame.firstBounce == FirstBounce::kMap;
    paths = photonShares(lights, settings.photonTrace.photons);
    pixels.assign(lights.size(), 0);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      if (!shining.empty() && shining[i] == 0) paths[i] = 0;
      if (map && hasLightViews(lights[i])) std::swap(pixels[i], paths[i]);
    }
  }

  /// Indirect light at the view samples by the chosen estimator; none where there are no photons.
  void estimate(const ViewSamples& at, float radius, Radiance& out, Stats& stats, const Job& job) {
    if (photons.photons.empty()) {
      out.assign(at.tiles.size(), {});
      return;
    }
    switch (settings.frame.estimator) {
      case Estimator::kVolumes:
        return photonVolumes.run({at, photons, radius}, out, stats, job);
      case Estimator::kKdtree:
        return photonKdtree.run({at, photons, radius}, out, stats, job);
      case Estimator::kTiles:
        return photonTiles.run({at, photons, radius}, out, stats, job);
      case Estimator::kClusters:
        return photonClusters.run({at, photons, radius}, out, stats, job);
      case Estimator::kBvh: {
        if (sceneArea == 0.0) sceneArea = surfaceArea(trace.scene());
        const float shrink = pass.radius > 0.0f ? radiusOfPass(settings.frame, pass.index) : 1.0f;
        return photonBvh.run({at, photons, radius, shrink, sceneArea}, out, stats, job);
      }
      case Estimator::kQuads:
        return photonQuads.run({at, photons, radius}, out, stats, job);
      case Estimator::kDirectional:
        photonDirectional.run({at, photons, radius}, irradiance, out, stats, job);
        return irradianceBlur.run({at, irradiance}, out, stats, job);
    }
  }

  /// The layer "density": photons a square metre at the surfaces seen directly. Lets the estimator itself
  /// count, with photons of one watt on surfaces that return their irradiance; spoils the view and the
  /// photons.
  Image photonDensity(float radius, const Job& job) {
    for (Photon& photon : photons.photons) photon.power = vec3(1.0f);
    view.tiles.resize(view.primaryTiles);
    for (ViewTile& tile : view.tiles) {
      tile.lambertian = 1;
      for (float* diffuse : {tile.diffuseR, tile.diffuseG, tile.diffuseB})
        std::fill_n(diffuse, kTileLanes, kPi);
      std::copy_n(tile.ngX, kTileLanes, tile.nsX);
      std::copy_n(tile.ngY, kTileLanes, tile.nsY);
      std::copy_n(tile.ngZ, kTileLanes, tile.nsZ);
    }
    Stats unused;
    estimate(view, radius, indirectLight, unused, job);
    Image image(view.width, view.height);
    for (std::size_t t = 0; t < view.tiles.size(); ++t)
      for (int lane = 0; lane < kTileLanes; ++lane)
        if (view.tiles[t].pixel[lane] != kNoPixel)
          image.pixels[view.tiles[t].pixel[lane]].x = indirectLight[t].r[lane];
    return image;
  }
};

CpuRenderer::CpuRenderer(const TraceScene& trace, const RenderSettings& settings)
    : frame_(std::make_unique<Frame>(trace, settings)) {}
CpuRenderer::~CpuRenderer() = default;
CpuRenderer::CpuRenderer(CpuRenderer&&) noexcept = default;
CpuRenderer& CpuRenderer::operator=(CpuRenderer&&) noexcept = default;

const RenderSettings& CpuRenderer::settings() const { return frame_->settings; }

void CpuRenderer::render(const Camera& camera, Film& film, Stats& stats, const Job& job) {
  frame_->render(camera, nullptr, film, stats, job);
}

float CpuRenderer::renderPass(const Camera& camera, const Pass& pass, Film& film, Stats& stats,
                              const Job& job) {
  return frame_->render(camera, &pass, film, stats, job);
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cpu_frame.h"

#include "math/sobol.shared.h"
#include "settings/apply.h"
#include "stages/composite/composite.h"
#include "trace/trace_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

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

/// The radius that was set, or the automatic one; where the photons are too few to tell one, a twentieth of
/// the scene's diagonal.
float resolvedRadius(const RenderSettings& settings, const PhotonMap& map, const Scene& scene,
                     const Job& job) {
  const float set = settings.frame.estimator == Estimator::kKdtree ? settings.photonKdtree.radius
                                                                   : settings.photonVolumes.radius;
  if (set > 0.0f || map.photons.empty()) return set;
  const float automatic = automaticRadius(map, photonsPerEstimate(map.photons.size()));
  if (automatic > 0.0f) return automatic;
  const float byScene = std::max(0.05f * length(scene.bounds.upper - scene.bounds.lower), 1e-3f);
  job.warn(
      fmt::format("{} stored photons are too few to choose a radius by, so it is {:.3g} m; --photons "
                  "emits more, --radius sets it",
                  map.photons.size(), byScene));
  return byScene;
}

/// The stages of a frame; each keeps its scratch memory from one pass to the next.
struct Stages {
  Gbuffer gbuffer;
  Direct direct;
  PhotonTrace photonTrace;
  PhotonVolumes photonVolumes;
  PhotonKdtree photonKdtree;
  Composite composite;
  Estimator estimator;

  explicit Stages(const RenderSettings& s)
      : gbuffer(s.gbuffer),
        direct(s.direct),
        photonTrace(s.photonTrace),
        photonVolumes(s.photonVolumes),
        photonKdtree(s.photonKdtree),
        estimator(s.frame.estimator) {}

  /// Indirect light at the view samples by the chosen estimator; none where there are no photons.
  void estimate(const ViewSamples& view, const PhotonMap& map, float radius, Radiance& out, Stats& stats,
                const Job& job) {
    if (map.photons.empty()) {
      out.assign(view.tiles.size(), {});
      return;
    }
    switch (estimator) {
      case Estimator::kVolumes:
        return photonVolumes.run({view, map, radius}, out, stats, job);
      case Estimator::kKdtree:
        return photonKdtree.run({view, map, radius}, out, stats, job);
    }
  }
};

/// The layer "density": photons a square metre at the surfaces seen directly. Lets the estimator itself
/// count, with photons of one watt on surfaces that return their irradiance; spoils `view` and `map`.
Image photonDensity(Stages& stages, ViewSamples& view, PhotonMap& map, float radius, const Job& job) {
  for (Photon& photon : map.photons) photon.power = vec3(1.0f);
  view.tiles.resize(view.primaryTiles);
  for (ViewTile& tile : view.tiles) {
    tile.lambertian = 1;
    for (float* diffuse : {tile.diffuseR, tile.diffuseG, tile.diffuseB})
      std::fill_n(diffuse, kTileLanes, kPi);
    for (float* none : {tile.alpha, tile.f90, tile.f0R, tile.f0G, tile.f0B, tile.coupling0, tile.coupling90})
      std::fill_n(none, kTileLanes, 0.0f);
    std::copy_n(tile.ngX, kTileLanes, tile.nsX);
    std::copy_n(tile.ngY, kTileLanes, tile.nsY);
    std::copy_n(tile.ngZ, kTileLanes, tile.nsZ);
  }
  Radiance density;
  Stats unused;
  stages.estimate(view, map, radius, density, unused, job);
  Image image(view.width, view.height);
  for (std::size_t t = 0; t < view.tiles.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane)
      if (view.tiles[t].pixel[lane] != kNoPixel)
        image.pixels[view.tiles[t].pixel[lane]].x = density[t].r[lane];
  return image;
}

std::vector<std::pair<std::string, std::string>> metadataOf(RenderSettings settings) {
  std::vector<std::pair<std::string, std::string>> metadata;
  for (const Field& field : fieldsOfGroups(settings)) metadata.emplace_back(field.key, valueText(field));
  return metadata;
}

}  // namespace

Film renderCpu(const Scene& scene, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job) {
  job.report("building the ray tracing hierarchy", 0.0);
  std::unique_ptr<TraceScene> trace;
  {
    const auto scope = stats.scope("trace.build");
    trace = std::make_unique<TraceScene>(scene, job);
  }
  return renderCpu(*trace, camera, settings, stats, job);
}

Film renderCpu(const TraceScene& trace, const Camera& camera, const RenderSettings& settings, Stats& stats,
               const Job& job) {
  const FrameSettings& frame = settings.frame;
  const int width = int(frame.width);
  const int height = int(frame.height);
  stats.engine = "cpu";
  stats.device = processorName();

  Stages stages(settings);
  PhotonMap map;
  if (frame.bounces > 0)
    stages.photonTrace.run({trace, frame.seed, 0, frame.bounces}, map, stats, job.part(0.0, 0.3));
  const float radius = resolvedRadius(settings, map, trace.scene(), job);
  stats.setCounter("radiusMetres", double(radius));

  Film film;
  ViewSamples view;
  Radiance direct;
  Radiance indirect;
  const CameraRays rays = cameraRays(camera, width, height);
  for (std::uint32_t sample = 0; sample < frame.aa; ++sample) {
    const Job pass = job.part(0.3 + 0.7 * sample / frame.aa, 0.3 + 0.7 * (sample + 1) / frame.aa);
    pass.report("shading", 0.0);
    const vec2 subpixel = subpixelSample(sample, frame.aa);
    stages.gbuffer.run({trace, rays, width, height, subpixel, frame.seed, sample}, view, stats, pass);
    stages.direct.run({trace, view, frame.seed, sample}, direct, stats, pass);
    stages.estimate(view, map, radius, indirect, stats, pass);
    stages.composite.run({view, direct, indirect, 1.0f / float(frame.aa)}, film, stats, pass);
  }
  stats.addBytes("viewTiles", view.tiles.size() * sizeof(ViewTile));
  stats.addBytes("radianceTiles", (direct.size() + indirect.size()) * sizeof(RadianceTile));
  if (frame.densityLayer) film.layers["density"] = photonDensity(stages, view, map, radius, job);
  film.metadata = metadataOf(settings);
  job.report("done", 1.0);
  return film;
}

}  // namespace isophote

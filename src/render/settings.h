// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "settings/visit.h"
#include "stages/cull/cull.h"
#include "stages/direct/direct.h"
#include "stages/gbuffer/gbuffer.h"
#include "stages/irradiance_blur/irradiance_blur.h"
#include "stages/photon_bvh/photon_bvh.h"
#include "stages/photon_clusters/photon_clusters.h"
#include "stages/photon_directional/photon_directional.h"
#include "stages/photon_kdtree/photon_kdtree.h"
#include "stages/photon_quads/photon_quads.h"
#include "stages/photon_tiles/photon_tiles.h"
#include "stages/photon_trace/photon_trace.h"
#include "stages/photon_volumes/photon_volumes.h"
#include "stages/upsample/upsample.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isophote {

/// How the photon map becomes indirect light at the view samples; each is the stage of that name.
enum class Estimator : std::uint32_t { kVolumes, kKdtree, kTiles, kClusters, kBvh, kQuads, kDirectional };
template <>
struct EnumNames<Estimator> {
  static constexpr std::array names{"volumes", "kdtree", "tiles", "clusters", "bvh", "quads", "directional"};
};

/// Where photons of point, spot and directional lights meet their first surface: traced from the light, or on
/// bounce maps. Those of other lights are traced.
enum class FirstBounce : std::uint32_t { kTraced, kMap };
template <>
struct EnumNames<FirstBounce> {
  static constexpr std::array names{"traced", "map"};
};

/// What concerns the frame as a whole.
struct FrameSettings {
  std::uint32_t width = 1280;
  std::uint32_t height = 720;
  std::uint32_t aa = 1;
  std::uint32_t bounces = 3;
  std::uint32_t seed = 0;
  FirstBounce firstBounce = FirstBounce::kTraced;
  Estimator estimator = Estimator::kVolumes;
  std::uint32_t subsample = 1;
  std::uint32_t passes = 1;
  std::uint32_t sparsePasses = 1;
  float passRadius = 1;
  float seconds = 0;
  bool layers = true;
  bool densityLayer = false;

  void visit(auto&& v) {
    v("width", width, {.help = "Width of the picture.", .unit = "px", .min = 1, .max = 16384});
    v("height", height, {.help = "Height of the picture.", .unit = "px", .min = 1, .max = 16384});
    v("aa", aa,
      {.help = "Primary samples a pixel, box-filtered; 1: the pixel's centre.", .min = 1, .max = 65536});
    v("bounces", bounces,
      {.help = "Indirect bounces: largest number of scattering events before the last surface; 0: direct "
               "light only.",
       .min = 0,
       .max = 64});
    v("seed", seed, {.help = "Start of all random numbers; the same seed gives the same bytes."});
    v("firstBounce", firstBounce,
      {.help = "First segment and bounce of photons from point, spot and directional lights: traced, or a "
               "bounce map with a photon a pixel. Those of other lights are traced."});
    v("estimator", estimator, {.help = "How the photon map becomes indirect light at the view samples."});
    v("subsample", subsample,
      {.help = "Estimate indirect light once for every N x N pixels, and upsample it; 1: at every pixel.",
       .min = 1,
       .max = 64});
    v("passes", passes,
      {.help = "Frames whose mean is the picture, each with fresh photons and smaller radii, so that it "
               "converges; 1: one frame.",
       .min = 1,
       .max = 100'000'000});
    v("sparsePasses", sparsePasses,
      {.help = "So many of the first passes keep `subsample`, which is faster and less noisy but does not "
               "converge; those after them estimate at every pixel.",
       .min = 1,
       .max = 100'000'000});
    v("passRadius", passRadius,
      {.help = "Radius of the passes after the first over what it would be by that of the first, which one "
               "frame wants; the more passes there will be, the smaller it may be.",
       .min = 0.01,
       .max = 1});
    v("seconds", seconds,
      {.help = "Add passes for so long, after loading, up to frame.passes where that is more than 1; 0: "
               "frame.passes alone decides.",
       .unit = "s",
       .min = 0,
       .max = 1e9});
    v("layers", layers,
      {.help = "Fill the film's layers (direct, indirect, albedo ...); a PNG holds none, and goes without."});
    v("densityLayer", densityLayer,
      {.help = "Add the layer \"density\", photons a square metre, to the film."});
  }
};

/// Everything that a person can choose about a frame: one group a stage, named as the stage.
struct RenderSettings {
  FrameSettings frame;
  CullSettings cull;
  GbufferSettings gbuffer;
  DirectSettings direct;
  PhotonTraceSettings photonTrace;
  PhotonVolumesSettings photonVolumes;
  PhotonKdtreeSettings photonKdtree;
  PhotonTilesSettings photonTiles;
  PhotonClustersSettings photonClusters;
  PhotonBvhSettings photonBvh;
  PhotonQuadsSettings photonQuads;
  PhotonDirectionalSettings photonDirectional;
  IrradianceBlurSettings irradianceBlur;
  UpsampleSettings upsample;

  void visitGroups(auto&& v) {
    v("frame", frame);
    v("cull", cull);
    v("gbuffer", gbuffer);
    v("direct", direct);
    v("photon_trace", photonTrace);
    v("photon_volumes", photonVolumes);
    v("photon_kdtree", photonKdtree);
    v("photon_tiles", photonTiles);
    v("photon_clusters", photonClusters);
    v("photon_bvh", photonBvh);
    v("photon_quads", photonQuads);
    v("photon_directional", photonDirectional);
    v("irradiance_blur", irradianceBlur);
    v("upsample", upsample);
  }
};

/// The settings as a film's metadata, "stage.name" -> value.
std::vector<std::pair<std::string, std::string>> metadataOf(RenderSettings settings);

/// The settings of a published system, by name. Throws Error(kBadUsage) that lists the names.
RenderSettings presetSettings(std::string_view name);

struct PresetInfo {
  std::string_view name;
  std::string_view description;  ///< One sentence.
};
/// All presets, in the order in which they are listed to people.
std::vector<PresetInfo> presets();

}  // namespace isophote

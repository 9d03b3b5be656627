// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/settings.h"

#include "base/error.h"
#include "settings/apply.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>

namespace isophote {
namespace {

RenderSettings jensen() {
  RenderSettings settings;
  settings.frame.estimator = Estimator::kKdtree;
  settings.photonKdtree.nearest = 100;
  return settings;
}

RenderSettings ispm() {
  RenderSettings settings;
  settings.frame.firstBounce = FirstBounce::kMap;
  settings.frame.estimator = Estimator::kVolumes;
  settings.direct.shadows = Shadows::kMap;
  settings.direct.shadowResolution = 512;
  settings.frame.subsample = 4;
  return settings;
}

RenderSettings withShadowMaps(Estimator estimator) {
  RenderSettings settings;
  settings.frame.estimator = estimator;
  settings.direct.shadows = Shadows::kMap;
  return settings;
}

RenderSettings tiled() { return withShadowMaps(Estimator::kTiles); }
RenderSettings clusters() { return withShadowMaps(Estimator::kClusters); }
RenderSettings directional() { return withShadowMaps(Estimator::kDirectional); }

RenderSettings igpm() {
  RenderSettings settings;
  settings.frame.bounces = 2;
  settings.frame.estimator = Estimator::kBvh;
  settings.photonTrace.photons = 256 * 1024;
  settings.photonBvh.smoothingCaustic = 5.0f;
  settings.photonBvh.radiusMax = 0.7f;
  settings.photonBvh.kernel = Kernel::kConstant;
  return settings;
}

RenderSettings sspm() {
  RenderSettings settings = ispm();
  settings.frame.estimator = Estimator::kQuads;
  settings.frame.bounces = 2;
  settings.photonTrace.photons = 20'000;
  settings.direct.shadows = Shadows::kGathered;
  settings.direct.lightRadius = 0.1f;
  settings.direct.lightAngle = 0.5f;
  settings.upsample.merged = true;
  return settings;
}

struct Preset {
  PresetInfo info;
  RenderSettings (*make)();
};

constexpr Preset kPresets[] = {
    {{"jensen", "Photon mapping as first published: the k nearest photons, gathered from a kd-tree."},
     jensen},
    {{"ispm",
      "Image space photon mapping: bounce maps, photon volumes shaped by path density, 4 x 4 subsampling, "
      "shadow maps."},
     ispm},
    {{"tiled", "Photons of one radius, in lists of screen tiles with near and far bounds; shadow maps."},
     tiled},
    {{"clusters",
      "Photons of one radius in a hierarchy over clusters of view samples, with cones of normals and trivial "
      "accept; shadow maps."},
     clusters},
    {{"directional",
      "Photons added up by octants of direction at clusters of view samples, and irradiance smoothed on the "
      "screen; shadow maps."},
     directional},
    {{"igpm",
      "Interactive global photon mapping: photon differentials, a hierarchy over their footprints, two "
      "bounces."},
     igpm},
    {{"sspm",
      "Soft shadows with image space photon mapping: bounce maps, photon quads, 4 x 4 subsampling in "
      "the pass of the shadows, which are gathered in the picture."},
     sspm},
};

}  // namespace

RenderSettings presetSettings(std::string_view name) {
  std::vector<std::string_view> names;
  for (const Preset& preset : kPresets) {
    if (preset.info.name == name) return preset.make();
    names.push_back(preset.info.name);
  }
  failUsage("--preset", "there is no preset \"{}\"{}; there is {}", name, suggestion(name, names),
            fmt::join(names, ", "));
}

std::vector<PresetInfo> presets() {
  std::vector<PresetInfo> infos;
  for (const Preset& preset : kPresets) infos.push_back(preset.info);
  return infos;
}

std::vector<std::pair<std::string, std::string>> metadataOf(RenderSettings settings) {
  std::vector<std::pair<std::string, std::string>> metadata;
  for (const Field& field : fieldsOfGroups(settings)) metadata.emplace_back(field.key, valueText(field));
  return metadata;
}

}  // namespace isophote

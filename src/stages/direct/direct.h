// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "settings/visit.h"
#include "stages/direct/shadow_maps.h"
#include "stages/direct/soft_shadows.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

#include <functional>
#include <span>
#include <vector>

namespace isophote {

/// How point, spot and directional lights throw shadows; all other lights send rays.
enum class Shadows : std::uint32_t { kTraced, kMap, kPcss, kGathered, kArea };
template <>
struct EnumNames<Shadows> {
  static constexpr std::array names{"traced", "map", "pcss", "gathered", "area"};
};

struct DirectSettings {
  std::uint32_t areaSamples = 4;
  Shadows shadows = Shadows::kTraced;
  float lightRadius = 0;
  float lightAngle = 0;
  std::uint32_t searchSamples = 16;
  std::uint32_t blurSamples = 25;
  float blurRadius = 0;
  bool smooth = true;
  std::uint32_t shadowResolution = 1024;
  std::uint32_t shadowFilter = 2;
  float shadowBias = 1;

  void visit(auto&& v) {
    v("areaSamples", areaSamples,
      {.help = "Shadow rays a view sample sends to each light that has an area.", .min = 1, .max = 4096});
    v("shadows", shadows,
      {.help =
           "Shadows of point, spot and directional lights. Hard: a ray from each view sample (traced), or "
           "shadow maps. Soft, of the size that lightRadius and lightAngle give them: percentage-closer "
           "on shadow maps (pcss), image space gathering (gathered), or areaSamples rays to all of the "
           "light (area), which is what the others approximate. Other lights send rays."});
    v("lightRadius", lightRadius,
      {.help = "Soft shadows: radius of point and spot lights. A point light's own radius goes before it.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("lightAngle", lightAngle,
      {.help = "Soft shadows: half the angle under which directional lights are seen; the sun's is 0.27.",
       .unit = "degrees",
       .min = 0,
       .max = 45});
    v("searchSamples", searchSamples,
      {.help = "pcss and gathered: places where a view sample looks for what throws shadows on it.",
       .min = 1,
       .max = 1024});
    v("blurSamples", blurSamples,
      {.help = "pcss and gathered: places whose hard shadows make up a soft one.", .min = 1, .max = 1024});
    v("blurRadius", blurRadius,
      {.help =
           "gathered: blur edges over this radius everywhere, and do not look for what throws them, which "
           "is cheaper; 0: as wide as penumbrae are.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("smooth", smooth,
      {.help = "pcss and gathered: average over 4 x 4 pixels of one surface, within penumbrae."});
    v("shadowResolution", shadowResolution,
      {.help = "Texels along a side of a shadow map: of a spot's picture, of each face of a point light's "
               "cube, of the longer side of a directional light's.",
       .unit = "texels",
       .min = 16,
       .max = 16384});
    v("shadowFilter", shadowFilter,
      {.help = "Width of the box over which a shadow map is averaged, which softens edges.",
       .unit = "texels",
       .min = 1,
       .max = 16});
    v("shadowBias", shadowBias,
      {.help = "How far a surface lit at a grazing angle is moved towards the light against its own shadow; "
               "shadows come loose by as much.",
       .unit = "texels",
       .min = 0,
       .max = 16});
  }
};

/// Whether that many shadows are soft where a light has a size.
constexpr bool areSoft(Shadows shadows) { return shadows >= Shadows::kPcss; }

/// Light that arrives straight from the lights.
class Direct {
 public:
  struct In {
    const TraceScene& trace;
    const ViewSamples& view;
    std::uint32_t seed = 0;
    std::uint32_t pass = 0;
    /// By light, 0 where it is left out; empty: none is.
    std::span<const std::uint8_t> shining = {};
    vec2 subpixel = vec2(0.5f);  ///< Where in each pixel its primary sample lies.
    /// Called once for every primary tile, from any thread, in the pass that adds the last light to it: what
    /// else reads the tile does so while it is near.
    std::function<void(std::size_t tile)> alongside = {};
  };

  explicit Direct(DirectSettings settings) : settings_(settings) {}
  bool wantsShadowMaps() const {
    return settings_.shadows == Shadows::kMap || settings_.shadows == Shadows::kPcss;
  }
  /// Renders the shadow maps, where they are wanted, of the lights that shine: for all runs until scene or
  /// lights change. Stage "direct.shadow_maps" of the statistics.
  void prepare(const RasterScene& scene, std::span<const std::uint8_t> shining, Stats& stats,
               const Job& job = {});
  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {});

 private:
  void addSoftLights(const In& in, Radiance& out, Stats& stats, const Job& job);

  DirectSettings settings_;
  ShadowMaps shadowMaps_;
  std::vector<Light> lightsOfMaps_;
  std::vector<direct::SoftLight> softLights_;  ///< By light; of size 0 where its shadows are not soft.
  direct::SoftShadows softShadows_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "settings/visit.h"
#include "stages/direct/shadow_maps.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

#include <span>
#include <vector>

namespace isophote {

/// Where the shadows of point, spot and directional lights come from; lights with an area send rays.
enum class Shadows : std::uint32_t { kTraced, kMap };
template <>
struct EnumNames<Shadows> {
  static constexpr std::array names{"traced", "map"};
};

struct DirectSettings {
  std::uint32_t areaSamples = 4;
  Shadows shadows = Shadows::kTraced;
  std::uint32_t shadowResolution = 1024;
  std::uint32_t shadowFilter = 2;
  float shadowBias = 1;

  void visit(auto&& v) {
    v("areaSamples", areaSamples,
      {.help = "Shadow rays a view sample sends to each light that has an area.", .min = 1, .max = 4096});
    v("shadows", shadows,
      {.help = "Shadows of point, spot and directional lights: a ray from each view sample, or shadow maps. "
               "Lights with an area always send rays."});
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
  };

  explicit Direct(DirectSettings settings) : settings_(settings) {}
  bool wantsShadowMaps() const { return settings_.shadows == Shadows::kMap; }
  /// Renders the shadow maps, where they are wanted, of the lights that shine: for all runs until scene or
  /// lights change. Stage "direct.shadow_maps" of the statistics.
  void prepare(const RasterScene& scene, std::span<const std::uint8_t> shining, Stats& stats,
               const Job& job = {});
  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {}) const;

 private:
  DirectSettings settings_;
  ShadowMaps shadowMaps_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/large_pages.h"
#include "math/simd.h"
#include "stages/direct/screen_taps.h"
#include "stages/direct/shadow_maps.h"
#include "stages/gbuffer/view_samples.h"
#include "trace/trace_scene.h"

#include <cstdint>
#include <vector>

namespace isophote::direct {

/// A light that has a size as far as its shadows are concerned.
struct SoftLight {
  Light light;     ///< What lights in its place: a light without extent, in its middle.
  float size = 0;  ///< Radius [m]; of directional lights the tangent of half the angle they are seen under.
  bool parallel() const { return light.type == kLightDirectional; }
};

struct SoftOptions {
  std::uint32_t searchSamples = 16;
  std::uint32_t blurSamples = 25;
  /// Above 0: every edge is blurred over this radius [m], and no distance is looked for.
  float fixedRadius = 0;
  bool smooth = true;
};

/// Soft shadows of one light after the other at the primary tiles of a view, by image space gathering
/// (Robison and Shirley 2009; SSPM 3.4): the distances to what throws shadows, averaged around each view
/// sample, say how wide its penumbra is, and the hard shadow is blurred so far, on the sample's own surface
/// alone. The disc in which a sample looks around is the light's, scaled, as it falls on the tangent plane:
/// on a flat surface, behind an occluder that faces the light, the result is exact but for the number of
/// samples. What the eye does not see can throw a shadow, but not soften one. Keeps its memory from light to
/// light.
class SoftShadows {
 public:
  struct In {
    const TraceScene& trace;
    const ViewSamples& view;
    vec2 subpixel = vec2(0.5f);  ///< Where in each pixel the primary sample lies.
    std::uint32_t pass = 0;      ///< Every pass turns the discs otherwise.
    SoftOptions options = {};
    SimdLevel simd = bestSimdLevel();
  };

  /// Begins with a view, for the lights that follow. `in` must outlive them.
  void start(const In& in, const Job& job);
  /// Image space gathering of a light.
  void gather(const SoftLight& light, const Job& job);
  /// Percentage-closer soft shadows of a light that has shadow maps.
  void lookUp(const ShadowMaps& maps, std::uint32_t index, const SoftLight& light, const Job& job);
  /// The part of the light that arrives at the lanes of a primary tile.
  void visibility(const SoftLight& light, std::size_t tile, FloatLanes& out) const;

  /// Percentage-closer soft shadows at the lanes of any tile whose bits are set.
  void visibility(const ShadowMaps& maps, std::uint32_t index, const SoftLight& light, const ViewTile& tile,
                  std::uint64_t lanes, FloatLanes& out) const;

  std::uint64_t raysTraced() const { return rays_; }  ///< For the last light.
  std::uint64_t tilesBlurred() const { return blurred_; }
  std::uint64_t bytes() const;

 private:
  Screen screen() const;
  void castHardShadow(const SoftLight& light, std::size_t tile);
  void spreadReach();
  bool anyLit(std::size_t tile) const;
  bool blurTile(const SoftLight& light, std::size_t tile);
  void setUp(const SoftLight& light, std::size_t tile, LightAim& aim, TapLanes& taps) const;

  /// Of the shadows in a tile, and then of all whose penumbrae reach it.
  struct TileShadow {
    float metres = 0;  ///< Radius of the widest penumbra; 0: there is none.
    float pixels = 0;
  };

  const In* in_ = nullptr;
  LargeVector<float> depth_, occluder_, visible_, penumbra_;
  LargeVector<std::uint32_t> normal_;
  std::vector<TileShadow> own_, inRow_, reaching_;
  std::vector<std::uint32_t> litTiles_;  ///< Sums over all tiles above and to the left.
  std::vector<std::uint32_t> raysOfTile_;
  std::vector<std::uint8_t> blurredTile_;
  std::vector<DiscTap> searchDisc_, blurDisc_;
  FloatLanes turnSine_, turnCosine_;
  std::uint64_t rays_ = 0, blurred_ = 0;
};

}  // namespace isophote::direct

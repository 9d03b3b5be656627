// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/upsample/upsample.shared.h"

#include <array>
#include <memory>

namespace isophote {

enum class UpsampleWeights : std::uint32_t {
  kNearest = kUpsampleNearest,
  kBilinear = kUpsampleBilinear,
  kNormal = kUpsampleNormal,
  kDepth = kUpsampleDepth,
};
template <>
struct EnumNames<UpsampleWeights> {
  static constexpr std::array names{"nearest", "bilinear", "normal", "depth"};
};

struct UpsampleSettings {
  UpsampleWeights weights = UpsampleWeights::kDepth;
  bool merged = false;

  void visit(auto&& v) {
    v("weights", weights,
      {.help =
           "Which subsamples a pixel's indirect light comes from: that of its cell, or four by distance on "
           "the screen (bilinear), by their normals too, by their depth too."});
    v("merged", merged,
      {.help = "Reconstruct a tile in the pass that adds shadows to it, instead of in one of its own."});
  }
};

/// Estimates indirect light at one view sample for every n x n pixels instead of at each, and reconstructs
/// the others by a joint bilateral filter (ISPM 5.2). What is interpolated has the surface's reflectance
/// divided out, which the pixel's own is multiplied into, so that textures stay sharp: irradiance, and for
/// glossy reflections their radiance over the Fresnel reflectance of a mirror.
///
/// A pixel whose surface none of the four samples around it lies on is estimated on its own. So is everything
/// seen in mirrors and through glass.
class Upsample {
 public:
  explicit Upsample(UpsampleSettings settings);
  ~Upsample();
  Upsample(Upsample&&) noexcept;
  Upsample& operator=(Upsample&&) noexcept;

  struct ChooseIn {
    const ViewSamples& view;
    std::uint32_t side = 4;  ///< Pixels on each side of a cell: n, at least 2.
    std::uint32_t pass = 0;  ///< Every pass takes another pixel of the cells.
    SimdLevel simd = bestSimdLevel();
  };
  /// Where to estimate light: valid until the next call, and as long as the view is left as it is. An
  /// estimator takes it like any view.
  const ViewSamples& choose(const ChooseIn& in, Stats& stats, const Job& job = {});

  struct In {
    const ViewSamples& view;  ///< The one that choose() was given.
    const Radiance& sparse;   ///< Estimated at what it gave.
    SimdLevel simd = bestSimdLevel();
  };
  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {});

  /// The same for a caller that visits the tiles anyway: begins, and then reconstructs primary tiles one by
  /// one, in any order and from any thread.
  void begin(const In& in, Radiance& out, Stats& stats, const Job& job = {});
  void reconstruct(const In& in, std::size_t tile, Radiance& out) const;
  bool isMerged() const { return settings_.merged; }

 private:
  struct Scratch;
  UpsampleSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote

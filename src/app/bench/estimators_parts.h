// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/suite.h"
#include "base/stats.h"
#include "image/image.h"
#include "render/settings.h"
#include "trace/trace_scene.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace isophote::bench {

/// A built-in scene, or a public one.
struct WantedScene {
  const char* name;  ///< As in rows.
  std::optional<PublicScene> file = {};
};

inline constexpr WantedScene kDabrovic{"Sponza (Dabrovic's)", PublicScene::kSponzaDabrovic};
/// What estimators and qualities are measured on.
inline constexpr std::array kEstimatorScenes{WantedScene{"cornell-box"}, WantedScene{"atrium"}, kDabrovic};

/// A scene to measure on, as it is: with its own materials.
class EstimatorScene {
 public:
  EstimatorScene(Context& context, SceneChoice choice);

  const Camera& camera() const { return choice_.scene.cameras.front(); }
  const TraceScene& trace() const { return *trace_; }
  /// The path tracer's indirect light in such a frame, through pixels' centres. Made once, for the first
  /// frame that asks.
  const Image& reference(const FrameSettings& frame);

 private:
  Context& context_;
  SceneChoice choice_;
  std::unique_ptr<TraceScene> trace_;  ///< Refers to `choice_`.
  std::optional<Image> reference_;
};

/// Scenes that were asked for, each loaded once.
class EstimatorScenes {
 public:
  explicit EstimatorScenes(Context& context) : context_(context) {}
  /// Null, and a note, where a public one is not at hand: a stand-in would be another one's row.
  EstimatorScene* find(const WantedScene& wanted);

 private:
  Context& context_;
  std::map<std::string, std::unique_ptr<EstimatorScene>> scenes_;
};

/// The radius of an estimator's own settings [m].
void setRadius(RenderSettings& settings, Estimator estimator, double metres);
/// Whether a stage or a buffer of that name belongs to the estimate, and not to what all estimators share.
bool isOfEstimate(std::string_view name);
/// What the estimate of a frame kept: lists, hierarchies, copies of the photons, what is blurred [MB].
double estimateMegabytes(const Stats& stats);

// Parts of the suite.
void benchBesidePathTracer(Context& context, EstimatorScenes& scenes);
void benchAutomaticRadius(Context& context, EstimatorScenes& scenes);
void benchQualities(Context& context, EstimatorScenes& scenes);

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/frames.h"
#include "app/bench/suite.h"
#include "render/settings.h"
#include "trace/trace_scene.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>

namespace isophote::bench {

/// Photons stored and the radius in which they are felt, as the paper sets them.
struct VschSetUp {
  std::uint32_t photons;
  float radius;
};

inline constexpr VschSetUp kVschFew{10'000, 4.0f};
inline constexpr VschSetUp kVschUsual{200'000, 1.2f};

/// Ways to estimate light that the paper compares.
enum class VschMethod : std::uint32_t {
  kTiled,        ///< Mara et al. 2013
  kCluster,      ///< Without cones and trivial accept.
  kClusterCone,  ///< With cones of normals.
  kClusterTrivial,
  kDirectional,
  kDirectionalPublished,  ///< With the published weights of octants.
};
const char* nameOf(VschMethod method);

/// A scene of the paper's, all of whose materials are diffuse, as the paper's are.
struct VschScene {
  SceneChoice choice;  ///< `trace` refers to it.
  std::unique_ptr<TraceScene> trace;

  const Camera& camera() const { return choice.scene.cameras.front(); }
};

/// Scenes that were asked for, each loaded once.
class VschScenes {
 public:
  explicit VschScenes(Context& context) : context_(context) {}
  const VschScene& operator[](PublicScene wanted);

 private:
  Context& context_;
  std::map<PublicScene, std::unique_ptr<VschScene>> scenes_;
};

/// At the paper's size, or another, with so many photons as the context says. Of fewer photons the radius
/// grows, so that as many count at a view sample.
RenderSettings vschSettings(const Context& context, VschMethod method, VschSetUp setUp,
                            std::uint32_t width = 1920, std::uint32_t height = 1080);

/// What the paper calls splatting: from view samples and photons to indirect light, with the hierarchy and
/// the blur [ms].
double splatMs(const FrameTimes& times);
double splatMs(const Stats& stats);

// Parts of the suite.
void benchVschFlights(Context& context, VschScenes& scenes);    ///< Figure 6.
void benchVschBreakdown(Context& context, VschScenes& scenes);  ///< Figures 8 and 9.
void benchVschCounts(Context& context, VschScenes& scenes);     ///< Table 1 and figure 7.
void benchVschQuality(Context& context, VschScenes& scenes);    ///< Table 2, figures 10, 11, bias of octants.
void benchVschGlossy(Context& context);                         ///< Figure 12.

}  // namespace isophote::bench

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the benchmarks of frames share: the yardstick, and public scenes.
#pragma once

#include "render/cpu_renderer.h"
#include "render/yardstick.h"
#include "scene/scene.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace isophote {

/// What Embree alone takes for a frame's primary rays, in packets of 16, on all threads [ms].
inline double primaryRaysMs(const TraceScene& trace, const CameraRays& camera, int width, int height) {
  const auto start = std::chrono::steady_clock::now();
  benchmark::DoNotOptimize(tracePrimaryRays(trace, camera, width, height));
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// A model in the folder that ISOPHOTE_ASSETS names, lit by one point light of so many watts; nothing without
/// that folder.
inline std::optional<Scene> assetScene(const std::string& model, vec3 light, float watts,
                                       const Camera& camera) {
  const char* folder = std::getenv("ISOPHOTE_ASSETS");
  if (!folder) return std::nullopt;
  Scene scene = loadScene((std::filesystem::path(folder) / model).string());
  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = light;
  lamp.colour = vec3(watts / (4.0f * kPi));
  scene.lights = {lamp};
  scene.cameras = {camera};
  finishScene(scene, model);
  return scene;
}

}  // namespace isophote

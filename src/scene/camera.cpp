// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "scene/scene.h"
#include "scene/validate.h"

#include <cmath>

namespace isophote {

const Camera& findCamera(const Scene& scene, const std::string& name) {
  if (scene.cameras.empty()) failInput(scene.name, "the scene has no camera");
  if (name.empty()) return scene.cameras.front();
  std::string names;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == name) return camera;
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", camera.name);
  }
  failUsage("--camera", "the scene has no camera \"{}\"; it has {}", name, names);
}

CameraRays cameraRays(const Camera& camera, int width, int height) {
  validateCamera(camera, "");
  if (width < 1 || height < 1) failUsage("", "a picture of {} x {} pixels cannot be made", width, height);
  CameraRays rays{};
  rays.eye = camera.eye;
  rays.forward = normalize(camera.target - camera.eye);
  // Where `up` is missing or along the view, the axis that is least along it takes its place.
  vec3 right = cross(rays.forward, camera.up);
  if (length(right) <= 1e-4f * length(camera.up)) {
    const vec3 a = abs(rays.forward);
    right = cross(rays.forward, a.y <= a.z ? vec3(0, 1, 0) : vec3(0, 0, -1));
  }
  right = normalize(right);
  const bool orthographic = camera.orthographicHeight > 0.0f;
  const float halfHeight = orthographic ? 0.5f * camera.orthographicHeight
                                        : std::tan(0.5f * camera.verticalFovDegrees * (kPi / 180.0f));
  rays.orthographic = orthographic ? 1.0f : 0.0f;
  rays.right = right * (halfHeight * float(width) / float(height));
  rays.up = cross(right, rays.forward) * halfHeight;
  return rays;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/defaults.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <limits>

namespace isophote {

namespace {

enum class Layout { kObject, kStage, kRoom };

struct Probe {
  vec3 direction;
  float distance = std::numeric_limits<float>::max();  ///< To the first surface [m].
  bool front = false;                                  ///< Whether its front was met, by its winding.
  bool hit() const { return distance < std::numeric_limits<float>::max(); }
};

/// Narrows the probe's distance to the nearest triangle of a mesh. All in object space; the direction is not
/// unit, so that distances stay those of world space. A brute-force loop: it runs once, over a few dozen
/// rays.
void intersect(const Mesh& mesh, vec3 origin, vec3 direction, Probe& probe) {
  for (const uvec3& t : mesh.triangles) {
    const vec3 v0 = mesh.positions[t.x];
    const vec3 edge1 = mesh.positions[t.y] - v0;
    const vec3 edge2 = mesh.positions[t.z] - v0;
    const vec3 normal = cross(edge1, edge2);
    const float facing = -dot(direction, normal);
    const vec3 toOrigin = origin - v0;
    const vec3 m = cross(toOrigin, direction);
    const float u = dot(edge2, m) / facing;
    const float v = -dot(edge1, m) / facing;
    const float distance = dot(toOrigin, normal) / facing;
    if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f && distance > 0.0f && distance < probe.distance) {
      probe.distance = distance;
      probe.front = facing > 0.0f;
    }
  }
}

void trace(const Scene& scene, vec3 origin, Probe& probe) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const mat3 objectFromWorld = glm::inverse(mat3(instance.worldFromObject));
    intersect(mesh, objectFromWorld * (origin - instance.worldFromObject[3]),
              objectFromWorld * probe.direction, probe);
  }
}

/// How a scene lies around the middle of its bounds.
struct Surroundings {
  Layout layout = Layout::kObject;
  vec3 open{0};      ///< Stage: the way out.
  vec3 longAxis{0};  ///< Room: the horizontal axis that reaches farther...
  float ahead = 0;   ///< ...how far along it is free [m]...
  float behind = 0;  ///< ...and how far against it.
  float above = 0;   ///< Free height over the middle [m].
};

Surroundings explore(const Scene& scene) {
  // Spiral points cover the sphere evenly; after them come five rays around each horizontal axis, and one
  // upwards.
  constexpr int kSpiral = 48;
  constexpr int kPerAxis = 5;
  const std::array<vec3, 4> axes{vec3(0, 0, 1), vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 0, -1)};
  std::array<Probe, kSpiral + 4 * kPerAxis + 1> probes;
  for (int i = 0; i < kSpiral; ++i) {
    const float y = 1.0f - 2.0f * (float(i) + 0.5f) / float(kSpiral);
    const float angle = 2.39996323f * float(i);
    const float r = sqrt(1.0f - y * y);
    probes[i].direction = vec3(r * cos(angle), y, r * sin(angle));
  }
  for (int a = 0; a < 4; ++a) {
    const vec3 side(axes[a].z, 0, axes[a].x);
    const std::array<vec3, kPerAxis> offsets{vec3(0), side, -side, vec3(0, 1, 0), vec3(0, -1, 0)};
    for (int k = 0; k < kPerAxis; ++k)
      probes[kSpiral + a * kPerAxis + k].direction = normalize(axes[a] + 0.1f * offsets[k]);
  }
  probes.back().direction = vec3(0, 1, 0);
  const vec3 middle = scene.bounds.centre();
  tbb::parallel_for(std::size_t(0), probes.size(), [&](std::size_t i) { trace(scene, middle, probes[i]); });

  int fronts = 0;
  for (int i = 0; i < kSpiral; ++i) fronts += probes[i].hit() && probes[i].front ? 1 : 0;
  Surroundings result;
  const auto reach = [&](const Probe& probe) {
    return min(probe.distance, dot(abs(probe.direction), 0.5f * scene.bounds.size()));
  };
  result.above = reach(probes.back());
  if (fronts < (kSpiral * 2) / 3) return result;
  const auto axisProbes = [&](int a) { return &probes[kSpiral + a * kPerAxis]; };
  for (int a = 0; a < 4; ++a) {
    bool open = true;
    for (int k = 0; k < kPerAxis; ++k) open &= !axisProbes(a)[k].hit();
    if (!open) continue;
    result.layout = Layout::kStage;
    result.open = axes[a];
    return result;
  }
  result.layout = Layout::kRoom;
  const bool alongX = scene.bounds.size().x >= scene.bounds.size().z;
  result.longAxis = alongX ? axes[2] : axes[3];
  result.ahead = reach(*axisProbes(alongX ? 2 : 3));
  result.behind = reach(*axisProbes(alongX ? 1 : 0));
  return result;
}

/// A camera that looks along -`from` at the middle of the bounds, from so far that every corner is in view.
Camera framing(const Bounds& bounds, vec3 from) {
  constexpr float kFov = 40.0f;
  constexpr float kAspect = 4.0f / 3.0f;
  const vec3 right = normalize(cross(vec3(0, 1, 0), from));
  const vec3 up = cross(from, right);
  const float slope = std::tan(0.5f * kFov * (kPi / 180.0f));
  const vec3 half = 0.5f * bounds.size();
  float distance = 0.0f;
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 offset(corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                      corner & 4 ? half.z : -half.z);
    const float reach = max(abs(dot(offset, up)), abs(dot(offset, right)) / kAspect);
    distance = max(distance, dot(offset, from) + reach / slope);
  }
  Camera camera;
  camera.target = bounds.centre();
  // 5 % of air; a lone point has no size to frame.
  camera.eye = camera.target + from * max(1.05f * distance, 1e-3f + 1e-3f * length(camera.target));
  camera.verticalFovDegrees = kFov;
  return camera;
}

Camera defaultCamera(const Bounds& bounds, const Surroundings& around) {
  Camera camera;
  if (around.layout == Layout::kRoom) {
    const vec3 middle = bounds.centre() - vec3(0, 0.15f * bounds.size().y, 0);
    camera.eye = middle - around.longAxis * (0.8f * around.behind);
    camera.target = middle + around.longAxis * (0.5f * around.ahead);
    camera.verticalFovDegrees = 60.0f;
  } else {
    camera =
        framing(bounds, around.layout == Layout::kStage ? around.open : normalize(vec3(0.5f, 0.4f, 1.0f)));
  }
  camera.name = "default";
  return camera;
}

void addDefaultLights(Scene& scene, const Surroundings& around) {
  Light light{};
  if (around.layout == Layout::kObject) {
    light.type = kLightDirectional;
    // Top, front and right side of a box differ by factors of two, and all from the sky behind them.
    light.direction = normalize(vec3(-0.25f, -1.0f, -0.6f));
    light.colour = vec3(2.7f);
    scene.lights.push_back(light);
    light = Light{};
    light.type = kLightEnvironment;
    light.colour = vec3(0.25f);
  } else {
    const float height = 0.7f * around.above;
    light.type = kLightPoint;
    light.position = scene.bounds.centre() + vec3(0, height, 0);
    light.colour = vec3(10.0f * height * height);
  }
  scene.lights.push_back(light);
}

}  // namespace

void addDefaults(Scene& scene, const std::string& subject, const Job& job) {
  const bool needsLight = scene.lights.empty();
  if (!needsLight && !scene.cameras.empty()) return;
  const Surroundings around = explore(scene);
  if (scene.cameras.empty()) {
    scene.cameras.push_back(defaultCamera(scene.bounds, around));
    job.info(fmt::format("{}: no camera in the scene; one that frames it is used", subject));
  }
  if (!needsLight) return;
  addDefaultLights(scene, around);
  job.warn(fmt::format(
      "{}: nothing in the scene emits light; {} is used", subject,
      around.layout == Layout::kObject ? "a sun with a sky" : "a point light in the upper middle"));
}

}  // namespace isophote

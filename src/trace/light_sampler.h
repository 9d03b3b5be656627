// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/emission.shared.h"
#include "scene/mesh_emission.h"
#include "trace/surface.h"
#include "trace/trace_scene.h"

#include <algorithm>
#include <vector>

namespace isophote {

/// Next-event estimation and its counterpart: a light seen from a point, and the lights that a ray happens to
/// meet. Keeps a reference to the scene: make it anew for each frame.
class LightSampler {
 public:
  explicit LightSampler(const TraceScene& trace);

  const Scene& scene() const { return scene_; }
  std::size_t lightCount() const { return lights_.size(); }

  /// Light `index` as seen from a point whose geometric normal (eye's side) is ng; u.x picks the triangle of
  /// a mesh, or how an environment is sampled. Visibility is the caller's.
  LightSample sample(std::uint32_t index, vec3 from, vec3 ng, vec3 u) const;

  /// Calls visit(light index, radiance, pdf) for every light that the ray meets up to its hit (or at infinity
  /// where there is none); pdf is sample()'s density of that direction, per solid angle, for ray.origin and
  /// ng.
  template <class Visit>
  void visitMet(const TraceScene& trace, const Ray& ray, const Hit& hit, vec3 ng, Visit&& visit) const;

 private:
  const Scene& scene_;
  std::span<const Light> lights_;
  std::vector<std::uint32_t> lightOfInstance_;  ///< kNoLight where it does not emit.
  std::vector<std::uint32_t>
      shapeLights_;  ///< Spheres, rectangles and environments: not among the triangles.

  static constexpr std::uint32_t kNoLight = 0xffffffffu;
};

/// Radiance of the sphere, rectangle and environment lights along a ray up to its hit: what an eye sees of
/// them besides the triangles. Lights emit but do not block.
vec3 shapeLightRadiance(const TraceScene& trace, const Ray& ray, const Hit& hit);

/// Whether shapeLightRadiance() can be anything but 0.
bool hasShapeLights(const TraceScene& trace);

template <class Visit>
void LightSampler::visitMet(const TraceScene& trace, const Ray& ray, const Hit& hit, vec3 ng,
                            Visit&& visit) const {
  for (const std::uint32_t index : shapeLights_) {
    const Light& light = lights_[index];
    if (light.type == kLightEnvironment) {
      if (hit.valid()) continue;
      const EnvironmentView view = viewEnvironment(scene_.environment, light, ray.direction, ng);
      visit(index, view.radiance, view.pdf);
    } else if (light.type == kLightRectangle) {
      const float t = intersectRectangleLight(light, ray.origin, ray.direction);
      if (t > 0.0f && t < hit.t)
        visit(index, light.colour, areaSamplePdf(ray.direction * t, light.direction, light.area));
    } else {
      const float t = intersectSphereLight(light, ray.origin, ray.direction);
      if (t > 0.0f && t < hit.t) visit(index, sphereRadiance(light), sphereLightPdf(light, ray.origin));
    }
  }
  if (!hit.valid() || lightOfInstance_[hit.instance] == kNoLight) return;
  const std::uint32_t index = lightOfInstance_[hit.instance];
  const Light& light = lights_[index];
  const Surface s = surfaceAt(trace, ray, hit);
  if (s.emission == vec3(0.0f)) return;
  const ShadedTriangle t = worldTriangle(trace.instance(hit.instance), hit.triangle);
  const float area = 0.5f * length(cross(t.position[1] - t.position[0], t.position[2] - t.position[0]));
  const float pdf = areaSamplePdf(s.position - ray.origin, s.ng, area);
  visit(index, s.emission, pdf * triangleProbability(scene_, light, hit.triangle));
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/light_sampler.h"

namespace isophote {

namespace {
bool hasShape(const Light& light) {
  return light.type == kLightRectangle || light.type == kLightEnvironment ||
         (light.type == kLightPoint && light.radius > 0.0f);
}
}  // namespace

LightSampler::LightSampler(const TraceScene& trace)
    : scene_(trace.scene()), lights_(trace.lights()), lightOfInstance_(scene_.instances.size(), kNoLight) {
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    const Light& light = lights_[i];
    if (light.type == kLightMesh)
      lightOfInstance_[scene_.emissiveTriangles[light.firstTriangle].instance] = i;
    else if (hasShape(light))
      shapeLights_.push_back(i);
  }
}

LightSample LightSampler::sample(std::uint32_t index, vec3 from, vec3 ng, vec3 u) const {
  const Light& light = lights_[index];
  const vec2 u2(u.y, u.z);
  switch (light.type) {
    case kLightPoint:
      return samplePoint(light, from, u2);
    case kLightSpot:
      return sampleSpot(light, from);
    case kLightDirectional:
      return sampleDirectional(light);
    case kLightRectangle:
      return sampleRectangle(light, from, u2);
    case kLightEnvironment:
      // The first bit of u.y chooses: samples that are stratified in y and z stay so within each choice.
      if (light.mapped == 0u) return sampleEnvironment(light, ng, u2);
      return sampleEnvironmentLight(scene_.environment, light, ng,
                                    vec3(u.y, u.y < 0.5f ? 2.0f * u.y : 2.0f * u.y - 1.0f, u.z));
    default:
      break;
  }
  const EmissiveTriangle& chosen = chooseTriangle(scene_, light, u.x);
  return sampleEmissiveTriangle(litAt(scene_, chosen, u2), chosen.probability, from, u2);
}

bool hasShapeLights(const TraceScene& trace) {
  return std::any_of(trace.lights().begin(), trace.lights().end(), hasShape);
}

vec3 shapeLightRadiance(const TraceScene& trace, const Ray& ray, const Hit& hit) {
  vec3 sum(0.0f);
  for (const Light& light : trace.lights()) {
    if (!hasShape(light)) continue;
    if (light.type == kLightEnvironment) {
      if (!hit.valid()) sum += environmentRadiance(trace.scene().environment, light, ray.direction);
      continue;
    }
    const bool rectangle = light.type == kLightRectangle;
    const float t = rectangle ? intersectRectangleLight(light, ray.origin, ray.direction)
                              : intersectSphereLight(light, ray.origin, ray.direction);
    if (t > 0.0f && t < hit.t) sum += rectangle ? light.colour : sphereRadiance(light);
  }
  return sum;
}

}  // namespace isophote

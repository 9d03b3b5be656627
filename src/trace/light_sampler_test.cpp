// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/light_sampler.h"

#include "support/statistics.h"

namespace isophote {
namespace {

const vec3 kFrom(0.1f, -0.2f, 0.0f);
const vec3 kNormal(0.0f, 0.0f, 1.0f);

/// Three triangles of different sizes around one point, facing down; apart from them nothing lies above
/// kFrom.
Scene sceneWithPatch(vec3 emission, uint flags) {
  Scene scene;
  Material material = makeMaterial();
  material.emission = emission;
  material.flags = flags;
  scene.materials.push_back({material, "patch"});
  Mesh mesh;
  mesh.positions = {
      {0, 0, 1}, {1.5f, 0.2f, 1.1f}, {0.3f, 0.6f, 1.3f}, {-0.7f, 0.1f, 0.9f}, {-0.1f, -0.4f, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}};
  scene.meshes.push_back(mesh);
  Instance instance;
  instance.worldFromObject = mat4x3(1.0f);
  instance.worldFromObject[3] = vec3(0.1f, 0.0f, emission == vec3(0.0f) ? -50.0f : 0.0f);
  scene.instances.push_back(instance);
  return scene;
}

Scene sceneWithLight(Light light) {
  Scene scene = sceneWithPatch(vec3(0.0f), 0u);
  light.colour = vec3(3.0f);
  scene.lights.push_back(light);
  finishScene(scene, "test");
  return scene;
}

/// The directions of sample() follow the density that visitMet() gives to rays that meet the light, and both
/// tell of the same radiance.
void expectSamplesMeetTheLight(const Scene& scene, std::uint32_t stream) {
  ASSERT_EQ(scene.lights.size(), 1u);
  const TraceScene trace(scene);
  const LightSampler lights(scene);
  float radiance = 0.0f;
  const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
    const LightSample s = lights.sample(0, kFrom, kNormal, randomTriple(stream, i));
    if (s.pdf <= 0.0f) return std::nullopt;
    radiance = s.radiance.x;
    return s.wi;
  };
  float met = -1.0f;
  const auto pdf = [&](vec3 w) {
    const Ray ray{kFrom, 0.0f, w, 1e30f};
    double density = 0;
    lights.visitMet(trace, ray, trace.closestHit(ray), kNormal, [&](std::uint32_t, vec3 emitted, float p) {
      density += double(p);
      met = emitted.x;
    });
    return density;
  };
  EXPECT_TRUE(
      samplesFollow(kSphereDomain, sample, pdf, {.samples = testSamples(100'000), .tests = 5, .depth = 3}));
  EXPECT_EQ(met, radiance);
}

TEST(LightSampler, MeshLightsAreMetAsOftenAsSampled) {
  for (const uint flags : {0u, kMaterialDoubleSided}) {
    Scene scene = sceneWithPatch(vec3(2.0f), flags);
    finishScene(scene, "test");
    expectSamplesMeetTheLight(scene, 1);
  }
}

TEST(LightSampler, SpheresAreMetAsOftenAsSampled) {
  Light light{};
  light.type = kLightPoint;
  light.position = vec3(0.4f, 0.9f, 1.2f);
  light.radius = 0.6f;
  expectSamplesMeetTheLight(sceneWithLight(light), 2);
}

TEST(LightSampler, RectanglesAreMetAsOftenAsSampled) {
  Light light{};
  light.type = kLightRectangle;
  light.position = vec3(-0.5f, -0.4f, 1.0f);
  light.edgeU = vec3(0.0f, 1.0f, 0.2f);
  light.edgeV = vec3(1.3f, 0.0f, 0.1f);
  const vec3 n = cross(light.edgeU, light.edgeV);
  light.area = length(n);
  light.direction = n / light.area;
  expectSamplesMeetTheLight(sceneWithLight(light), 3);
}

TEST(LightSampler, EnvironmentsAreMetAsOftenAsSampled) {
  Light light{};
  light.type = kLightEnvironment;
  expectSamplesMeetTheLight(sceneWithLight(light), 4);
}

TEST(LightSampler, BacksOfOneSidedMeshesAreDark) {
  Scene scene = sceneWithPatch(vec3(2.0f), 0u);
  finishScene(scene, "test");
  const TraceScene trace(scene);
  const LightSampler lights(scene);
  const Ray ray{vec3(0.5f, 0.15f, 3.0f), 0.0f, vec3(0.0f, 0.0f, -1.0f), 1e30f};
  const Hit hit = trace.closestHit(ray);
  ASSERT_TRUE(hit.valid());
  lights.visitMet(trace, ray, hit, -kNormal, [](auto...) { ADD_FAILURE() << "met from behind"; });
  EXPECT_EQ(lights.sample(0, ray.origin, -kNormal, vec3(0.5f)).pdf, 0.0f);
}

}  // namespace
}  // namespace isophote

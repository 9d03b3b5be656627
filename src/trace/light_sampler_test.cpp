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
  const LightSampler lights(trace);
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

/// Where the radiance differs from place to place: each sample that a ray meets again is met with the
/// radiance and density that it had, and what samples bring in agrees with what rays of every direction meet.
void expectSamplesTellWhatRaysMeet(const Scene& scene, std::uint32_t stream) {
  ASSERT_EQ(scene.lights.size(), 1u);
  const TraceScene trace(scene);
  const LightSampler lights(trace);
  Moments bySamples, byRays;
  const auto met = [&](vec3 w, vec3& radiance) {
    float pdf = 0.0f;
    const Ray ray{kFrom, 0.0f, w, 1e30f};
    lights.visitMet(trace, ray, trace.closestHit(ray), kNormal, [&](std::uint32_t, vec3 emitted, float p) {
      radiance = emitted;
      pdf = p;
    });
    return pdf;
  };
  int lost = 0;
  constexpr std::uint32_t kSamples = 40'000;
  for (std::uint32_t i = 0; i < testSamples(kSamples); ++i) {
    const LightSample s = lights.sample(0, kFrom, kNormal, randomTriple(stream, i));
    const float cosine = std::max(dot(s.wi, kNormal), 0.0f);
    bySamples.add(s.pdf > 0.0f ? double(s.radiance.y * cosine / s.pdf) : 0.0);
    vec3 radiance(0.0f);
    const float pdf = s.pdf > 0.0f ? met(s.wi, radiance) : 0.0f;
    if (s.pdf > 0.0f && s.radiance.y > 0.0f) {
      // The ray may slip through an edge, or fall into a texel beside.
      lost += std::abs(pdf / s.pdf - 1.0f) < 1e-2f && length(radiance - s.radiance) < 0.05f * length(radiance)
                  ? 0
                  : 1;
    }
    const vec3 w = sampleSphere(vec2(randomTriple(stream + 1, i)));
    vec3 seen(0.0f);
    met(w, seen);
    byRays.add(double(seen.y * std::max(dot(w, kNormal), 0.0f)) * 4 * M_PI);
  }
  EXPECT_LT(lost, int(testSamples(kSamples)) / 50);
  EXPECT_TRUE(sameMean(bySamples, byRays, 3));
}

/// The patch with a glowing texture that differs on each of its triangles, and holes where `masked`.
Scene sceneWithTexturedPatch(uint flags) {
  Scene scene = sceneWithPatch(vec3(2.0f, 3.0f, 4.0f), flags);
  Texture texture;
  texture.width = texture.height = 8;
  for (int i = 0; i < 64; ++i) texture.floats.push_back(i % 5 == 0 ? vec3(9.0f) : vec3(0.1f * float(i % 7)));
  scene.textures.push_back(texture);
  scene.materials[0].emissionTexture = 0;
  texture.floats.clear();
  for (int i = 0; i < 64; ++i)
    for (const int value : {255, 255, 255, (i / 8 + i) % 4 == 0 ? 0 : 255})
      texture.rgba.push_back(std::uint8_t(value));
  scene.textures.push_back(texture);
  scene.materials[0].baseColourTexture = 1;
  scene.materials[0].alphaCutoff = 0.5f;
  scene.meshes[0].uvs = {{0.1f, 0.2f}, {0.9f, 0.1f}, {0.7f, 0.9f}, {-0.3f, 0.6f}, {0.5f, -0.8f}};
  finishScene(scene, "test");
  return scene;
}

TEST(LightSampler, TexturedMeshesAreMetAsTheyAreSampled) {
  expectSamplesTellWhatRaysMeet(sceneWithTexturedPatch(0u), 10);
  expectSamplesTellWhatRaysMeet(sceneWithTexturedPatch(kMaterialDoubleSided | kMaterialAlphaMask), 12);
}

TEST(LightSampler, EnvironmentMapsAreMetAsTheyAreSampled) {
  Scene scene = sceneWithPatch(vec3(0.0f), 0u);
  scene.environment.radiance = Image(32, 16, vec3(0.2f, 0.3f, 0.5f));
  scene.environment.radiance.at(9, 3) = vec3(90.0f, 80.0f, 70.0f);
  Light light{};
  light.type = kLightEnvironment;
  light.mapped = 1u;
  light.colour = vec3(2.0f);
  light.edgeU = normalize(vec3(0.0f, 1.0f, 0.3f));
  light.edgeV = vec3(1.0f, 0.0f, 0.0f);
  scene.lights.push_back(light);
  finishScene(scene, "test");
  expectSamplesTellWhatRaysMeet(scene, 14);
}

TEST(LightSampler, BacksOfOneSidedMeshesAreDark) {
  Scene scene = sceneWithPatch(vec3(2.0f), 0u);
  finishScene(scene, "test");
  const TraceScene trace(scene);
  const LightSampler lights(trace);
  const Ray ray{vec3(0.5f, 0.15f, 3.0f), 0.0f, vec3(0.0f, 0.0f, -1.0f), 1e30f};
  const Hit hit = trace.closestHit(ray);
  ASSERT_TRUE(hit.valid());
  lights.visitMet(trace, ray, hit, -kNormal, [](auto...) { ADD_FAILURE() << "met from behind"; });
  EXPECT_EQ(lights.sample(0, ray.origin, -kNormal, vec3(0.5f)).pdf, 0.0f);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// --preset ispm against the path tracer, in every scene that its papers' kind of picture asks for and with
// every kind of light, and against itself with all photons traced.
#include "agreement/agreement.h"
#include "render/cpu_renderer.h"

#include <array>
#include <cmath>

namespace isophote {
namespace {

RenderSettings ispmSettings(const Case& c) {
  RenderSettings settings = presetSettings("ispm");
  settings.frame.subsample = 1;  // Every pixel: what upsampling adds is tested by itself.
  settings.frame.width = c.width;
  settings.frame.height = c.height;
  settings.photonTrace.photons = c.photons;
  // Volumes flat enough not to reach from one small feature to the next.
  settings.photonVolumes.flatness = 0.4f;
  settings.direct.areaSamples = 1;
  settings.direct.shadowResolution = 64;
  return settings;
}

void expectIspmAgrees(const Scene& scene, const Case& c, bool noisy = false) {
  const TraceScene trace(scene);
  const Mean expected = meanOfReference(reference(trace, c));
  expectMeanAgrees(c, "ispm", extrapolatedIndirect(trace, ispmSettings(c), c), expected, noisy);
}

void expectIspmAgrees(const Case& c, bool noisy = false) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const std::optional<Scene> scene = sceneOf(c.scene);
  if (!scene) GTEST_SKIP() << whyNoScene();
  expectIspmAgrees(*scene, c, noisy);
}

TEST(IspmAgreement, CornellObjects) {
  expectIspmAgrees({"cornell-objects", 128, 128, 768, 1'500'000, 4, 0.04f}, true);
}
TEST(IspmAgreement, Atrium) { expectIspmAgrees({"atrium", 160, 90, 384, 2'500'000, 4, 0.12f}); }
TEST(IspmAgreement, SponzaDabrovic) {
  expectIspmAgrees({"sponza-dabrovic.json", 160, 90, 384, 2'000'000, 4, 0.12f}, true);
}
/// Without gloss and smooth normals: with them single photons that glossy surfaces mirror to the eye, or that
/// arrive at grazing angles, let the mean of millions scatter by several per cent, map or no map. Its drapery
/// and mouldings want small volumes, and these many pixels, so that few photons fall between them.
TEST(IspmAgreement, SponzaCrytek) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  std::optional<Scene> scene = sceneOf("sponza-crytek.json");
  if (!scene) GTEST_SKIP() << whyNoScene();
  for (Mesh& mesh : scene->meshes) mesh.normals.clear();
  for (NamedMaterial& material : scene->materials) {
    material.normalTexture = material.metallicRoughnessTexture = -1;
    material.metallic = 0.0f;
    material.roughness = 1.0f;
    material.specular = 0.0f;
  }
  expectIspmAgrees(*scene, {"sponza-crytek", 640, 360, 16, 4'000'000, 8, 0.03f}, true);
}
TEST(IspmAgreement, Sibenik) { expectIspmAgrees({"sibenik.json", 160, 90, 384, 2'000'000, 4, 0.12f}, true); }
TEST(IspmAgreement, Zdm2) { expectIspmAgrees({"zdm2-lamps.json", 160, 90, 256, 1'000'000, 4, 0.2f}, true); }

/// Under sun and sky one alley of the level, seen from above, where most of the photons that enter it arrive.
TEST(IspmAgreement, Zdm2UnderSunAndSky) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  std::optional<Scene> scene = sceneOf("zdm2.json");
  if (!scene) GTEST_SKIP() << whyNoScene();
  Camera& camera = scene->cameras.front();
  camera.eye = {-9, 16, 10};
  camera.target = {-9.5f, 0, 12};
  expectIspmAgrees(*scene, {"zdm2, sun and sky", 160, 90, 384, 4'000'000, 10, 0.2f}, true);
}

// ---------------------------------------------------------------- lights, one by one

/// The Cornell box, its lamp replaced by another light.
Scene boxLitBy(Light light) {
  Scene scene = loadScene("cornell-box");
  for (NamedMaterial& material : scene.materials) material.emission = vec3(0.0f);
  scene.emissiveTriangles.clear();
  scene.lights = {light};
  finishScene(scene, "box");
  return scene;
}

Light pointLight() {
  Light light{};
  light.type = kLightPoint;
  light.position = {0.2f, 1.7f, 0.2f};
  light.colour = {1.2f, 1.0f, 0.8f};
  return light;
}

Light spotLight() {
  Light light = pointLight();
  light.type = kLightSpot;
  light.direction = normalize(vec3(-0.3f, -1, -0.4f));
  light.cosInner = std::cos(0.4f);
  light.cosOuter = std::cos(0.7f);
  return light;
}

/// Shines in through the open side.
Light sunLight() {
  Light light{};
  light.type = kLightDirectional;
  light.direction = normalize(vec3(0.2f, -0.5f, -1));
  light.colour = {2.0f, 1.9f, 1.7f};
  return light;
}

Light rectangleLight() {
  Light light{};
  light.type = kLightRectangle;
  light.position = {-0.3f, 1.9f, -0.3f};
  light.edgeU = {0.6f, 0, 0};
  light.edgeV = {0, 0, 0.6f};
  light.direction = {0, -1, 0};
  light.area = 0.36f;
  light.colour = {3.0f, 2.8f, 2.4f};
  return light;
}

Light skyLight() {
  Light light{};
  light.type = kLightEnvironment;
  light.colour = {0.8f, 0.9f, 1.1f};
  return light;
}

void expectAgreementLitBy(const char* name, const Light& light, std::uint32_t photons) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  expectIspmAgrees(boxLitBy(light), {name, 96, 96, 768, photons, 4, 0.06f});
}

TEST(IspmAgreement, PointLight) { expectAgreementLitBy("point light", pointLight(), 800'000); }
TEST(IspmAgreement, SpotLight) { expectAgreementLitBy("spot light", spotLight(), 800'000); }
TEST(IspmAgreement, DirectionalLight) { expectAgreementLitBy("directional light", sunLight(), 1'500'000); }
TEST(IspmAgreement, RectangleLight) { expectAgreementLitBy("rectangle light", rectangleLight(), 800'000); }
TEST(IspmAgreement, EnvironmentLight) { expectAgreementLitBy("environment light", skyLight(), 5'000'000); }

// ---------------------------------------------------------------- bounce maps against tracing

/// The same kernels, photons that start on bounce maps or at the light: the same light up to noise.
TEST(IspmAgreement, MapsAndTracingEmitTheSameLight) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise, for which the sanitizers are too slow";
  struct Named {
    const char* name;
    Light light;
  };
  const std::array lights{Named{"point", pointLight()}, Named{"spot", spotLight()}, Named{"sun", sunLight()}};
  constexpr std::uint32_t kSeeds = 12;
  for (const auto& [name, light] : lights) {
    const Scene scene = boxLitBy(light);
    const TraceScene trace(scene);
    RenderSettings settings = ispmSettings({name, 64, 64, 0, testSamples(100'000), 0, 0.0f});
    settings.photonVolumes.radius = 0.1f;
    Trials onMaps, traced;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      settings.frame.seed = seed;
      settings.frame.firstBounce = FirstBounce::kMap;
      onMaps.add(meanOfIndirect(trace, settings));
      settings.frame.seed = seed + 100;
      settings.frame.firstBounce = FirstBounce::kTraced;
      traced.add(meanOfIndirect(trace, settings));
    }
    const Mean a = onMaps.mean(), b = traced.mean();
    const double deviation = std::hypot(a.deviation, b.deviation);
    std::printf("%s: on maps %.5f +- %.5f, traced %.5f +- %.5f\n", name, a.value, a.deviation, b.value,
                b.deviation);
    EXPECT_LT(deviation, 0.004 * b.value) << name;
    // Deviations that are themselves estimated from 12 values each: Student's t with 22 degrees of freedom
    // exceeds a normal variable by 20 % here.
    EXPECT_LT(std::abs(a.value - b.value), 1.2 * zScore(significance(int(lights.size()))) * deviation)
        << name;
  }
}

}  // namespace
}  // namespace isophote

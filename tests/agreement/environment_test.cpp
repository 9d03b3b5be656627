// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Light from outside of the scene: the eye, direct light, photons and the path tracer must tell of one sky.
#include "render/cpu_frame.h"
#include "render/reference.h"
#include "scene/builtin/shapes.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace isophote {
namespace {

constexpr int kSide = 24;

NamedMaterial matt(const char* name, vec3 colour) {
  NamedMaterial m{makeMaterial(), name};
  m.baseColour = colour;
  m.specular = 0.0f;
  m.metallic = 0.0f;
  return m;
}

/// Three walls around a floor, with a box on it, open upwards and to the eye.
Scene courtyard() {
  Scene scene;
  scene.materials.push_back(matt("wall", vec3(0.8f, 0.6f, 0.4f)));
  scene.materials.push_back(matt("box", vec3(0.3f, 0.5f, 0.8f)));
  const auto add = [&](const char* name, std::uint32_t material, vec3 lower, vec3 upper) {
    Mesh mesh;
    mesh.material = material;
    addBox(mesh, lower, upper);
    scene.instances.push_back({name, std::uint32_t(scene.meshes.size())});
    scene.meshes.push_back(std::move(mesh));
  };
  add("floor", 0, {-2.0f, -0.1f, -2.0f}, {2.0f, 0.0f, 2.0f});
  add("left", 0, {-2.2f, -0.1f, -2.0f}, {-2.0f, 2.0f, 2.0f});
  add("right", 0, {2.0f, -0.1f, -2.0f}, {2.2f, 2.0f, 2.0f});
  add("back", 0, {-2.2f, -0.1f, -2.2f}, {2.2f, 2.0f, -2.0f});
  add("box", 1, {-0.5f, 0.0f, -0.7f}, {0.6f, 0.9f, 0.4f});
  Camera camera;
  camera.eye = {0.3f, 3.0f, 5.5f};
  camera.target = {0.0f, 0.6f, 0.0f};
  camera.verticalFovDegrees = 45;
  scene.cameras.push_back(camera);
  return scene;
}

/// A lat-long sky with a small sun that gives about half of its light.
void addMap(Scene& scene, bool sun) {
  Image& map = scene.environment.radiance;
  map = Image(64, 32, vec3(0.05f));
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 64; ++x)
      map.at(x, y) = vec3(0.4f, 0.6f, 1.0f) * (1.0f + 0.5f * float(x % 16) / 16.0f);
  if (sun) map.at(40, 7) = vec3(600.0f, 500.0f, 400.0f);
  Light light{};
  light.type = kLightEnvironment;
  light.mapped = 1u;
  light.colour = vec3(1.0f);
  light.edgeU = normalize(vec3(1.0f, 0.0f, -0.4f));
  light.edgeV = vec3(0, 1, 0);
  scene.lights.push_back(light);
}

void addConstantSkyAndSun(Scene& scene) {
  Light sky{};
  sky.type = kLightEnvironment;
  sky.colour = vec3(0.4f, 0.6f, 1.0f);
  scene.lights.push_back(sky);
  Light sun{};
  sun.type = kLightDirectional;
  sun.direction = normalize(vec3(0.4f, -1.0f, -0.5f));
  sun.colour = vec3(3.0f, 2.5f, 2.0f);
  scene.lights.push_back(sun);
}

double meanOfImage(const Image& image, int quadrant) {
  double sum = 0;
  const int half = kSide / 2;
  for (int y = 0; y < half; ++y)
    for (int x = 0; x < half; ++x) {
      const vec3 p = image.at(x + half * (quadrant % 2), y + half * (quadrant / 2));
      sum += double(p.x + p.y + p.z) / 3.0;
    }
  return sum / (half * half);
}

/// Of a layer, over seeds: in each quarter of the picture.
using Quarters = std::array<Moments, 4>;

void add(Quarters& quarters, const Image& image) {
  for (int i = 0; i < 4; ++i) quarters[std::size_t(i)].add(meanOfImage(image, i));
}

struct Both {
  Quarters direct, indirect;
};

Both byReference(const TraceScene& trace, std::uint32_t seeds, std::uint32_t spp) {
  Both both;
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    ReferenceSettings settings;
    settings.width = settings.height = kSide;
    settings.spp = spp;
    settings.aa = 1;
    settings.seed = 100 + seed;
    Stats stats;
    const Film film = renderReference(trace.scene(), trace.scene().cameras.front(), settings, stats);
    add(both.direct, film.layers.at("direct"));
    add(both.indirect, film.layers.at("indirect"));
  }
  return both;
}

Both byPhotons(const TraceScene& trace, std::uint32_t seeds, float radius) {
  Both both;
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    RenderSettings settings;
    settings.frame.width = settings.frame.height = kSide;
    settings.frame.seed = seed;
    settings.photonTrace.photons = 400'000;
    settings.direct.areaSamples = 64;
    settings.photonVolumes.radiusMin = settings.photonVolumes.radiusMax = 1;
    settings.photonVolumes.flatness = 0.4f;
    Stats stats;
    Image indirect(kSide, kSide);
    // Extrapolated to radius 0, as the means at r and r / 2 say.
    for (const float part : {1.0f, 0.5f}) {
      settings.photonVolumes.radius = radius * part;
      const Film film = renderCpu(trace, trace.scene().cameras.front(), settings, stats);
      const Image& layer = film.layers.at("indirect");
      for (std::size_t i = 0; i < indirect.pixels.size(); ++i)
        indirect.pixels[i] += layer.pixels[i] * (part == 1.0f ? -1.0f : 2.0f);
      if (part == 1.0f) add(both.direct, film.layers.at("direct"));
    }
    add(both.indirect, indirect);
  }
  return both;
}

void expectAgreement(Scene scene) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise, for which the sanitizers are too slow";
  finishScene(scene, "courtyard");
  const TraceScene trace(scene);
  const Both reference = byReference(trace, 12, 32), photons = byPhotons(trace, 16, 0.12f);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string figures = fmt::format(
        "quarter {}: direct {:.5f} +- {:.5f} of {:.5f} +- {:.5f}, indirect {:.5f} +- {:.5f} of {:.5f} +- "
        "{:.5f}",
        i, photons.direct[i].mean(), photons.direct[i].error(), reference.direct[i].mean(),
        reference.direct[i].error(), photons.indirect[i].mean(), photons.indirect[i].error(),
        reference.indirect[i].mean(), reference.indirect[i].error());
    std::printf("%s\n", figures.c_str());
    EXPECT_TRUE(sameMean(photons.direct[i], reference.direct[i], 8, 1e-3)) << figures;
    EXPECT_LT(reference.direct[i].error(), 0.01 * reference.direct[i].mean())
        << "too noisy to tell: " << figures;
    // What the extrapolation leaves of the bias is below 1 %.
    EXPECT_TRUE(sameMean(photons.indirect[i], reference.indirect[i], 8, 1e-2)) << figures;
    EXPECT_LT(reference.indirect[i].error(), 0.02 * reference.indirect[i].mean())
        << "too noisy to tell: " << figures;
  }
}

TEST(EnvironmentAgreement, SkyMap) {
  Scene scene = courtyard();
  addMap(scene, false);
  expectAgreement(std::move(scene));
}

TEST(EnvironmentAgreement, SkyMapWithASunInIt) {
  Scene scene = courtyard();
  addMap(scene, true);
  expectAgreement(std::move(scene));
}

TEST(EnvironmentAgreement, ConstantSkyAndSun) {
  Scene scene = courtyard();
  addConstantSkyAndSun(scene);
  expectAgreement(std::move(scene));
}

/// A body without hollows under a sky of radiance 1 from everywhere: what it sends to the eye is its albedo,
/// the background is 1, and photons are absorbed in proportion.
TEST(EnvironmentAgreement, FurnaceUnderAMap) {
  Scene scene;
  scene.materials.push_back(matt("body", vec3(0.5f)));
  Mesh mesh;
  addBox(mesh, {-1, -1, -1}, {1, 1, 1});
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"body", 0});
  Camera camera;
  camera.eye = {1.5f, 2.0f, 4.0f};
  camera.target = {0, 0, 0};
  camera.verticalFovDegrees = 30;
  scene.cameras.push_back(camera);
  scene.environment.radiance = Image(128, 64, vec3(1.0f));
  Light light{};
  light.type = kLightEnvironment;
  light.mapped = 1u;
  light.colour = vec3(1.0f);
  light.edgeU = vec3(1, 0, 0);
  light.edgeV = vec3(0, 1, 0);
  scene.lights.push_back(light);
  finishScene(scene, "furnace");
  const TraceScene trace(scene);
  Stats stats;
  RenderSettings settings;
  settings.frame.width = settings.frame.height = kSide;
  settings.direct.areaSamples = 256;
  const Film film = renderCpu(trace, scene.cameras.front(), settings, stats);
  double direct = 0;
  int lit = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const bool body = film.layers.at("depth").at(x, y).x > 0.0f;
      EXPECT_NEAR(film.layers.at("emitted").at(x, y).y, body ? 0.0f : 1.0f, 1e-5f);
      if (!body) continue;
      // 256 samples of at most 2 albedo each.
      EXPECT_NEAR(film.layers.at("direct").at(x, y).y, 0.5f, 5.0f * 0.5f / 16.0f);
      direct += double(film.layers.at("direct").at(x, y).y);
      ++lit;
    }
  ASSERT_GT(lit, 100);
  EXPECT_NEAR(direct / lit, 0.5, 5 * 0.5 / std::sqrt(256.0 * lit));

  PhotonTrace photonTrace({.photons = 100'000});
  PhotonMap map;
  photonTrace.run({.trace = trace}, map, stats);
  EXPECT_NEAR(map.powerEmitted / (M_PI * 24), 1.0, 1e-3);
  EXPECT_NEAR(map.powerAbsorbed / map.powerEmitted, 0.5, 5 * 0.5 / std::sqrt(100'000.0));
  EXPECT_NEAR((map.powerAbsorbed + map.powerEscaped + map.powerEnded) / map.powerEmitted, 1.0, 1e-2);
  EXPECT_EQ(map.hitsPerBounce[0], 100'000u) << "the body fills the scene's bounds: no photon misses it";
}

}  // namespace
}  // namespace isophote

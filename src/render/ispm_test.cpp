// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Frames of --preset ispm: what must not happen in them.
#include "base/error.h"
#include "image/compare.h"
#include "render/cpu_frame.h"
#include "render/settings.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

namespace isophote {
namespace {

RenderSettings ispm(std::uint32_t width, std::uint32_t height) {
  RenderSettings settings = presetSettings("ispm");
  settings.frame.subsample = 1;  // Every pixel: what upsampling adds is tested by itself.
  settings.frame.width = width;
  settings.frame.height = height;
  settings.photonTrace.photons = 50'000;
  settings.direct.shadowResolution = 256;
  return settings;
}

Film render(const Scene& scene, const RenderSettings& settings, Stats& stats) {
  return renderCpu(scene, scene.cameras.front(), settings, stats);
}

/// Where the ray through a pixel's centre meets the surface, by the layer "depth".
vec3 positionAt(const Camera& camera, const Film& film, int x, int y) {
  const CameraRays rays = cameraRays(camera, film.colour.width, film.colour.height);
  const vec2 p = imagePlaneFromPixel(vec2(float(x) + 0.5f, float(y) + 0.5f),
                                     vec2(float(film.colour.width), float(film.colour.height)));
  const std::size_t pixel = std::size_t(y) * std::size_t(film.colour.width) + std::size_t(x);
  return cameraRayOrigin(rays, p) + cameraRayDirection(rays, p) * film.layers.at("depth").pixels[pixel].x;
}

/// Whatever light the dark room of two-rooms shows farther from the wall than any photon's kernel reaches
/// has leaked through. The lit room is bright.
void expectNoLeak(const RenderSettings& settings) {
  const Scene scene = loadScene("two-rooms");
  Stats stats;
  const Film film = render(scene, settings, stats);
  const float reach = float(stats.counter("radiusMetres")) * settings.photonVolumes.radiusMax;
  ASSERT_LT(reach, 1.0f);
  double lit = 0;
  int litCount = 0, darkCount = 0;
  float worst = 0;
  for (int y = 0; y < film.colour.height; ++y)
    for (int x = 0; x < film.colour.width; ++x) {
      const std::size_t pixel = std::size_t(y) * std::size_t(film.colour.width) + std::size_t(x);
      if (!(film.layers.at("depth").pixels[pixel].x > 0.0f)) continue;
      const vec3 at = positionAt(scene.cameras.front(), film, x, y);
      const vec3 indirect = film.layers.at("indirect").pixels[pixel];
      const vec3 direct = film.layers.at("direct").pixels[pixel];
      if (at.x < -0.02f) {
        lit += double(indirect.x);
        ++litCount;
      } else if (at.x > 0.012f + reach) {
        worst = std::max({worst, maxOf(indirect), maxOf(direct)});
        ++darkCount;
      }
    }
  EXPECT_GT(litCount, 500);
  EXPECT_GT(darkCount, 500);
  EXPECT_GT(lit / litCount, 0.05);
  EXPECT_EQ(worst, 0.0f) << "kernels reach " << reach << " m";
}

TEST(IspmFrame, NothingLeaksThroughAWall) {
  RenderSettings settings = ispm(160, 90);
  settings.photonVolumes.radius = 0.25f;
  expectNoLeak(settings);
  settings.frame.firstBounce = FirstBounce::kTraced;
  expectNoLeak(settings);
}

/// The far face of the wall itself, two centimetres from photons on the lit one, stays dark up to its edges:
/// they arrive on its other side.
TEST(IspmFrame, ThinWallsAreDarkBehind) {
  Scene scene = loadScene("two-rooms");
  scene.cameras.front().eye = {1.6f, 1, 0};
  scene.cameras.front().target = {0, 1, 0};
  scene.cameras.front().verticalFovDegrees = 30;
  RenderSettings settings = ispm(80, 60);
  settings.photonVolumes.radius = 0.15f;
  Stats stats;
  const Film film = render(scene, settings, stats);
  for (const vec3 indirect : film.layers.at("indirect").pixels) EXPECT_EQ(maxOf(indirect), 0.0f);
}

/// The same spot of a wall from afar and from two millimetres away, which is within every kernel: volumes are
/// not cut by a near plane.
TEST(IspmFrame, SurfacesDoNotDarkenAsTheCameraComesClose) {
  Scene scene = loadScene("two-rooms");
  const vec3 spot(-1.2f, 0.9f, -1);
  RenderSettings settings = ispm(32, 32);
  settings.photonVolumes.radius = 0.25f;
  double fromAfar = 0;
  for (const float distance : {1.5f, 0.1f, 0.002f}) {
    Camera& camera = scene.cameras.front();
    camera.eye = spot + vec3(0, 0, distance);
    camera.target = spot;
    // The same square of 2 mm.
    camera.verticalFovDegrees = 2.0f * std::atan(0.001f / distance) * 180.0f / kPi;
    Stats stats;
    const Film film = render(scene, settings, stats);
    double sum = 0;
    for (const vec3 indirect : film.layers.at("indirect").pixels) sum += double(indirect.x);
    if (fromAfar == 0) fromAfar = sum;
    EXPECT_GT(sum, 0);
    EXPECT_NEAR(sum / fromAfar, 1.0, 1e-3) << distance << " m";
  }
}

TEST(IspmFrame, SameAtAnyNumberOfThreads) {
  const Scene scene = loadScene("two-rooms");
  Stats stats;
  const Film all = render(scene, ispm(96, 54), stats);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Film alone = render(scene, ispm(96, 54), stats);
  EXPECT_EQ(all.colour.pixels, alone.colour.pixels);
}

/// Photons of a lamp with an area and of a point go into one map, and the statistics tell them apart.
TEST(IspmFrame, MapsAndTracingMixFreely) {
  Scene scene = loadScene("cornell-box");
  Light light{};
  light.type = kLightPoint;
  light.position = {0, 1, 0.5f};
  light.colour = vec3(1);
  scene.lights.push_back(light);
  finishScene(scene, "cornell-box with a point light");
  Stats stats;
  render(scene, ispm(32, 32), stats);
  const double byMap = stats.counter("bounce_map.photonsEmitted");
  double mapPower = 0, power = 0;
  for (const Light& l : scene.lights) {
    power += double(l.power);
    if (l.type == kLightPoint) mapPower += double(l.power);
  }
  EXPECT_NEAR(byMap / stats.counter("photonsEmitted"), mapPower / power, 0.05);
  EXPECT_GE(stats.counter("photonsEmitted"), 50'000);
  EXPECT_LT(stats.counter("photonsEmitted"), 51'500);
}

TEST(IspmFrame, BounceMapsRefuseANumberOfStoredPhotons) {
  RenderSettings settings = ispm(32, 32);
  settings.photonTrace.photonsStored = 1000;
  Stats stats;
  EXPECT_THROW(render(loadScene("two-rooms"), settings, stats), Error);
}

// ---------------------------------------------------------------- culling

/// A lamp behind the wall, beyond the distance, lights nothing that the eye sees.
TEST(IspmFrame, LightsThatAreLeftOutEmitNothing) {
  Scene scene = loadScene("two-rooms");
  Light second = scene.lights.front();
  second.position.x = 1;
  scene.lights.push_back(second);
  finishScene(scene, "two lit rooms");
  scene.cameras.front().eye = {1, 1, 0.5f};
  scene.cameras.front().target = {1, 1, -1};
  RenderSettings settings = ispm(48, 48);
  settings.photonVolumes.radius = 0.2f;
  Stats all, culled;
  const Film before = render(scene, settings, all);
  settings.cull.distance = 2.05f;
  const Film after = render(scene, settings, culled);
  EXPECT_EQ(culled.counter("cull.lightsLeftOut"), 1);
  EXPECT_NEAR(culled.counter("cull.lightPowerLeftOut"), double(scene.lights[0].power), 1e-3);
  EXPECT_NEAR(culled.counter("photonsEmitted"), 0.5 * all.counter("photonsEmitted"), 500);
  // What is near is the same, but for the random numbers of other maps.
  EXPECT_NEAR(compareImages(after.colour, before.colour).meanRatio, 1.0, 0.03);
}

}  // namespace
}  // namespace isophote

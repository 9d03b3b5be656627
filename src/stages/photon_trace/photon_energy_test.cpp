// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/shapes.h"
#include "stages/photon_trace/test_photons.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace isophote {
namespace {

// Where the power goes, and what is stored where.

TEST(PhotonTrace, AccountsForAllPower) {
  for (const char* name : {"cornell-box", "colour-bleed", "glass-sphere", "caustic-ring", "atrium"}) {
    if (!findBuiltinScene(name)) continue;
    SCOPED_TRACE(name);
    const Scene scene = builtinScene(name);
    const PhotonMap map = traced(scene);
    double lightPower = 0;
    for (const Light& light : scene.lights) lightPower += double(light.power);
    EXPECT_NEAR(map.powerEmitted, lightPower, 2e-3 * lightPower);
    // Absorbed power is booked as expected at each event, the rest by roulette: its error after n events is
    // below half a photon's power (at most the mean) times sqrt(n).
    double events = 0;
    for (std::size_t b = 0; b + 1 < map.hitsPerBounce.size(); ++b) events += double(map.hitsPerBounce[b]);
    const double sigma = 0.5 * std::sqrt(events) * map.powerEmitted / double(map.emitted);
    EXPECT_NEAR(map.powerAbsorbed + map.powerEscaped + map.powerEnded, map.powerEmitted, 4 * sigma);
    EXPECT_EQ(map.emitted, 50'000u);
    EXPECT_EQ(map.hitsPerBounce.size(), 4u);
  }
}

/// In a closed convex room of one grey with uniform irradiance, what arrives after b events is the light's
/// power times albedo^b, exactly.
TEST(PhotonTrace, FurnaceStoresPowersOfTheAlbedo) {
  for (const char* name : {"furnace", "furnace-box"}) {
    SCOPED_TRACE(name);
    const Scene scene = builtinScene(name);
    constexpr std::uint32_t kPaths = 100'000;
    const PhotonMap map = traced(scene, {.photons = kPaths, .bounces = 4});
    for (std::uint32_t b = 1; b <= 4; ++b) {
      const double p = std::pow(0.5, b);
      const double sigma = std::sqrt(p * (1 - p) / kPaths);
      EXPECT_NEAR(storedPower(map, b) / double(scene.lights[0].power), p, 4 * sigma) << "bounce " << b;
      EXPECT_NEAR(double(map.hitsPerBounce[b]) / kPaths, p, 4 * sigma) << "bounce " << b;
    }
    // Roulette keeps a path's power, so that every photon here carries the same. (The sphere's emission is
    // less even: the probabilities of its 16,000 triangles are differences of floats.)
    if (std::string(name) == "furnace") continue;
    for (const Photon& photon : map.photons)
      ASSERT_NEAR(meanPower(photon), double(scene.lights[0].power) / kPaths, 2e-4 * meanPower(photon));
  }
}

TEST(PhotonTrace, EverywhereInTheFurnaceAlike) {
  const PhotonMap map = traced(builtinScene("furnace-box"), {.photons = 200'000});
  std::array<double, 6> wall{};
  for (const Photon& p : map.photons) {
    const vec3 n = unpackDirection(p.normal);
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(n[axis]) > 0.5f) wall[std::size_t(2 * axis + (n[axis] > 0))] += 1;
  }
  const double mean = double(map.photons.size()) / 6;
  // Photons of one path are not independent: allow for the 3 at most that it stores.
  for (const double count : wall) EXPECT_NEAR(count, mean, 4 * std::sqrt(3 * mean));
}

TEST(PhotonTrace, StoredNumberKeepsTheEnergy) {
  const Scene scene = builtinScene("furnace-box");
  const PhotonMap map = traced(scene, {.photonsStored = 40'000});
  EXPECT_GE(map.photons.size(), 40'000u);
  EXPECT_LE(map.photons.size(), 44'000u);
  const double sigma = std::sqrt(0.25 / double(map.emitted));
  EXPECT_NEAR(storedPower(map, 1) / double(scene.lights[0].power), 0.5, 4 * sigma);
  EXPECT_NEAR(map.powerEmitted, double(scene.lights[0].power), 2e-4 * map.powerEmitted);
}

TEST(PhotonTrace, EveryLightEmitsItsPower) {
  Light spot = pointLight({0, 3, 0}, vec3(0.0f));
  spot.type = kLightSpot;
  spot.colour = vec3(3, 2, 1);
  spot.direction = {0, -1, 0};
  spot.cosInner = 0.95f;
  spot.cosOuter = 0.8f;
  Light sphere = pointLight({1, 2, 1}, {30, 20, 10});
  sphere.radius = 0.3f;
  Light sun{};
  sun.type = kLightDirectional;
  sun.direction = normalize(vec3(0.3f, -1, 0.2f));
  sun.colour = vec3(2.0f);
  Light rectangle{};
  rectangle.type = kLightRectangle;
  rectangle.position = {-0.5f, 2, -0.5f};
  rectangle.edgeU = {1, 0, 0};
  rectangle.edgeV = {0, 0, 1};
  rectangle.direction = {0, -1, 0};
  rectangle.area = 1;
  rectangle.colour = vec3(5, 5, 1);
  Light sky{};
  sky.type = kLightEnvironment;
  sky.colour = vec3(0.4f, 0.5f, 0.9f);
  for (const Light& light : {pointLight({0, 1, 0}, vec3(10)), spot, sphere, sun, rectangle, sky}) {
    SCOPED_TRACE(light.type);
    Scene scene = floorScene(2, {light});
    finishScene(scene, "floor");
    const PhotonMap map = traced(scene);
    EXPECT_NEAR(map.powerEmitted, double(scene.lights[0].power), 3e-3 * map.powerEmitted);
  }
}

TEST(PhotonTrace, SunLightsTheFloorWithItsIrradiance) {
  Light sun{};
  sun.type = kLightDirectional;
  sun.direction = normalize(vec3(0.5f, -1, 0));
  sun.colour = vec3(2.0f);
  Scene scene = floorScene(1, {sun});
  finishScene(scene, "floor");
  constexpr std::uint32_t kPaths = 50'000;
  const PhotonMap map = traced(scene, {.photons = kPaths, .bounces = 1});
  const double received = 4 * 2 * std::abs(double(sun.direction.y));  // area, irradiance, cosine
  EXPECT_NEAR(map.powerEmitted, received, 1e-5 * received) << "the floor is all that there is";
  EXPECT_GE(map.hitsPerBounce[0] + 5, kPaths) << "none but those at its very edge may miss it";
  EXPECT_TRUE(map.photons.empty());
}

TEST(PhotonTrace, NeverStoresFirstHitsNorBeyondTheLimit) {
  const PhotonMap map = traced(builtinScene("colour-bleed"), {.bounces = 2});
  ASSERT_FALSE(map.photons.empty());
  std::array<std::size_t, 3> count{};
  for (const Photon& p : map.photons) {
    ASSERT_GE(p.bounce, 1u);
    ASSERT_LE(p.bounce, 2u);
    ++count[p.bounce];
  }
  EXPECT_EQ(count[1], map.hitsPerBounce[1]);
  EXPECT_EQ(count[2], map.hitsPerBounce[2]);
  EXPECT_TRUE(traced(builtinScene("colour-bleed"), {.bounces = 0}).photons.empty());
}

TEST(PhotonTrace, StoresOnTheSideOfArrival) {
  for (const char* name : {"cornell-box", "colour-bleed"}) {
    const PhotonMap map = traced(builtinScene(name));
    for (const Photon& p : map.photons)
      ASSERT_GT(dot(unpackDirection(p.direction), unpackDirection(p.normal)), -1e-4f) << name;
  }
  // colour-bleed is a closed room: nothing may leave it, and nothing lies behind a wall.
  // So many rays of one point light go through Embree in its mode for coherent ones.
  const PhotonMap map = traced(builtinScene("colour-bleed"), {.photons = 200'000});
  EXPECT_EQ(map.powerEscaped, 0.0);
  for (const Photon& p : map.photons) {
    ASSERT_LE(std::max(std::abs(p.position.x), std::abs(p.position.z)), 2 + 1e-5f);
    ASSERT_LE(std::abs(p.position.y - 1.5f), 1.5f + 1e-5f);
  }
}

/// The same room with its walls' fronts outside: surfaces shade alike from both sides.
TEST(PhotonTrace, BothSidesOfSurfacesScatter) {
  Scene scene = findBuiltinScene("colour-bleed")->make();
  for (Mesh& mesh : scene.meshes) flip(mesh);
  finishScene(scene, "flipped");
  const PhotonMap flipped = traced(scene);
  const PhotonMap plain = traced(builtinScene("colour-bleed"));
  for (std::uint32_t b = 1; b <= 3; ++b) {
    const double sigma = std::sqrt(double(plain.hitsPerBounce[b]));
    EXPECT_NEAR(double(flipped.hitsPerBounce[b]), double(plain.hitsPerBounce[b]), 4 * std::sqrt(2.0) * sigma);
  }
}

/// A masked sheet whose alpha is 0 hangs between the light and the floor: the photons pass, and passing is
/// no event.
TEST(PhotonTrace, AlphaMaskLetsPhotonsThrough) {
  const auto hitsWithAlpha = [](float alpha) {
    Scene scene = floorScene(1, {pointLight({0, 1, 0}, vec3(10))});
    NamedMaterial sheet = lambert("sheet", vec3(0.0f));
    sheet.flags |= kMaterialAlphaMask;
    sheet.alpha = alpha;
    Mesh mesh;
    addQuad(mesh, {-1, 0.5f, 1}, {2, 0, 0}, {0, 0, -2});
    addObject(scene, "sheet", addMaterial(scene, sheet), std::move(mesh));
    finishScene(scene, "sheet");
    return traced(scene);
  };
  const PhotonMap open = hitsWithAlpha(0.0f), closed = hitsWithAlpha(1.0f);
  // Seen from 1 m above its middle, a square of 2 m fills a sixth of all directions, like a cube's face.
  const double p = 1.0 / 6;
  EXPECT_NEAR(double(open.hitsPerBounce[0]) / 50'000, p, 4 * std::sqrt(p * (1 - p) / 50'000));
  EXPECT_NEAR(open.powerAbsorbed, 0.5 * open.powerEmitted * p, 0.01 * open.powerEmitted);
  EXPECT_NEAR(closed.powerEscaped + closed.powerAbsorbed, closed.powerEmitted, 1e-3 * closed.powerEmitted);
  EXPECT_EQ(closed.hitsPerBounce[1], 0u);  // the sheet is black and the floor in its shadow
}

/// Power [W] that parallel light of 1 W/m^2 brings through a unit ball of glass, within `radius` of the axis
/// on a plane 1.5 m below the ball's centre.
double powerThroughBall(double radius) {
  double sum = 0;
  constexpr int kSteps = 20'000;
  for (int i = 0; i < kSteps; ++i) {
    const double height = (i + 0.5) / kSteps;  // off the axis
    const double incident = std::asin(height), refracted = std::asin(height / 1.5);
    const double exit = incident + double(kPi) - 2 * refracted;  // of the point of exit, from the top
    const double turn = 2 * (incident - refracted);              // of the direction, towards the axis
    const double arrives = std::sin(exit) - (std::cos(exit) + 1.5) * std::tan(turn);
    const double reflected = double(fresnelDielectric(float(std::cos(incident)), 1.5f));
    if (std::abs(arrives) < radius)
      sum += (1 - reflected) * (1 - reflected) * 2 * double(kPi) * height / kSteps;
  }
  return sum;
}

/// A glass ball under parallel light gathers it at 1.5 radii from its centre, as far as its spherical
/// aberration lets it. L-glass-glass-floor counts two events.
TEST(PhotonTrace, GlassBallFocuses) {
  Light sun{};
  sun.type = kLightDirectional;
  sun.direction = {0, -1, 0};
  sun.colour = vec3(1.0f);
  Scene scene = floorScene(2, {sun}, vec3(0.01f));
  NamedMaterial glass = lambert("glass", vec3(1.0f));
  glass.roughness = 0;
  glass.transmission = 1;
  glass.specular = 1;
  glass.ior = 1.5f;
  Mesh ball;
  addSphere(ball, {0, 1.5f, 0}, 1.0f, 256, 128);
  addObject(scene, "ball", addMaterial(scene, glass), std::move(ball));
  finishScene(scene, "ball");
  const PhotonMap map = traced(scene, {.photons = 100'000, .bounces = 2});
  double inFocus = 0, twoEvents = 0;
  for (const Photon& p : map.photons) {
    EXPECT_LT(std::abs(p.position.y), 1e-4f);  // clear glass stores nothing
    if (p.bounce != 2) continue;
    twoEvents += meanPower(p);
    if (length(vec2(p.position.x, p.position.z)) < 0.35f) inFocus += meanPower(p);
  }
  // Of 100,000 photons over a square of 4 m side; half a per cent for the 256 x 128 facets.
  const auto tolerance = [](double watts) { return 4 * std::sqrt(watts * 16 / 100'000) + 0.005 * watts; };
  EXPECT_NEAR(twoEvents, powerThroughBall(10), tolerance(powerThroughBall(10)));
  EXPECT_NEAR(inFocus, powerThroughBall(0.35), tolerance(powerThroughBall(0.35)));
  EXPECT_GT(inFocus, 5 * double(kPi) * 0.35 * 0.35);  // five times brighter than without the ball
  EXPECT_LT(traced(scene, {.photons = 20'000, .bounces = 1}).photons.size(), 400u);  // reflections alone
}

}  // namespace
}  // namespace isophote

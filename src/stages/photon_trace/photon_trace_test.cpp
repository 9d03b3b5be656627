// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/photon_trace.h"

#include "base/error.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/shapes.h"
#include "stages/photon_trace/path_block.h"
#include "stages/photon_trace/photon_shares.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <thread>

namespace isophote {
namespace {

Scene builtinScene(const std::string& name) {
  Scene scene = findBuiltinScene(name)->make();
  finishScene(scene, name);
  return scene;
}

struct Options {
  std::uint32_t photons = 50'000;
  std::uint32_t photonsStored = 0;
  std::uint32_t bounces = 3;
  std::uint32_t seed = 1;
  std::uint32_t pass = 0;
};

PhotonMap traced(const Scene& scene, const Options& o = {}, const Job& job = {}) {
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = o.photons, .photonsStored = o.photonsStored});
  PhotonMap map;
  Stats stats;
  stage.run({.trace = trace, .seed = o.seed, .pass = o.pass, .bounces = o.bounces}, map, stats, job);
  return map;
}

double meanPower(const Photon& p) { return double(p.power.x + p.power.y + p.power.z) / 3; }

double storedPower(const PhotonMap& map, std::uint32_t bounce) {
  double sum = 0;
  for (const Photon& p : map.photons)
    if (p.bounce == bounce) sum += meanPower(p);
  return sum;
}

Light pointLight(vec3 position, vec3 watts) {
  Light light{};
  light.type = kLightPoint;
  light.position = position;
  light.colour = watts / (4.0f * kPi);
  return light;
}

/// A floor at y = 0 and the lights given.
Scene floorScene(float halfSide, std::vector<Light> lights, vec3 albedo = vec3(0.5f)) {
  Scene scene;
  Mesh floor;
  addQuad(floor, {-halfSide, 0, halfSide}, {2 * halfSide, 0, 0}, {0, 0, -2 * halfSide});
  addObject(scene, "floor", addMaterial(scene, lambert("grey", albedo)), std::move(floor));
  scene.lights = std::move(lights);
  return scene;
}

bool sameBytes(const PhotonMap& a, const PhotonMap& b) {
  return a.photons.size() == b.photons.size() &&
         std::memcmp(a.photons.data(), b.photons.data(), a.photons.size() * sizeof(Photon)) == 0;
}

// ---------------------------------------------------------------- energy

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
  const double p = received / map.powerEmitted;
  EXPECT_NEAR(double(map.hitsPerBounce[0]) / kPaths, p, 4 * std::sqrt(p * (1 - p) / kPaths));
  EXPECT_TRUE(map.photons.empty());
}

// ---------------------------------------------------------------- what is stored where

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
  const PhotonMap map = traced(builtinScene("colour-bleed"));
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

// ---------------------------------------------------------------- determinism and sampling

TEST(PhotonTrace, SameBytesWithAnyThreads) {
  const Scene scene = builtinScene("glass-sphere");
  PhotonMap one;
  for (const int threads : {1, 2, 8}) {
    tbb::global_control allow(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    tbb::task_arena arena(threads);
    const PhotonMap map = arena.execute([&] { return traced(scene, {.photons = 20'000}); });
    if (threads == 1) one = map;
    EXPECT_TRUE(sameBytes(map, one)) << threads;
    EXPECT_EQ(map.powerAbsorbed, one.powerAbsorbed);
    EXPECT_EQ(map.hitsPerBounce, one.hitsPerBounce);
  }
}

TEST(PhotonTrace, RunsOfOneObjectDoNotDependOnEachOther) {
  const Scene scene = builtinScene("colour-bleed");
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = 10'000});
  PhotonMap first, again;
  Stats stats;
  stage.run({.trace = trace, .bounces = 1}, first, stats);
  stage.run({.trace = trace, .pass = 7, .bounces = 5}, again, stats);
  EXPECT_FALSE(sameBytes(first, again));
  stage.run({.trace = trace, .bounces = 1}, again, stats);
  EXPECT_TRUE(sameBytes(first, again));
}

TEST(PhotonTrace, SeedsAndPassesDiffer) {
  const Scene scene = builtinScene("colour-bleed");
  const PhotonMap plain = traced(scene), pass = traced(scene, {.pass = 1}), seed = traced(scene, {.seed = 2});
  EXPECT_FALSE(sameBytes(plain, pass));
  EXPECT_FALSE(sameBytes(plain, seed));
  EXPECT_FALSE(sameBytes(pass, seed));
}

/// Emission is stratified: of a block of paths, every one of 32 x 32 equal cells of directions holds one.
TEST(PhotonTrace, EmissionIsStratified) {
  Scene scene = floorScene(100, {pointLight({0, 1, 0}, vec3(10))});
  finishScene(scene, "floor");
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = kPathsPerBlock});
  PhotonMap map;
  Stats stats;
  std::vector<Ray> rays;
  stage.run({.trace = trace, .pass = 3, .bounces = 0, .rays = &rays}, map, stats);
  ASSERT_EQ(rays.size(), kPathsPerBlock);
  std::map<std::pair<int, int>, int> cells;
  for (const Ray& ray : rays) {
    const float u = 0.5f * (1.0f - ray.direction.z);
    const float turn = std::atan2(ray.direction.y, ray.direction.x) / (2 * kPi);
    ++cells[{int(u * 32.0f), int((turn < 0 ? turn + 1 : turn) * 32.0f)}];
  }
  // Numbers at the very edge of a cell may round into its neighbour.
  EXPECT_GE(cells.size(), kPathsPerBlock - 4);
}

/// Stratification lowers the error of what is stored after one and after two events below that of independent
/// paths. Measured over 32 passes on a quantity whose binomial deviation is known.
TEST(PhotonTrace, TwoEventsAreStratified) {
  const Scene scene = builtinScene("furnace-box");
  constexpr int kPasses = 32, kPaths = 4096;
  std::array<double, 3> squares{};
  for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
    const PhotonMap map = traced(scene, {.photons = kPaths, .bounces = 2, .pass = pass});
    for (std::size_t b = 1; b <= 2; ++b) {
      const double error = double(map.hitsPerBounce[b]) / kPaths - std::pow(0.5, b);
      squares[b] += error * error / kPasses;
    }
  }
  EXPECT_LT(squares[1], 0.05 * 0.25 / kPaths);
  EXPECT_LT(squares[2], 0.25 * (0.25 * 0.75) / kPaths);
}

TEST(PhotonShares, LargestRemainderAndAtLeastOne) {
  std::vector<Light> lights(4);
  lights[0].power = 60;
  lights[1].power = 0;
  lights[2].power = 39.999f;
  lights[3].power = 0.001f;
  EXPECT_EQ(photonShares(lights, 10), (std::vector<std::uint32_t>{6, 0, 3, 1}));
  EXPECT_EQ(photonShares(lights, 1'000'000), (std::vector<std::uint32_t>{600'000, 0, 399'990, 10}));
  EXPECT_EQ(photonShares(lights, 2), (std::vector<std::uint32_t>{1, 0, 1, 1}));
  for (std::uint32_t n = 3; n < 200; ++n) {
    std::uint32_t sum = 0;
    for (const std::uint32_t share : photonShares(lights, n)) sum += share;
    EXPECT_EQ(sum, n);
  }
  lights[0].power = lights[2].power = lights[3].power = 0;
  EXPECT_EQ(photonShares(lights, 100), std::vector<std::uint32_t>(4, 0));
}

// ---------------------------------------------------------------- stop, memory

TEST(PhotonTrace, StopsQuickly) {
  const Scene scene = builtinScene("colour-bleed");
  std::stop_source source;
  Job job;
  job.stop = source.get_token();
  std::chrono::steady_clock::time_point asked;
  std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    asked = std::chrono::steady_clock::now();
    source.request_stop();
  });
  try {
    traced(scene, {.photons = 100'000'000}, job);
    ADD_FAILURE() << "ran to its end";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kStopped);
  }
  // 50 ms is the contract; the rest is for a machine that is busy with other tests.
  EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::milliseconds(500));
}

TEST(PhotonTrace, RefusesToExceedTheMemoryBudget) {
  Job job;
  job.memoryBudgetBytes = 1 << 20;
  const Scene scene = builtinScene("furnace-box");
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = 100'000});
  PhotonMap map;
  Stats stats;
  try {
    stage.run({.trace = trace}, map, stats, job);
    ADD_FAILURE() << "did not notice";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_NE(std::string(e.what()).find("1 MiB"), std::string::npos) << e.what();
  }
}

TEST(PhotonTrace, ReportsProgressUpToTheEnd) {
  double last = 0;
  std::mutex mutex;
  Job job;
  job.progress = [&](std::string_view task, double fraction) {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(task, "photon_trace");
    last = std::max(last, fraction);
  };
  traced(builtinScene("colour-bleed"), {}, job);
  EXPECT_EQ(last, 1.0);
}

// ---------------------------------------------------------------- automatic radius

/// In the furnace photons lie evenly: a disc holds photonsPerEstimate where pi r^2 n / A says so.
TEST(AutomaticRadius, FindsTheDensityOfAnEvenlyLitRoom) {
  for (const std::uint32_t photons : {2'000u, 20'000u, 200'000u}) {
    const PhotonMap map = traced(builtinScene("furnace-box"), {.photons = photons});
    const double density = double(map.photons.size()) / 24;  // the cube's walls [1/m^2]
    for (const float wanted : {20.0f, 100.0f}) {
      if (wanted / density > 0.5) continue;  // a disc must be small against a wall of 4 m^2
      const double expected = std::sqrt(double(wanted) / (double(kPi) * density));
      EXPECT_NEAR(double(automaticRadius(map, wanted)) / expected, 1.0, 0.15) << photons << " " << wanted;
    }
  }
}

TEST(AutomaticRadius, ScalesWithTheUnitAndIgnoresCausticsAndStrays) {
  PhotonMap map = traced(builtinScene("furnace-box"), {.photons = 20'000});
  const float radius = automaticRadius(map, 50);
  PhotonMap scaled = map;
  for (Photon& p : scaled.photons) p.position *= 1000.0f;
  EXPECT_NEAR(automaticRadius(scaled, 50), 1000.0f * radius, 0.01f * 1000.0f * radius);
  for (std::size_t i = 0; i < map.photons.size(); i += 20) map.photons[i].position = vec3(1, 0.5f, 0.5f);
  for (std::size_t i = 1; i < map.photons.size(); i += 50) map.photons[i].position *= 1e6f;
  EXPECT_NEAR(automaticRadius(map, 50), radius, 0.25f * radius);
}

TEST(AutomaticRadius, SmallMaps) {
  PhotonMap map;
  EXPECT_EQ(automaticRadius(map, 50), 0.0f);
  Photon photon{};
  photon.normal = packDirection({0, 1, 0});
  map.photons.push_back(photon);
  EXPECT_EQ(automaticRadius(map, 50), 0.0f);
  photon.position = {3, 0, 4};
  map.photons.push_back(photon);
  // One neighbour at 5 m: 50 photons at that density.
  EXPECT_NEAR(automaticRadius(map, 50), 5.0f * std::sqrt(50.0f), 0.01f);
  // Photons on other surfaces do not count, however few lie on one.
  photon.normal = packDirection({1, 0, 0});
  for (int i = 1; i < 20; ++i) {
    photon.position = {float(i), 0, 0};
    map.photons.push_back(photon);
  }
  EXPECT_NEAR(automaticRadius(map, 50), 5.0f * std::sqrt(50.0f), 0.01f);
}

}  // namespace
}  // namespace isophote

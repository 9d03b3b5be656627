// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Footprints of traced photons against neighbours that are traced too, and against densities known on paper.
#include "physics/shading_normal.shared.h"
#include "stages/photon_trace/test_photons.h"
#include "trace/surface.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace isophote {
namespace {

struct TracedPhotons {
  PhotonMap map;
  std::vector<TracedRay> rays;
};

TracedPhotons footprintsOf(const TraceScene& trace, std::uint32_t photons, std::uint32_t bounces) {
  PhotonTrace stage({.photons = photons});
  TracedPhotons run;
  Stats stats;
  stage.run({.trace = trace, .seed = 5, .bounces = bounces, .footprints = true, .rays = &run.rays}, run.map,
            stats);
  return run;
}

double areaOf(const PhotonFootprint& f) { return double(length(cross(f.axisX, f.axisY))); }

NamedMaterial mirror() {
  NamedMaterial m{makeMaterial(), "mirror"};
  m.metallic = 1.0f;
  m.roughness = 0.0f;
  return m;
}

NamedMaterial glass(float ior) {
  NamedMaterial m{makeMaterial(), "glass"};
  m.transmission = 1.0f;
  m.roughness = 0.0f;
  m.ior = ior;
  return m;
}

TEST(Footprints, AreThereOnlyWhereAskedForAndChangeNoPhoton) {
  const Scene scene = builtinScene("glass-sphere");
  const TraceScene trace(scene);
  PhotonTrace stage({.photons = 20'000});
  PhotonMap with, without;
  Stats stats;
  stage.run({.trace = trace, .footprints = true}, with, stats);
  EXPECT_EQ(with.footprints.size(), with.photons.size());
  stage.run({.trace = trace}, without, stats);
  EXPECT_TRUE(without.footprints.empty());
  EXPECT_TRUE(sameBytes(with, without));
}

TEST(Footprints, AreTheSameWithAnyThreads) {
  const Scene scene = builtinScene("cornell-objects");
  const TraceScene trace(scene);
  std::vector<PhotonFootprint> one;
  for (const int threads : {1, 3}) {
    tbb::global_control allow(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    tbb::task_arena arena(threads);
    const TracedPhotons run = arena.execute([&] { return footprintsOf(trace, 20'000, 3); });
    for (const PhotonFootprint& f : run.map.footprints) ASSERT_TRUE(std::isfinite(areaOf(f)));
    if (threads == 1) one = run.map.footprints;
    ASSERT_EQ(run.map.footprints.size(), one.size());
    EXPECT_EQ(std::memcmp(run.map.footprints.data(), one.data(), one.size() * sizeof(one[0])), 0);
  }
}

/// By a plane mirror the light seems to stand behind it: the footprint is that of a light there.
TEST(Footprints, OfAPlaneMirrorAreThoseOfTheLightsImage) {
  constexpr std::uint32_t kPhotons = 4096;
  Scene scene;
  Mesh floor, ceiling;
  addQuad(floor, {-9, 0, 9}, {18, 0, 0}, {0, 0, -18});
  addQuad(ceiling, {-9, 3, -9}, {18, 0, 0}, {0, 0, 18});
  addObject(scene, "floor", addMaterial(scene, mirror()), floor);
  addObject(scene, "ceiling", addMaterial(scene, lambert("grey", vec3(0.5f))), ceiling);
  scene.lights.push_back(pointLight({0, 1, 0}, vec3(10)));
  finishScene(scene, "mirror");
  const TraceScene trace(scene);
  const TracedPhotons run = footprintsOf(trace, kPhotons, 1);
  int compared = 0;
  for (std::size_t i = 0; i < run.map.photons.size(); ++i) {
    if (run.map.photons[i].position.y < 2.0f) continue;
    const vec3 d = run.map.photons[i].position - vec3(0, -1, 0);
    const double r2 = double(dot(d, d)), cosine = double(d.y) / std::sqrt(r2);
    EXPECT_NEAR(areaOf(run.map.footprints[i]), 4 * double(kPi) / kPhotons * r2 / cosine,
                2e-3 * r2 / kPhotons);
    EXPECT_EQ(run.map.footprints[i].scattered, 0u);
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

/// IGPM 4.2 and 4.3: behind a diffuse surface, with albedo p, lies the virtual origin from where the area
/// fits.
TEST(Footprints, OfADiffuseSurfaceStartFromTheVirtualOrigin) {
  constexpr std::uint32_t kPhotons = 4096;
  constexpr double kAlbedo = 0.5;
  const vec3 light(0.2f, 1.0f, -0.1f);
  Scene scene;
  Mesh room;
  addRoom(room, vec3(-1, 0, -1), vec3(1, 2, 1));
  addObject(scene, "room", addMaterial(scene, lambert("grey", vec3(float(kAlbedo)))), room);
  scene.lights.push_back(pointLight(light, vec3(10)));
  finishScene(scene, "room");
  const TraceScene trace(scene);
  const TracedPhotons run = footprintsOf(trace, kPhotons, 1);
  const double spacing2 = 4 * double(kPi) / kPhotons;
  int compared = 0;
  for (std::size_t i = 0; i < run.map.photons.size(); ++i) {
    const Photon& p = run.map.photons[i];
    const vec3 back = unpackDirection(p.direction), normal = unpackDirection(p.normal);
    const Ray ray = rayFrom(p.position, normal, back);
    const Hit hit = trace.closestHit(ray);
    ASSERT_TRUE(hit.valid());
    const Surface s = surfaceAt(trace, ray, hit);
    const vec3 d = s.position - light;
    const double cosFirst = double(std::abs(dot(normalize(d), s.ng)));
    const double firstArea = spacing2 * double(dot(d, d)) / cosFirst / kAlbedo;
    const double way = double(hit.t) + std::sqrt(firstArea / spacing2);
    const double cosine = double(dot(back, normal));
    if (cosFirst < 0.05 || cosine < 0.05) continue;
    const double expected = spacing2 * way * way / cosine;
    EXPECT_NEAR(areaOf(run.map.footprints[i]), expected, 0.01 * expected);
    EXPECT_EQ(run.map.footprints[i].scattered, 1u);
    EXPECT_NEAR(run.map.footprints[i].spacing, float(std::sqrt(spacing2)), 1e-6f);
    ++compared;
  }
  EXPECT_GT(compared, 1500);
}

/// A path through mirrors and clear glass, walked again from another direction by the same choices.
struct Walk {
  vec3 position;
  double kept = 1;  ///< Part of the light that took it.
};
std::optional<Walk> walk(const TraceScene& trace, vec3 origin, vec3 direction,
                         const std::vector<bool>& refracts) {
  Walk w;
  Ray ray{origin, 0.0f, direction, 1e30f};
  for (std::size_t event = 0;; ++event) {
    const Hit hit = trace.closestHit(ray);
    if (!hit.valid()) return std::nullopt;
    const Surface s = surfaceAt(trace, ray, hit);
    w.position = s.position;
    if (event == refracts.size()) return w;
    const vec3 wo = -ray.direction;
    const float cosO = abs(dot(wo, s.ns));
    float etaScale;
    vec3 next = mirrorDirection(wo, s.ng, s.ns);
    if (refracts[event]) next = refractionOf(s.bsdf, wo, s.ng, s.ns, s.entering, etaScale);
    w.kept *= double(meanOf(refracts[event] ? refractedPart(s.bsdf, cosO, s.entering)
                                            : mirrorReflectance(s.bsdf, cosO, s.entering)));
    // What differs between normals is part of the power, as the photons' own shading factor.
    w.kept *= double(photonShadingFactor(wo, next, s.ng, s.ns));
    ray = rayFrom(s.position, s.ng, next);
  }
}

/// Each photon that came by specular surfaces alone against neighbours a small step aside: the middle of the
/// deviations, relative to the axes.
void expectNeighbours(Scene scene, const char* name, std::uint32_t bounces) {
  constexpr std::uint32_t kPhotons = 20'000;
  const vec3 light(0.3f, 1.7f, 0.2f);
  Mesh room;
  addRoom(room, vec3(-3), vec3(3));
  addObject(scene, "room", addMaterial(scene, lambert("grey", vec3(0.5f))), room);
  scene.lights.push_back(pointLight(light, vec3(10)));
  finishScene(scene, name);
  const TraceScene trace(scene);
  const TracedPhotons run = footprintsOf(trace, kPhotons, bounces);
  std::map<std::uint32_t, std::vector<Ray>> paths;
  for (const TracedRay& r : run.rays) paths[r.path].push_back(r.ray);
  std::vector<std::size_t> specular;
  for (std::size_t i = 0; i < run.map.photons.size(); ++i)
    if (run.map.photons[i].bounce == bounces && run.map.footprints[i].scattered == 0u) specular.push_back(i);
  std::vector<double> deviations;
  for (const auto& [path, rays] : paths) {
    if (rays.size() != bounces + 1 || deviations.size() == 300) continue;
    // Which of the photons is its end? None where a diffuse surface lay on the way.
    if (specular.empty()) break;
    const Hit hit = trace.closestHit(rays.back());
    if (!hit.valid()) continue;
    const vec3 end = surfaceAt(trace, rays.back(), hit).position;
    const auto found = std::ranges::find_if(specular, [&](std::size_t i) {
      return length(run.map.photons[i].position - end) < 1e-4f * (1.0f + length(end));
    });
    if (found == specular.end()) continue;
    const PhotonFootprint& f = run.map.footprints[*found];
    std::vector<bool> refracts;
    for (std::size_t k = 0; k + 1 < rays.size(); ++k) {
      const Hit at = trace.closestHit(rays[k]);
      const Surface s = surfaceAt(trace, rays[k], at);
      refracts.push_back(dot(rays[k + 1].direction, s.ng) < 0.0f);
    }
    const vec3 d = rays.front().direction;
    const std::optional<Walk> middle = walk(trace, light, d, refracts);
    if (!middle || length(middle->position - end) > 1e-3f) continue;
    const float spacing = photonSpacing(4.0f * kPi, float(kPhotons));
    double worst = 0;
    for (const int axis : {0, 1}) {
      constexpr float kTurn = 1e-3f;
      const vec3 step = basisAround(d)[axis];
      const std::optional<Walk> a = walk(trace, light, normalize(d + step * kTurn), refracts);
      const std::optional<Walk> b = walk(trace, light, normalize(d - step * kTurn), refracts);
      if (!a || !b) continue;
      const vec3 expected =
          (a->position - b->position) * (spacing / (2.0f * kTurn) / float(std::sqrt(middle->kept)));
      const vec3 got = axis == 0 ? f.axisX : f.axisY;
      worst = std::max(worst, double(length(got - expected) / length(expected)));
    }
    deviations.push_back(worst);
  }
  ASSERT_GT(deviations.size(), 30u) << name;
  std::ranges::sort(deviations);
  std::printf("%s: %zu photons, middle deviation %.4f, of nine tenths %.4f\n", name, deviations.size(),
              deviations[deviations.size() / 2], deviations[deviations.size() * 9 / 10]);
  // Neighbours on another triangle and curvature within a step make some differ.
  EXPECT_LT(deviations[deviations.size() / 2], 0.02);
  EXPECT_LT(deviations[deviations.size() * 8 / 10], 0.15);
}

Scene sphereOf(const NamedMaterial& material) {
  Scene scene;
  Mesh sphere;
  addSphere(sphere, vec3(0), 0.8f, 48, 24);
  addObject(scene, "sphere", addMaterial(scene, material), sphere);
  return scene;
}

TEST(Footprints, OfACurvedMirrorAreThoseOfTracedNeighbours) {
  expectNeighbours(sphereOf(mirror()), "mirror sphere", 1);
}
TEST(Footprints, ThroughGlassAreThoseOfTracedNeighbours) {
  expectNeighbours(sphereOf(glass(1.5f)), "glass sphere", 2);
}
TEST(Footprints, AfterReflectionInGlassAreThoseOfTracedNeighbours) {
  expectNeighbours(sphereOf(glass(1.5f)), "inside of a glass sphere", 3);
}

/// Mean over the photons near the middle of a floor, which light reaches through a pane that does nothing, of
/// the footprint's area times the density of photons there.
double meanCover(const Light& light, std::uint32_t photons, float halfSide) {
  Scene scene;
  Mesh floor, pane;
  addQuad(floor, {-9, 0, 9}, {18, 0, 0}, {0, 0, -18});
  addQuad(pane, {-9, 0.01f, 9}, {18, 0, 0}, {0, 0, -18});
  NamedMaterial clear = glass(1.0f);
  clear.flags = kMaterialThinWalled;
  clear.specular = 0.0f;
  addObject(scene, "floor", addMaterial(scene, lambert("grey", vec3(0.5f))), floor);
  addObject(scene, "pane", addMaterial(scene, clear), pane);
  scene.lights.push_back(light);
  finishScene(scene, "pane");
  const TraceScene trace(scene);
  const TracedPhotons run = footprintsOf(trace, photons, 1);
  double area = 0;
  int count = 0;
  for (std::size_t i = 0; i < run.map.photons.size(); ++i) {
    const vec3 p = run.map.photons[i].position;
    if (p.y > 0.005f || std::abs(p.x) > halfSide || std::abs(p.z) > halfSide) continue;
    area += areaOf(run.map.footprints[i]);
    ++count;
  }
  EXPECT_GT(count, 200);
  return area / double(4.0f * halfSide * halfSide);
}

/// The footprints' parallelograms of lights without extent cover the floor once; those of lights with an area
/// do so close to it.
TEST(Footprints, OfEveryLightFollowTheDensityOfItsPhotons) {
  const float half = 0.2f;
  EXPECT_NEAR(meanCover(pointLight({0, 1, 0}, vec3(1)), 200'000, half), 1.0, 0.05) << "point";
  Light spot{};
  spot.type = kLightSpot;
  spot.position = vec3(0, 1, 0);
  spot.direction = vec3(0, -1, 0);
  spot.colour = vec3(1);
  spot.cosOuter = 0.8f;
  spot.cosInner = 0.9f;
  EXPECT_NEAR(meanCover(spot, 20'000, half), 1.0, 0.05) << "spot";
  Light sun{};
  sun.type = kLightDirectional;
  sun.direction = normalize(vec3(0.3f, -1, 0));
  sun.colour = vec3(1);
  EXPECT_NEAR(meanCover(sun, 1'000'000, half), 1.0, 0.05) << "sun";
  Light rectangle{};
  rectangle.type = kLightRectangle;
  rectangle.position = vec3(-5, 0.011f, -5);
  rectangle.edgeU = vec3(10, 0, 0);
  rectangle.edgeV = vec3(0, 0, 10);
  rectangle.colour = vec3(1);
  EXPECT_NEAR(meanCover(rectangle, 400'000, half), 1.0, 0.15) << "rectangle";
  Light sky{};
  sky.type = kLightEnvironment;
  sky.colour = vec3(1);
  const double cover = meanCover(sky, 200'000, 3.0f);
  EXPECT_GT(cover, 0.3) << "sky";
  EXPECT_LT(cover, 30.0) << "sky";
}

/// Footprints are those of the number of paths emitted in the end, also where a number of stored photons is
/// asked for.
TEST(Footprints, FollowThePathsEmittedInTheEnd) {
  const Scene scene = builtinScene("colour-bleed");
  const TraceScene trace(scene);
  PhotonTrace stage({.photonsStored = 20'000});
  PhotonMap map;
  Stats stats;
  stage.run({.trace = trace, .footprints = true}, map, stats);
  ASSERT_EQ(scene.lights.size(), 1u);
  for (const PhotonFootprint& f : map.footprints)
    ASSERT_NEAR(f.spacing, photonSpacing(4.0f * kPi, float(map.emitted)), 1e-4f * f.spacing);
  PhotonTrace same({.photons = std::uint32_t(map.emitted)});
  PhotonMap whole;
  same.run({.trace = trace, .footprints = true}, whole, stats);
  const auto middleArea = [](const PhotonMap& m) {
    std::vector<double> areas;
    for (const PhotonFootprint& f : m.footprints) areas.push_back(areaOf(f));
    std::ranges::nth_element(areas, areas.begin() + std::ssize(areas) / 2);
    return areas[areas.size() / 2];
  };
  EXPECT_NEAR(middleArea(map) / middleArea(whole), 1.0, 0.05);
}

}  // namespace
}  // namespace isophote

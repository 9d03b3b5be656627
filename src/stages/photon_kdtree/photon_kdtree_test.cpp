// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_kdtree/photon_kdtree.h"

#include "base/error.h"
#include "math/rng.shared.h"
#include "stages/photon_kdtree/kdtree.h"
#include "stages/photon_kdtree/nearest_search.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stop_token>

namespace isophote {
namespace {

std::vector<vec3> randomPoints(std::uint32_t count) {
  std::vector<vec3> points(count);
  for (std::uint32_t i = 0; i < count; ++i) points[i] = random3(7, i, 0) * vec3(4, 1, 2);
  // Coincident points and points with equal coordinates must not upset the split.
  for (std::uint32_t i = 0; i < count / 10; ++i) points[i] = points[count / 2];
  for (std::uint32_t i = count / 10; i < count / 5; ++i) points[i].x = 1.0f;
  return points;
}

/// Squared distance and index of all points that are closer, ascending.
std::vector<std::pair<float, std::uint32_t>> closerThan(const std::vector<vec3>& points, vec3 centre,
                                                        float distance2) {
  std::vector<std::pair<float, std::uint32_t>> closer;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const vec3 d = points[i] - centre;
    if (dot(d, d) < distance2) closer.emplace_back(dot(d, d), i);
  }
  std::sort(closer.begin(), closer.end());
  return closer;
}

TEST(PhotonKdtree, TreeFindsWhatASearchOfAllPointsFinds) {
  for (const SimdLevel simd : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (simd > bestSimdLevel()) continue;
    for (std::uint32_t count : {0u, 1u, 32u, 33u, 100u, 5000u}) {
      const std::vector<vec3> points = randomPoints(count);
      Kdtree tree;
      tree.build(points);
      NearestSearch search(tree, simd);
      for (std::uint32_t q = 0; q < 50; ++q) {
        const vec3 centre = random3(8, q, 0) * vec3(4, 1, 2);
        std::vector<std::pair<float, std::uint32_t>> found;
        for (const NeighbourKey key : search.within(centre, 0.05f))
          found.emplace_back(distance2Of(key), tree.pointAt(placeOf(key)));
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, closerThan(points, centre, 0.05f));
      }
    }
  }
}

TEST(PhotonKdtree, BuildStopsWhenAskedToAndCanBeDoneAgain) {
  const std::vector<vec3> points = randomPoints(40'000);
  std::stop_source stop;
  Job job;
  job.stop = stop.get_token();
  stop.request_stop();
  Kdtree tree, other;
  try {
    tree.build(points, job);
    ADD_FAILURE() << "was not stopped";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kStopped);
  }
  tree.build(points);
  other.build(points);
  for (std::uint32_t at = 0; at < tree.size(); ++at) ASSERT_EQ(tree.pointAt(at), other.pointAt(at));
}

// The answers must not depend on the query before, and coincident points must not keep a search from ending.
TEST(PhotonKdtree, FindsTheNearestPointsThatAreKept) {
  const std::vector<vec3> points = randomPoints(5000);
  Kdtree tree;
  tree.build(points);
  NearestSearch search(tree);
  for (const std::size_t wanted : {1u, 5u, 101u, 3000u, 6000u})
    for (const float largest2 : {1e-4f, 0.05f, 100.0f})
      for (std::uint32_t q = 0; q < 40; ++q) {
        const vec3 centre =
            q % 5 == 0 ? points[2500] : random3(8, q / 8, 0) * vec3(4, 1, 2) + 0.01f * float(q % 8);
        const auto kept = [&](std::uint32_t i) { return (i + q) % 3 != 0; };
        std::vector<std::pair<float, std::uint32_t>> expected = closerThan(points, centre, largest2);
        std::erase_if(expected, [&](const auto& point) { return !kept(point.second); });
        const auto found = search.nearest(centre, wanted, largest2,
                                          [&](std::uint32_t at) { return kept(tree.pointAt(at)); });
        ASSERT_EQ(found.size(), std::min(wanted, expected.size()));
        if (found.size() == wanted) {
          EXPECT_EQ(distance2Of(found.back()), expected[wanted - 1].first);
        }
        std::vector<float> got, want;
        for (const NeighbourKey key : found) got.push_back(distance2Of(key));
        std::sort(got.begin(), got.end());
        for (std::size_t i = 0; i < found.size(); ++i) want.push_back(expected[i].first);
        EXPECT_EQ(got, want);
      }
}

/// `count` photons of 1 W in all, spread evenly over the square [-1, 1]^2 at height 0; directions are
/// cosine-distributed about +z, as on a surface in a closed room. Every third comes from below.
PhotonMap evenlyLitPlane(std::uint32_t count) {
  PhotonMap map;
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 u = random3(9, i, 0);
    const vec3 v = random3(9, i, 1);
    vec3 direction = sampleCosineHemisphere(vec2(v.x, v.y));
    if (i % 3 == 0) direction.z = -direction.z;
    Photon photon{};
    photon.position = vec3(2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f, 0.0f);
    photon.power = vec3(1.0f / float(count));
    photon.direction = packDirection(direction);
    photon.normal = packDirection({0, 0, direction.z > 0 ? 1.0f : -1.0f});
    photon.bounce = 1;
    map.photons.push_back(photon);
  }
  return map;
}

ViewSamples oneTileAbovePlane() {
  ViewSamples view;
  view.width = view.height = kTileSide;
  view.tilesX = view.tilesY = 1;
  view.primaryTiles = 1;
  view.tiles.resize(1);
  clearTile(view.tiles[0]);
  for (int lane = 0; lane < kTileLanes; ++lane) {
    ViewSample s{};
    s.position = (random3(10, std::uint32_t(lane), 0) - vec3(0.5f)) * vec3(1, 1, 0);
    s.ng = s.ns = s.wo = vec3(0, 0, 1);
    s.bsdf.diffuse = vec3(0.5f);
    s.throughput = vec3(1);
    s.pixel = std::uint32_t(lane);
    setLane(view.tiles[0], lane, s);
  }
  return view;
}

double meanRadiance(const Radiance& radiance) {
  double sum = 0;
  for (float r : radiance[0].r) sum += double(r);
  return sum / kTileLanes;
}

// Two thirds of 1 W over 4 m^2 arrive from above: radiance = 0.5 / pi * (2/3) / 4, no cosine applied twice.
constexpr double kExpected = 0.5 / 3.14159265358979 * (2.0 / 3.0) / 4.0;

TEST(PhotonKdtree, EvenlyLitPlaneByNearest) {
  const PhotonMap map = evenlyLitPlane(300'000);
  Radiance radiance;
  Stats stats;
  constexpr double kNearest = 400;
  PhotonKdtree({.nearest = std::uint32_t(kNearest)}).run({oneTileAbovePlane(), map, 0.5f}, radiance, stats);
  // Each lane's estimate has a relative deviation of 1 / sqrt(nearest).
  EXPECT_NEAR(meanRadiance(radiance), kExpected, 4.0 * kExpected / std::sqrt(kNearest * kTileLanes));
}

TEST(PhotonKdtree, EvenlyLitPlaneByRadius) {
  const PhotonMap map = evenlyLitPlane(300'000);
  Radiance radiance;
  Stats stats;
  const float radius = 0.05f;
  PhotonKdtree({.nearest = 0}).run({oneTileAbovePlane(), map, radius}, radiance, stats);
  const double inDisc = 200'000 * 3.14159265 * double(radius) * double(radius) / 4.0;
  EXPECT_NEAR(meanRadiance(radiance), kExpected, 4.0 * kExpected / std::sqrt(inDisc * kTileLanes));
}

TEST(PhotonKdtree, TellsWhatItsTreeAndCopiesTake) {
  const PhotonMap map = evenlyLitPlane(5000);
  Radiance radiance;
  Stats stats;
  PhotonKdtree({}).run({oneTileAbovePlane(), map, 0.2f}, radiance, stats);
  const nlohmann::json bytes = nlohmann::json::parse(stats.toJson())["bytes"];
  const std::size_t photons = map.photons.size();
  EXPECT_EQ(bytes["photon_kdtree.photons"], photons * 2 * sizeof(vec3));
  // A position and an index for each photon, and a node for every 8 to 16 of them.
  const std::size_t tree = bytes["photon_kdtree.tree"];
  EXPECT_GT(tree, photons * (sizeof(vec3) + sizeof(std::uint32_t)));
  EXPECT_LT(tree, photons * (sizeof(vec3) + sizeof(std::uint32_t) + 2));
}

TEST(PhotonKdtree, SameBytesWithAnyNumberOfThreads) {
  const PhotonMap map = evenlyLitPlane(50'000);
  const ViewSamples view = oneTileAbovePlane();
  Radiance first;
  for (std::size_t threads : {1u, 2u, 8u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Radiance radiance;
    Stats stats;
    PhotonKdtree({}).run({view, map, 0.2f}, radiance, stats);
    if (first.empty()) first = radiance;
    EXPECT_EQ(std::memcmp(first.data(), radiance.data(), first.size() * sizeof(RadianceTile)), 0) << threads;
  }
}

}  // namespace
}  // namespace isophote

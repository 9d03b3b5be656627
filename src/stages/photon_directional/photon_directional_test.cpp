// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_directional/photon_directional.h"

#include "stages/photon_directional/octants.shared.h"
#include "support/sphere_tests.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isophote {
namespace {

using namespace sphere_tests;

/// Irradiance times reflectance, as a stage of radiance, for the tests that all estimators by spheres share.
class Lit {
 public:
  explicit Lit(PhotonDirectionalSettings settings) : stage_(settings) {}
  void run(const PhotonDirectional::In& in, Radiance& out, Stats& stats, const Job& job = {}) {
    stage_.run(in, irradiance_, out, stats, job);
    for (std::size_t i = 0; i < out.size(); ++i)
      for (int lane = 0; lane < kTileLanes; ++lane) {
        out[i].r[lane] *= irradiance_[i].r[lane];
        out[i].g[lane] *= irradiance_[i].g[lane];
        out[i].b[lane] *= irradiance_[i].b[lane];
      }
  }

 private:
  PhotonDirectional stage_;
  Radiance irradiance_;
};

Lit part() { return Lit(PhotonDirectionalSettings{}); }
Lit published() {
  PhotonDirectionalSettings settings;
  settings.weights = OctantWeights::kPublished;
  return Lit(settings);
}
Lit coarse() {
  PhotonDirectionalSettings settings;
  settings.level = 1;
  return Lit(settings);
}

TEST(PhotonDirectional, TheSameBytesWithAnyNumberOfThreads) {
  expectSameBytesWithAnyNumberOfThreads(part);
  expectSameBytesWithAnyNumberOfThreads(published);
  expectSameBytesWithAnyNumberOfThreads(coarse);
}
TEST(PhotonDirectional, EveryInstructionSetGivesTheSameBytes) {
  expectSameBytesOfEveryInstructionSet(part);
  expectSameBytesOfEveryInstructionSet(published);
}
TEST(PhotonDirectional, ASmallMemoryBudgetGivesTheSamePicture) {
  expectSamePictureWithinASmallMemoryBudget(part, "photon_directional.subPasses");
}
TEST(PhotonDirectional, ASecondRunOverwritesTheFirst) { expectASecondRunOverwritesTheFirst(part); }
TEST(PhotonDirectional, StopsAndRefusesARadiusOfZero) { expectStopsAndRefusesARadiusOfZero(part); }

/// Midpoint rule over the positive octant.
template <class F>
double overOctant(F&& f) {
  constexpr int kSteps = 300;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double z = (i + 0.5) / kSteps, turn = (j + 0.5) / kSteps * 0.5 * double(kPi);
      const double r = std::sqrt(1.0 - z * z);
      sum += f(vec3(float(r * std::cos(turn)), float(r * std::sin(turn)), float(z)));
    }
  return sum * 0.5 * double(kPi) / (kSteps * kSteps);
}

TEST(PhotonDirectional, OctantMagnitudeIsTheIntegralThatItStandsFor) {
  for (std::uint32_t i = 0; i < 60; ++i) {
    const vec3 u = random3(5, i, 0);
    const vec3 m = sampleSphere(vec2(u.x, u.y));
    const double want = overOctant([&](vec3 w) { return std::abs(double(dot(w, m))); });
    const bool oneSide = octantOf(m) == 0 || octantOf(m) == 7;
    EXPECT_NEAR(octantMagnitude(m), want, oneSide ? 2e-4 : 0.034) << m.x << " " << m.y << " " << m.z;
    EXPECT_GE(octantMagnitude(m), std::abs(octantBalance(m)) - 1e-6f) << "no octant sends less than nothing";
    double whole = 0;
    for (uint o = 0; o < uint(kOctants); ++o) whole += double(octantIrradiance(o, m));
    EXPECT_NEAR(whole, double(kPi), 4 * 0.034) << "light from everywhere";
  }
}

/// Photons that arrive by the cosine on one wall of normal n, a plane through the origin, seen by a tile of
/// eye samples around it.
struct Wall {
  ViewSamples view;
  PhotonMap map;
  double irradiance = 0;
};

Wall makeWall(vec3 n, std::uint32_t photons) {
  Wall wall;
  const mat3 basis = basisAround(n);
  ViewSamples& v = wall.view;
  v.width = v.height = 32;
  v.tilesX = v.tilesY = 4;
  v.primaryTiles = 16;
  v.camera.eye = n * 4.0f;
  v.camera.forward = -n;
  v.camera.right = basis[0] * 0.1f;
  v.camera.up = basis[1] * 0.1f;
  v.tiles.assign(16, ViewTile{});
  for (std::size_t t = 0; t < v.tiles.size(); ++t) {
    clearTile(v.tiles[t]);
    for (int lane = 0; lane < kTileLanes; ++lane) {
      const int x = int(t) % 4 * kTileSide + lane % kTileSide, y = int(t) / 4 * kTileSide + lane / kTileSide;
      ViewSample s{};
      s.position = basis * vec3((float(x) - 15.5f) * 0.02f, (float(y) - 15.5f) * 0.02f, 0.0f);
      s.ng = s.ns = s.wo = n;
      s.bsdf.diffuse = vec3(kPi);
      s.throughput = vec3(1.0f);
      s.pixel = std::uint32_t(y * v.width + x);
      setLane(v.tiles[t], lane, s);
    }
  }
  constexpr float kSide = 3.0f;
  for (std::uint32_t i = 0; i < photons; ++i) {
    const vec3 u = random3(11, i, 0), w = random3(11, i, 1);
    Photon p{};
    p.position = basis * vec3((u.x - 0.5f) * kSide, (u.y - 0.5f) * kSide, 0.0f);
    p.power = vec3(1.0f);
    p.direction = packDirection(basis * sampleCosineHemisphere(vec2(w.x, w.y)));
    p.normal = packDirection(n);
    p.bounce = 1;
    wall.map.photons.push_back(p);
  }
  wall.map.emitted = photons;
  wall.irradiance = double(photons) / double(kSide * kSide);
  return wall;
}

double meanOverIrradiance(Lit stage, const Wall& wall) {
  Radiance out;
  Stats stats;
  stage.run({wall.view, wall.map, 0.8f}, out, stats);
  double sum = 0;
  for (const RadianceTile& tile : out)
    for (const float g : tile.g) sum += double(g);
  return sum / double(out.size() * kTileLanes) / wall.irradiance;
}

// 40,000 photons on 9 square metres, 8900 of them within the radius: the mean varies by 1.1 %.
TEST(PhotonDirectional, IsExactOnAFlatWallHoweverItIsTurned) {
  for (const vec3 n : {vec3(0, 1, 0), normalize(vec3(1, 1, 0)), normalize(vec3(1, -1, 1)),
                       normalize(vec3(0.2f, 0.5f, -0.9f))}) {
    const Wall wall = makeWall(n, 40'000);
    EXPECT_NEAR(meanOverIrradiance(part(), wall), 1.0, 0.04);
    EXPECT_NEAR(meanOverIrradiance(coarse(), wall), 1.0, 0.04);
  }
}

// Twice the cosine with the octant's middle, 1 / sqrt(3) for all four of a wall that the view's axis meets.
TEST(PhotonDirectional, PublishedWeightsAreTooBrightByFifteenPercentOnAFlatWall) {
  for (const vec3 n : {vec3(0, 1, 0), normalize(vec3(1, 1, 0))}) {
    const Wall wall = makeWall(n, 40'000);
    EXPECT_NEAR(meanOverIrradiance(published(), wall), 2.0 / std::sqrt(3.0), 0.04);
  }
}

// Lambertian walls of a cube, where photons of radius 0.3 feel corners: the same light as photon by photon,
// on the mean. Each channel of a sample is an average over its cell.
TEST(PhotonDirectional, GivesTheMeanOfAnEstimatePhotonByPhoton) {
  const PhotonMap map = makePhotons(20'000);
  for (const bool bent : {false, true}) {
    const ViewSamples view = makeView(
        {.width = 160, .height = 120, .secondaryTiles = 12, .lambertian = true, .bentNormals = bent});
    const Rendered want = expected(view, map, 0.3f);
    const Rendered got = render(part(), view, map, 0.3f);
    double sum = 0, wanted = 0;
    for (std::size_t i = 0; i < view.tiles.size(); ++i)
      for (int lane = 0; lane < kTileLanes; ++lane)
        if (view.tiles[i].pixel[lane] != kNoPixel) {
          sum += double(got.radiance[i].g[lane]);
          wanted += double(want.radiance[i].g[lane]);
        }
    // Of bent normals a photon's own factor is lost, which exceeds that of its octant at grazing angles.
    EXPECT_NEAR(sum / wanted, 1.0, bent ? 0.03 : 0.01) << (bent ? "bent" : "flat");
  }
}

TEST(PhotonDirectional, NoNodesAreVisitedOverAndOver) {
  const ViewSamples view = makeView({.width = 320, .height = 240});
  const PhotonMap map = makePhotons(3000);
  const Rendered got = render(part(), view, map, 0.3f);
  const double pairs = got.stats.counter("photon_directional.pairsTested");
  EXPECT_GT(got.stats.counter("photon_directional.pairsContributing"), 0);
  EXPECT_LT(got.stats.counter("photon_directional.pairsContributing"), pairs);
  EXPECT_LT(pairs, 0.25 * 3000 * 320 * 240 / 128) << "a quarter of all pairs of a cell and a photon";
}

}  // namespace
}  // namespace isophote

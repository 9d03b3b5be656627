// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_quads/photon_quads.h"

#include "physics/shading_normal.shared.h"
#include "stages/photon_quads/quads.h"
#include "support/sphere_tests.h"

namespace isophote {
namespace {

using namespace sphere_tests;
using photon_quads::makeQuads;

constexpr float kRadius = 0.12f;
constexpr PhotonQuadsSettings kQuadsAlone{.corners = false};

Radiance lightOf(const ViewSamples& view, const PhotonMap& map, const PhotonQuadsSettings& settings,
                 float radius = kRadius) {
  return render(PhotonQuads(settings), view, map, radius).radiance;
}

/// A photon on the floor under the origin, from above.
Photon floorPhoton() {
  Photon p{};
  p.pathDensity = PhotonQuadsSettings{}.densityReference;
  p.power = vec3(1.0f);
  p.normal = p.direction = packDirection(vec3(0, 1, 0));
  return p;
}

/// One diffuse white sample.
ViewSamples viewOf(vec3 position, vec3 normal, vec3 wo, bool transmits = false) {
  ViewSamples view;
  view.width = view.height = kTileSide;
  view.tilesX = view.tilesY = 1;
  view.primaryTiles = view.directTiles = 1;
  view.camera.eye = position + 3.0f * wo;
  view.tiles.resize(1);
  clearTile(view.tiles[0]);
  ViewSample s{};
  s.position = position;
  s.ng = s.ns = normal;
  s.wo = wo;
  s.throughput = vec3(1.0f);
  s.bsdf.diffuse = vec3(1.0f);
  if (transmits) {
    s.bsdf.diffuse = vec3(0.0f);
    s.bsdf.f0 = vec3(0.04f);
    s.bsdf.transmission = vec3(1.0f);
    s.bsdf.f90 = s.bsdf.through = 1.0f;
    s.bsdf.alpha = 0.5f;
    s.bsdf.ior = 1.5f;
  }
  setLane(view.tiles[0], 0, s);
  return view;
}

float lightAt(vec3 position, vec3 normal, vec3 wo, const PhotonQuadsSettings& settings) {
  PhotonMap map;
  map.photons.push_back(floorPhoton());
  return lightOf(viewOf(position, normal, normalize(wo)), map, settings, 0.5f)[0].g[0];
}

glm::dvec3 bruteForce(const ViewTile& t, int lane, const std::vector<PhotonQuad>& quads,
                      const PhotonQuadsSettings& settings, std::uint64_t& contributing) {
  glm::dvec3 sum(0.0);
  if (t.pixel[lane] == kNoPixel) return sum;
  const vec3 position = positionOf(t, lane), ng = ngOf(t, lane), ns = nsOf(t, lane), wo = woOf(t, lane);
  Bsdf bsdf{};
  if (t.lambertian == 0) bsdf = reflectionOf(t, lane);
  bsdf.diffuse = diffuseOf(t, lane);
  const auto felt = settings.corners ? quadFeltWithCorners : quadFelt;
  for (const PhotonQuad& p : quads) {
    const float weight =
        felt(p, uint(settings.falloff), position, wo, ng) * photonEstimateFactor(p.direction, ng, ns);
    if (weight == 0.0f) continue;
    sum += glm::dvec3(evalBsdf(bsdf, p.direction, wo, ng, ns)) * glm::dvec3(p.weightedPower) * double(weight);
    ++contributing;
  }
  return sum;
}

/// Compares with every pair at every lane; returns the share of lanes that any photon reached.
double expectMatchesBruteForce(const ViewSamples& view, const PhotonMap& map,
                               const PhotonQuadsSettings& settings, float radius = kRadius) {
  const Rendered got = render(PhotonQuads(settings), view, map, radius);
  ViewSamples mirrored;  // With secondary tiles nothing is culled.
  mirrored.tiles.resize(1);
  std::vector<PhotonQuad> quads;
  makeQuads({mirrored, map, radius}, settings, quads);
  std::uint64_t contributing = 0;
  int lit = 0, wrong = 0;
  for (std::size_t i = 0; i < view.tiles.size(); ++i)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      const std::uint64_t before = contributing;
      const glm::dvec3 want = bruteForce(view.tiles[i], lane, quads, settings, contributing);
      lit += contributing > before;
      const RadianceTile& tile = got.radiance[i];
      const double tolerance = (double(contributing - before) + 16) * 0x1p-24;
      for (int c = 0; c < 3; ++c)
        wrong +=
            !(std::abs(vec3(tile.r[lane], tile.g[lane], tile.b[lane])[c] - want[c]) <= tolerance * want[c]);
    }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(got.stats.counter("photon_quads.pairsContributing"), double(contributing));
  EXPECT_GE(got.stats.counter("photon_quads.pairsTested"), double(contributing));
  return double(lit) / double(view.tiles.size() * kTileLanes);
}

TEST(PhotonQuads, MatchesEveryPair) {
  const PhotonMap map = makePhotons(1000);
  const ViewSamples view = makeView({.width = 40, .height = 30, .secondaryTiles = 20});
  for (const bool corners : {false, true})
    for (const QuadFalloff falloff :
         {QuadFalloff::kConstant, QuadFalloff::kEpanechnikov, QuadFalloff::kQuartic})
      for (const float depth : {0.1f, 1.0f, 4.0f})
        EXPECT_GT(
            expectMatchesBruteForce(view, map, {.falloff = falloff, .depth = depth, .corners = corners}),
            0.4);
  EXPECT_GT(expectMatchesBruteForce(view, map, {.corners = true, .flatness = 0.1f}), 0.4);
}

TEST(PhotonQuads, MatchesEveryPairWhereverTheEyeIs) {
  const PhotonMap map = makePhotons(600);
  const ViewOptions views[] = {
      {.width = 40, .height = 30, .eye = {0.0f, -0.999f, 0.0f}, .forward = {1, 0.1f, 0.2f}},
      {.width = 40, .height = 30, .eye = {0.9f, 0.9f, 0.9f}, .forward = {-1, -1, -1}},
      {.width = 40, .height = 30, .eye = {0, 0, 0.5f}, .orthographic = 1},
      {.width = 7, .height = 3, .lambertian = true}};
  for (const ViewOptions& options : views)
    for (const bool corners : {false, true}) {
      EXPECT_GT(expectMatchesBruteForce(makeView(options), map, {.corners = corners}), 0.1);
      EXPECT_GT(expectMatchesBruteForce(makeView(options), map, {.corners = corners}, 1.5f), 0.1);
    }
}

// Most eyes see a quad at a slant; samples far off along the line of sight are not asked.
TEST(PhotonQuads, AreAskedForWhereTheirLinesOfSightRun) {
  PhotonMap map;
  map.photons.push_back(floorPhoton());
  const vec3 wo = normalize(vec3(1, 0.2f, 0));
  const auto pairs = [&](vec3 position, bool direct) {
    ViewSamples view = viewOf(position, {0, 1, 0}, wo);
    view.camera.eye = 20.0f * wo;
    if (!direct) view.directTiles = 0;
    return render(PhotonQuads(kQuadsAlone), view, map, 0.5f).stats.counter("photon_quads.pairsTested");
  };
  const vec3 above(0.0f, 0.3f,
                   0.0f);  // Within the slab and the sphere; its line of sight passes far over it.
  EXPECT_EQ(pairs(above, true), 0);
  EXPECT_EQ(pairs(above, false), 1);  // A mirror may show it from elsewhere.
  EXPECT_EQ(pairs(0.9f * wo, true), 1);
}

TEST(PhotonQuads, TheSameBytesWithAnyNumberOfThreads) {
  expectSameBytesWithAnyNumberOfThreads([] { return PhotonQuads({}); });
  expectSameBytesWithAnyNumberOfThreads([] { return PhotonQuads(kQuadsAlone); });
}
TEST(PhotonQuads, EveryInstructionSetGivesTheSameBytes) {
  expectSameBytesOfEveryInstructionSet([] { return PhotonQuads({}); });
  expectSameBytesOfEveryInstructionSet([] { return PhotonQuads(kQuadsAlone); });
}
TEST(PhotonQuads, ASecondRunOverwritesTheFirst) {
  expectASecondRunOverwritesTheFirst([] { return PhotonQuads(kQuadsAlone); });
}
TEST(PhotonQuads, StopsAndRefusesARadiusOfZero) {
  expectStopsAndRefusesARadiusOfZero([] { return PhotonQuads({}); });
}

TEST(PhotonQuads, ASmallMemoryBudgetGivesTheSameBytes) {
  const ViewSamples view = makeView({.secondaryTiles = 70});
  const PhotonMap map = makePhotons(3000);
  Job job;
  job.memoryBudgetBytes = std::uint64_t(1) << 14;
  const Rendered parts = render(PhotonQuads({}), view, map, kRadius, bestSimdLevel(), job);
  EXPECT_TRUE(sameBytes(parts.radiance, lightOf(view, map, {})));
}

// However slanted the line of sight: the falloff lies on the plane.
TEST(PhotonQuads, TheFalloffIntegratesToOneOverThePlane) {
  for (const uint falloff : {kFalloffConstant, kFalloffEpanechnikov, kFalloffQuartic})
    for (const vec3 wo : {vec3(0, 1, 0), normalize(vec3(1, 0.05f, 0.3f))}) {
      const float radius = 0.7f;
      const PhotonQuad quad = photonQuad(floorPhoton(), falloff, radius, 1.0f, 1.0f);
      constexpr int kCells = 400;
      const double cell = 2.2 * double(radius) / kCells;
      double sum = 0;
      for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x) {
          const vec3 at((x + 0.5 - kCells / 2) * cell, 0, (y + 0.5 - kCells / 2) * cell);
          sum += double(quad.weightedPower.x * quadFelt(quad, falloff, at, wo, vec3(0, 1, 0)));
        }
      EXPECT_NEAR(sum * cell * cell, 1.0, 2e-3) << falloff;
    }
}

TEST(PhotonQuads, LieWhereTheLineOfSightMeetsTheirPlane) {
  const vec3 up(0, 1, 0);
  // 0.2 above the floor: seen from above the middle of the quad, along a slope its rim.
  const float above = lightAt({0, 0.2f, 0}, up, {0, 1, 0}, kQuadsAlone);
  EXPECT_GT(above, 0.0f);
  EXPECT_EQ(lightAt({0, 0.2f, 0}, up, {3, 1, 0}, kQuadsAlone), 0.0f);
  const float middle = lightAt({0.2f, 0.2f, 0}, up, {1, 1, 0}, kQuadsAlone);
  EXPECT_GT(middle, lightAt({0.2f, 0.2f, 0}, up, {-1, 1, 0}, kQuadsAlone));
  // Farther than the depth before or behind it.
  EXPECT_EQ(lightAt({0, -0.6f, 0}, up, {0, 1, 0}, {.depth = 1, .corners = false}), 0.0f);
  EXPECT_GT(lightAt({0, -0.6f, 0}, up, {0, 1, 0}, {.depth = 2, .corners = false}), 0.0f);
}

TEST(PhotonQuads, AreWeightedByTheNormals) {
  const vec3 wo = normalize(vec3(1, 1, 0));
  const float flat = lightAt(vec3(0.0f), {0, 1, 0}, wo, kQuadsAlone);
  EXPECT_NEAR(lightAt(vec3(0.0f), normalize(vec3(1, 2, 0)), wo, kQuadsAlone) / flat, 2 / std::sqrt(5.0f),
              1e-4);
  // The adjoining wall: volumes light it as the floor.
  PhotonMap map;
  map.photons.push_back(floorPhoton());
  map.photons[0].direction = packDirection(wo);
  const ViewSamples wall = viewOf({-0.1f, 0.2f, 0}, {1, 0, 0}, wo);
  EXPECT_EQ(lightOf(wall, map, kQuadsAlone, 0.5f)[0].g[0], 0.0f);
  PhotonVolumesSettings sphere;
  sphere.flatness = 1;
  EXPECT_FLOAT_EQ(lightOf(wall, map, {}, 0.5f)[0].g[0],
                  render(PhotonVolumes(sphere), wall, map, 0.5f).radiance[0].g[0]);
}

TEST(PhotonQuads, ThatTurnTheirBackAreCulled) {
  PhotonMap map;
  for (const float side : {1.0f, -1.0f}) {
    Photon p = floorPhoton();
    p.position.y = 0.01f * side;  // The walls of a pane.
    p.normal = p.direction = packDirection(vec3(0, side, 0));
    map.photons.push_back(p);
  }
  ViewSamples view = viewOf(vec3(0.0f), {0, 1, 0}, {0, 1, 0});
  Rendered got = render(PhotonQuads(kQuadsAlone), view, map, 0.5f);
  EXPECT_EQ(got.stats.counter("photon_quads.culled"), 1);
  EXPECT_EQ(got.stats.counter("photon_quads.pairsContributing"), 1);
  // A mirror may show it.
  view.tiles.push_back(viewOf(vec3(0.0f), {0, -1, 0}, {0, -1, 0}).tiles[0]);
  got = render(PhotonQuads(kQuadsAlone), view, map, 0.5f);
  EXPECT_EQ(got.stats.counter("photon_quads.culled"), 0);
  EXPECT_EQ(got.stats.counter("photon_quads.pairsContributing"), 2);
  EXPECT_EQ(got.radiance[0].g[0], got.radiance[1].g[0]);
}

TEST(PhotonQuads, ShineThroughFromBehind) {
  PhotonMap map;
  map.photons.push_back(floorPhoton());
  map.photons[0].normal = map.photons[0].direction = packDirection(vec3(0, -1, 0));
  for (const bool corners : {false, true}) {
    const PhotonQuadsSettings settings{.corners = corners};
    EXPECT_EQ(lightOf(viewOf(vec3(0.0f), {0, 1, 0}, {0, 1, 0}), map, settings, 0.5f)[0].g[0], 0.0f);
    EXPECT_GT(lightOf(viewOf(vec3(0.0f), {0, 1, 0}, {0, 1, 0}, true), map, settings, 0.5f)[0].g[0], 0.0f);
  }
}

}  // namespace
}  // namespace isophote

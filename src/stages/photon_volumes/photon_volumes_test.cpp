// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/photon_volumes.h"

#include "base/error.h"
#include "physics/shading_normal.shared.h"
#include "stages/photon_volumes/test_view.h"
#include "stages/photon_volumes/volumes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <set>

namespace isophote {
namespace {

using namespace photon_volumes_test;
using photon_volumes::makeVolumes;

constexpr float kRadius = 0.12f;

Radiance render(const ViewSamples& view, const PhotonMap& map, PhotonVolumesSettings settings = {},
                float radius = kRadius, SimdLevel simd = bestSimdLevel(), const Job& job = {},
                Stats* statsOut = nullptr) {
  Radiance out;
  Stats stats;
  PhotonVolumes(settings).run({view, map, radius, simd}, out, stats, job);
  if (statsOut) *statsOut = stats;
  return out;
}

bool sameBytes(const Radiance& a, const Radiance& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(RadianceTile)) == 0;
}

Bsdf bsdfOf(const ViewTile& t, int lane) {
  if (t.lambertian == 0) return reflectionOf(t, lane);
  Bsdf b{};
  b.diffuse = diffuseOf(t, lane);
  return b;
}

struct Expected {
  glm::dvec3 radiance{0.0};
  std::uint64_t contributing = 0;
};

/// Every photon against one view sample.
Expected bruteForce(const ViewTile& t, int lane, const std::vector<PhotonVolume>& volumes, Kernel kernel) {
  Expected sum;
  if (t.pixel[lane] == kNoPixel) return sum;
  const vec3 position(t.positionX[lane], t.positionY[lane], t.positionZ[lane]);
  const vec3 ng(t.ngX[lane], t.ngY[lane], t.ngZ[lane]);
  const vec3 ns(t.nsX[lane], t.nsY[lane], t.nsZ[lane]);
  const vec3 wo(t.woX[lane], t.woY[lane], t.woZ[lane]);
  for (const PhotonVolume& p : volumes) {
    const float weight = kernelValue(uint(kernel), ellipsoidDistance2(p, position)) *
                         photonEstimateFactor(p.direction, ng, ns);
    if (weight == 0.0f) continue;
    const vec3 f = evalBsdf(bsdfOf(t, lane), p.direction, wo, ng, ns);
    sum.radiance += glm::dvec3(f) * glm::dvec3(p.weightedPower) * double(weight);
    ++sum.contributing;
  }
  return sum;
}

/// Compares with the double loop at every lane; returns the share of lanes that any photon reached.
double expectMatchesBruteForce(const ViewSamples& view, const PhotonMap& map, PhotonVolumesSettings settings,
                               float radius = kRadius) {
  Stats stats;
  const Radiance out = render(view, map, settings, radius, bestSimdLevel(), {}, &stats);
  std::vector<PhotonVolume> volumes;
  makeVolumes(map, radius, settings, volumes);
  std::uint64_t contributing = 0;
  int lit = 0;
  int wrong = 0;
  for (std::size_t i = 0; i < view.tiles.size(); ++i)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      const Expected expected = bruteForce(view.tiles[i], lane, volumes, settings.kernel);
      contributing += expected.contributing;
      lit += expected.contributing > 0;
      const glm::dvec3 got(out[i].r[lane], out[i].g[lane], out[i].b[lane]);
      // Positive terms: n float additions err by n * 2^-24 at most, the terms by a few more.
      const double tolerance = (double(expected.contributing) + 16) * 0x1p-24;
      for (int c = 0; c < 3; ++c)
        if (!(std::abs(got[c] - expected.radiance[c]) <= tolerance * expected.radiance[c])) ++wrong;
    }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(stats.counter("photon_volumes.pairsContributing"), double(contributing));
  EXPECT_GE(stats.counter("photon_volumes.pairsTested"), double(contributing));
  return double(lit) / double(view.tiles.size() * kTileLanes);
}

TEST(PhotonVolumes, MatchesBruteForce) {
  const PhotonMap map = makePhotons(2000);
  for (const Kernel kernel : {Kernel::kConstant, Kernel::kEpanechnikov})
    for (const float flatness : {0.1f, 0.4f, 1.0f}) {
      PhotonVolumesSettings settings;
      settings.kernel = kernel;
      settings.flatness = flatness;
      const double lit = expectMatchesBruteForce(makeView({.secondaryTiles = 70}), map, settings);
      EXPECT_GT(lit, 0.5) << "the test must reach most lanes";
    }
}

TEST(PhotonVolumes, MatchesBruteForceWhereverTheEyeIs) {
  const PhotonMap map = makePhotons(1500);
  const ViewOptions views[] = {
      {.width = 40,
       .height = 30,
       .eye = {0.0f, -0.999f, 0.0f},
       .forward = {1, 0.1f, 0.2f}},  // inside volumes
      {.width = 40, .height = 30, .eye = {0.0f, -0.999f, 0.0f}, .forward = {0, -1, 0}},
      {.width = 40, .height = 30, .eye = {0.9f, 0.9f, 0.9f}, .forward = {-1, -1, -1}},
      {.width = 40, .height = 30, .eye = {0, 0, 0.5f}, .orthographic = 1},
      {.width = 7, .height = 3},
      {.width = 600, .height = 9}};
  for (const ViewOptions& options : views) {
    EXPECT_GT(expectMatchesBruteForce(makeView(options), map, {}), 0.1);
    EXPECT_GT(expectMatchesBruteForce(makeView(options), map, {}, 1.5f), 0.1)
        << "photons larger than the room";
  }
}

TEST(PhotonVolumes, MatchesBruteForceFarFromTheOrigin) {
  // Coordinates with few digits left: binning must not miss what the loop's own rounding lets in.
  ViewSamples view = makeView({.lambertian = true, .bentNormals = false});
  PhotonMap map = makePhotons(2000);
  const vec3 shift(1000, -3000, 500);
  for (Photon& p : map.photons) p.position += shift;
  for (ViewTile& t : view.tiles) {
    t.bounds = {};
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (t.pixel[lane] == kNoPixel) continue;
      t.positionX[lane] += shift.x, t.positionY[lane] += shift.y, t.positionZ[lane] += shift.z;
      t.bounds.extend(vec3(t.positionX[lane], t.positionY[lane], t.positionZ[lane]));
    }
  }
  PhotonVolumesSettings settings;
  settings.flatness = 0.02f;
  EXPECT_GT(expectMatchesBruteForce(view, map, settings), 0.1);
}

// Sums per lane run in photon order and every instruction set rounds alike (no contraction), so: bytes.
TEST(PhotonVolumes, EveryInstructionSetGivesTheSameBytes) {
  const ViewSamples view = makeView({.secondaryTiles = 5});
  const PhotonMap map = makePhotons(3000);
  const Radiance baseline = render(view, map, {}, kRadius, SimdLevel::kBaseline);
  for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512})
    if (level <= bestSimdLevel()) {
      EXPECT_TRUE(sameBytes(render(view, map, {}, kRadius, level), baseline)) << name(level);
    }
}

TEST(PhotonVolumes, TheSameBytesWithAnyNumberOfThreads) {
  const ViewSamples view = makeView({.width = 200, .height = 100, .secondaryTiles = 130});
  const PhotonMap map = makePhotons(20000);
  // More threads than this machine may have processors.
  const tbb::global_control threadLimit(tbb::global_control::max_allowed_parallelism, 8);
  Radiance one;
  tbb::task_arena(1).execute([&] { one = render(view, map); });
  for (const int threads : {2, 8}) {
    Radiance many;
    tbb::task_arena(threads).execute([&] { many = render(view, map); });
    EXPECT_TRUE(sameBytes(one, many)) << threads << " threads";
  }
}

TEST(PhotonVolumes, ASmallMemoryBudgetGivesTheSameBytes) {
  const ViewSamples view = makeView({.secondaryTiles = 70});
  const PhotonMap map = makePhotons(3000);
  const Radiance expected = render(view, map);
  for (const std::uint64_t budget : {std::uint64_t(1) << 16, std::uint64_t(1) << 14}) {
    Job job;
    job.memoryBudgetBytes = budget;
    EXPECT_TRUE(sameBytes(render(view, map, {}, kRadius, bestSimdLevel(), job), expected)) << budget;
  }
}

TEST(PhotonVolumes, ASecondRunOverwritesTheFirst) {
  PhotonVolumes volumes{PhotonVolumesSettings{}};
  const ViewSamples view = makeView({});
  const ViewSamples small = makeView({.width = 20, .height = 9, .seed = 5});
  const PhotonMap map = makePhotons(1000);
  Radiance out;
  Stats stats;
  volumes.run({view, map, kRadius}, out, stats);
  const Radiance first = out;
  volumes.run({small, map, kRadius}, out, stats);
  EXPECT_TRUE(sameBytes(out, render(small, map)));
  volumes.run({view, map, kRadius}, out, stats);
  EXPECT_TRUE(sameBytes(out, first));
  volumes.run({view, PhotonMap{}, 0.0f}, out, stats);
  EXPECT_TRUE(sameBytes(out, Radiance(view.tiles.size())));
}

TEST(PhotonVolumes, StopsAndRefusesARadiusOfZero) {
  const ViewSamples view = makeView({});
  const PhotonMap map = makePhotons(100);
  std::stop_source source;
  source.request_stop();
  Job job;
  job.stop = source.get_token();
  EXPECT_THROW(render(view, map, {}, kRadius, bestSimdLevel(), job), Error);
  EXPECT_THROW(render(view, map, {}, 0.0f), Error);
}

/// 64 view samples at random points of the middle of a floor at y = 0, seen from above.
ViewSamples floorView() {
  ViewSamples v;
  v.tiles.assign(1, ViewTile{});
  clearTile(v.tiles[0]);
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const vec3 u = random3(9, std::uint32_t(lane), 0);
    const WallPoint floor{vec3(u.x - 0.5f, 0, u.y - 0.5f) * 0.2f, vec3(0, 1, 0)};
    setLane(v.tiles[0], lane, makeSample(floor, vec3(0, 1, 0), true, false, vec3(1.0f)));
  }
  return v;
}

TEST(PhotonVolumes, AnEllipsoidIntegratesToOneOverTheTangentPlane) {
  for (const Kernel kernel : {Kernel::kConstant, Kernel::kEpanechnikov})
    for (const float radius : {0.01f, 1.0f, 30.0f})
      for (const float flatness : {0.01f, 0.3f, 1.0f}) {
        Photon photon{};
        photon.position = vec3(1, 2, 3);
        photon.power = vec3(1.0f);
        const vec3 normal = normalize(vec3(1, -2, 0.5f));
        photon.normal = photon.direction = packDirection(normal);
        const PhotonVolume v = photonVolume(photon, uint(kernel), radius, flatness);
        const mat3 frame = basisAround(v.normal);
        // Midpoint rule over a square of 2.2 radii; only the rim's cells are uncertain.
        constexpr int kCells = 400;
        const double cell = 2.2 * double(radius) / kCells;
        double sum = 0;
        for (int y = 0; y < kCells; ++y)
          for (int x = 0; x < kCells; ++x) {
            const vec3 at = v.position + frame[0] * float((x + 0.5 - kCells / 2) * cell) +
                            frame[1] * float((y + 0.5 - kCells / 2) * cell);
            sum += double(v.weightedPower.x * kernelValue(uint(kernel), ellipsoidDistance2(v, at)));
          }
        // Positions near (1, 2, 3) round by 2e-7, which a disc of 1 cm flattened to 0.1 mm feels.
        EXPECT_NEAR(sum * cell * cell, 1.0, 2e-3) << radius << " " << flatness;
      }
}

// Stored flux per area already holds the cosine of arrival. Multiplied in again it would give 2/3 here.
TEST(PhotonVolumes, AWallUnderCosineDistributedLightHasItsExactRadiance) {
  const ViewSamples view = floorView();
  constexpr std::uint32_t kCount = 100'000;
  constexpr float kSide = 1.0f;  // the photons' square: larger than the samples' by more than a radius
  constexpr double kIrradiance = 3;
  const float radius = 0.05f;
  PhotonMap map;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const vec3 u = random3(3, i, 0);
    const vec3 w = random3(3, i, 1);
    Photon p{};
    p.position = vec3(u.x - 0.5f, 0, u.y - 0.5f) * kSide;
    p.pathDensity = PhotonVolumesSettings{}.densityReference;
    p.power = vec3(float(kIrradiance * kSide * kSide / kCount));
    const vec3 local = sampleCosineHemisphere(vec2(w.x, w.y));
    p.direction = packDirection(vec3(local.x, local.z, local.y));
    p.normal = packDirection(vec3(0, 1, 0));
    map.photons.push_back(p);
  }
  for (const Kernel kernel : {Kernel::kConstant, Kernel::kEpanechnikov}) {
    PhotonVolumesSettings settings;
    settings.kernel = kernel;
    const Radiance out = render(view, map, settings, radius);
    // The estimate's variance is that of a kernel over Poisson-like photons: E^2 / n * mean of kernel^2,
    // where n is the number within the disc and the mean of (2 (1 - t^2))^2 over the disc is 4/3. The
    // samples' discs overlap, so the mean over 64 lanes is no better than a few independent ones: test one
    // lane.
    const double inDisc = kCount * double(kPi) * double(radius) * double(radius) / (kSide * kSide);
    const double sigma =
        kIrradiance / double(kPi) * std::sqrt((kernel == Kernel::kConstant ? 1.0 : 4.0 / 3) / inDisc);
    EXPECT_NEAR(out[0].g[0], kIrradiance / double(kPi), 4 * sigma);
    EXPECT_LT(4 * sigma, 0.2 * kIrradiance / double(kPi)) << "the test must tell 1 from 2/3";
  }
}

TEST(PhotonVolumes, PhotonsOnTheBackAddNothing) {
  const ViewSamples view = floorView();
  PhotonMap map;
  Photon p{};
  p.pathDensity = 5e-4f;
  p.power = vec3(1.0f);
  p.normal = packDirection(vec3(0, -1, 0));
  p.direction = packDirection(normalize(vec3(0.3f, -1, 0.2f)));
  map.photons.push_back(p);
  EXPECT_EQ(render(view, map, {}, 10.0f)[0].r[5], 0.0f);
  map.photons[0].direction = packDirection(normalize(vec3(0.3f, 1, 0.2f)));
  EXPECT_GT(render(view, map, {}, 10.0f)[0].r[5], 0.0f);
}

TEST(PhotonVolumes, ThePathDensityShapesTheRadius) {
  PhotonMap map;
  for (const float density : {5e-4f, 1.25e-4f, 1e-9f, 1.0f}) {
    Photon p{};
    p.pathDensity = density;
    p.normal = p.direction = packDirection(vec3(0, 1, 0));
    map.photons.push_back(p);
  }
  std::vector<PhotonVolume> volumes;
  makeVolumes(map, 0.2f, {.radiusMin = 0.25f, .radiusMax = 2}, volumes);
  EXPECT_FLOAT_EQ(volumes[0].radius, 0.2f);
  EXPECT_FLOAT_EQ(volumes[1].radius, 0.4f);
  EXPECT_FLOAT_EQ(volumes[2].radius, 0.4f);   // radiusMax
  EXPECT_FLOAT_EQ(volumes[3].radius, 0.05f);  // radiusMin
}

TEST(PhotonVolumes, EveryTileIsInOneBlock) {
  for (const int secondary : {0, 1, 64, 200}) {
    const ViewSamples view = makeView({.width = 300, .height = 150, .secondaryTiles = secondary});
    photon_estimate::TileBlocks blocks;
    blocks.build(view);
    std::multiset<std::uint32_t> seen;
    for (std::size_t block = 0; block < blocks.size(); ++block)
      for (const std::uint32_t tile : blocks.tiles(block))
        if (tile != photon_estimate::kNoTile) seen.insert(tile);
    EXPECT_EQ(seen.size(), view.tiles.size());
    EXPECT_EQ(std::set<std::uint32_t>(seen.begin(), seen.end()).size(), view.tiles.size());
  }
}

}  // namespace
}  // namespace isophote

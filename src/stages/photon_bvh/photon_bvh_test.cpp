// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_bvh/photon_bvh.h"

#include "base/error.h"
#include "physics/shading_normal.shared.h"
#include "stages/photon_bvh/ellipsoids.h"
#include "stages/photon_estimate/photon_loops.h"
#include "stages/photon_volumes/test_view.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstring>

namespace isophote {
namespace {

using namespace photon_volumes_test;
using Vec = glm::dvec3;

/// Photons with footprints of many sizes and shapes, a third of them of caustics.
PhotonMap withFootprints(std::uint32_t count) {
  PhotonMap map = makePhotons(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const vec3 u = random3(11, i, 0), w = random3(11, i, 1);
    const mat3 frame = basisAround(unpackDirection(map.photons[i].normal));
    PhotonFootprint f{};
    f.axisX = (frame[0] * u.x + frame[1] * (u.y - 0.5f)) * 0.02f;
    f.axisY = (frame[0] * (w.x - 0.5f) + frame[1] * w.y) * 0.02f;
    f.spacing = 0.01f;
    f.scattered = w.z < 0.3f ? 0u : 1u;
    map.footprints.push_back(f);
  }
  return map;
}

PhotonBvhSettings defaults() {
  PhotonBvhSettings settings;
  settings.smoothingCaustic = 8;
  return settings;
}

struct Rendered {
  Radiance radiance;
  Stats stats;
};

Rendered render(const PhotonBvhSettings& settings, const ViewSamples& view, const PhotonMap& map,
                float radius, float shrink = 1.0f, SimdLevel simd = bestSimdLevel(), const Job& job = {}) {
  Rendered out;
  PhotonBvh(settings).run({view, map, radius, shrink, 24.0, simd}, out.radiance, out.stats, job);
  return out;
}

bool sameBytes(const Radiance& a, const Radiance& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(RadianceTile)) == 0;
}

/// A footprint's ellipse in numbers of its own.
struct Ellipse {
  Vec major, minor;  ///< Semi-axes.
};

/// By turning one axis into the other until they are perpendicular (conjugate half-diameters).
Ellipse ellipseOf(const PhotonFootprint& f) {
  const Vec x(f.axisX), y(f.axisY);
  const double angle = 0.5 * std::atan2(2.0 * glm::dot(x, y), glm::dot(x, x) - glm::dot(y, y));
  return {std::cos(angle) * x + std::sin(angle) * y, std::cos(angle) * y - std::sin(angle) * x};
}

/// Semi-axes after compression, smoothing and limits.
Ellipse shapedEllipse(const PhotonFootprint& f, const PhotonBvhSettings& s, double smoothing, double radius) {
  Ellipse e = ellipseOf(f);
  for (Vec* axis : {&e.major, &e.minor}) {
    const double length = glm::length(*axis);
    double wanted = double(s.smoothingCaustic) * length;
    if (f.scattered != 0u)
      wanted = smoothing * length * std::pow(length / double(f.spacing) / double(s.referenceLength), -0.75);
    const double least = s.radiusMin > 0 ? double(s.radiusMin) : 0.05 * radius;
    const double most = s.radiusMax > 0 ? double(s.radiusMax) : 4.0 * radius;
    *axis *= std::clamp(wanted, least, most) / length;
  }
  return e;
}

/// Every photon held against every view sample, in double precision.
void expectAllPairs(const PhotonBvhSettings& settings, const ViewSamples& view, const PhotonMap& map,
                    float radius) {
  const Rendered got = render(settings, view, map, radius);
  const double smoothing = got.stats.counter("photon_bvh.smoothing");
  struct Known {
    Vec position, u, v, w, power, direction;
  };
  std::vector<Known> photons;
  for (std::size_t i = 0; i < map.photons.size(); ++i) {
    const Photon& p = map.photons[i];
    const Vec n(unpackDirection(p.normal));
    const Ellipse e = shapedEllipse(map.footprints[i], settings, smoothing, double(radius));
    const double a = glm::length(e.major), b = glm::length(e.minor),
                 c = double(settings.flatness) * std::min(a, b);
    const double area = double(kPi) * a * b * (settings.kernel == Kernel::kConstant ? 1.0 : 0.5);
    photons.push_back({Vec(p.position), e.major / (a * a), e.minor / (b * b), n / c, Vec(p.power) / area,
                       Vec(unpackDirection(p.direction))});
  }
  double worst = 0, brightest = 0;
  int lit = 0, samples = 0;
  for (std::size_t t = 0; t < view.tiles.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (view.tiles[t].pixel[lane] == kNoPixel) continue;
      const ViewSample s = laneOf(view.tiles[t], lane);
      Vec sum(0.0);
      for (const Known& p : photons) {
        const Vec d = Vec(s.position) - p.position;
        const double x = glm::dot(d, p.u), y = glm::dot(d, p.v), z = glm::dot(d, p.w);
        const double t2 = x * x + y * y + z * z;
        if (t2 >= 1.0) continue;
        const vec3 wi(p.direction);
        const double factor = double(photonEstimateFactor(wi, s.ng, s.ns));
        sum += Vec(evalBsdf(s.bsdf, wi, s.wo, s.ng, s.ns)) * p.power * (factor * (1.0 - t2));
      }
      ++samples;
      lit += sum.y > 0 ? 1 : 0;
      const Vec found(got.radiance[t].r[lane], got.radiance[t].g[lane], got.radiance[t].b[lane]);
      worst = std::max(worst, glm::length(found - sum));
      brightest = std::max(brightest, glm::length(sum));
    }
  EXPECT_GT(lit, samples / 2);
  EXPECT_LT(worst, 1e-4 * brightest);
}

TEST(PhotonBvh, FindsWhatEveryPairOfPhotonAndSampleGives) {
  const ViewSamples view = makeView({.width = 40, .height = 30, .secondaryTiles = 5});
  const PhotonMap map = withFootprints(2000);
  PhotonBvhSettings settings = defaults();
  for (const PhotonSplit split : {PhotonSplit::kMorton, PhotonSplit::kVolume})
    for (const std::uint32_t leaf : {0u, 1u, 9u, 5000u}) {
      settings.split = split;
      settings.leafPhotons = leaf;
      expectAllPairs(settings, view, map, 0.15f);
    }
  settings.leafPhotons = 0;
  settings.flatness = 0.3f;
  settings.radiusMin = 0.04f;
  settings.radiusMax = 0.2f;
  settings.referenceLength = 7;
  expectAllPairs(settings, view, map, 0.1f);
}

TEST(PhotonBvh, TheSameBytesWithAnyNumberOfThreads) {
  const ViewSamples view = makeView({.width = 200, .height = 100, .secondaryTiles = 130});
  const PhotonMap map = withFootprints(20'000);
  const tbb::global_control threadLimit(tbb::global_control::max_allowed_parallelism, 8);
  for (const PhotonSplit split : {PhotonSplit::kMorton, PhotonSplit::kVolume}) {
    PhotonBvhSettings settings = defaults();
    settings.split = split;
    Radiance one;
    tbb::task_arena(1).execute([&] { one = render(settings, view, map, 0.1f).radiance; });
    for (const int threads : {2, 8}) {
      Radiance many;
      tbb::task_arena(threads).execute([&] { many = render(settings, view, map, 0.1f).radiance; });
      EXPECT_TRUE(sameBytes(one, many)) << threads << " threads";
    }
  }
}

TEST(PhotonBvh, EveryInstructionSetGivesTheSameBytes) {
  const PhotonMap map = withFootprints(3000);
  for (const ViewOptions& options :
       {ViewOptions{.secondaryTiles = 5}, ViewOptions{.lambertian = true, .bentNormals = false}}) {
    const ViewSamples view = makeView(options);
    const Radiance baseline = render(defaults(), view, map, 0.2f, 1.0f, SimdLevel::kBaseline).radiance;
    for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512})
      if (level <= bestSimdLevel()) {
        EXPECT_TRUE(sameBytes(render(defaults(), view, map, 0.2f, 1.0f, level).radiance, baseline))
            << name(level);
      }
  }
}

TEST(PhotonBvh, ASecondRunOverwritesTheFirst) {
  PhotonBvh stage(defaults());
  const ViewSamples view = makeView({.secondaryTiles = 7}),
                    small = makeView({.width = 20, .height = 9, .seed = 5});
  const PhotonMap map = withFootprints(1000), few = withFootprints(3);
  Radiance out;
  Stats stats;
  stage.run({view, map, 0.2f}, out, stats);
  const Radiance first = out;
  stage.run({small, few, 0.2f}, out, stats);
  EXPECT_TRUE(sameBytes(out, render(defaults(), small, few, 0.2f).radiance));
  stage.run({view, map, 0.2f}, out, stats);
  EXPECT_TRUE(sameBytes(out, first));
  stage.run({view, PhotonMap{}, 0.0f}, out, stats);
  EXPECT_TRUE(sameBytes(out, Radiance(view.tiles.size())));
}

TEST(PhotonBvh, StopsAndRefusesARadiusOfZero) {
  const ViewSamples view = makeView({});
  const PhotonMap map = withFootprints(100);
  std::stop_source source;
  source.request_stop();
  Job job;
  job.stop = source.get_token();
  EXPECT_THROW(render(defaults(), view, map, 0.2f, 1.0f, bestSimdLevel(), job), Error);
  EXPECT_THROW(render(defaults(), view, map, 0.0f), Error);
  PhotonMap without = map;
  without.footprints.clear();
  EXPECT_THROW(render(defaults(), view, without, 0.2f), Error);
}

/// All lengths of a pass shrink alike, whatever bounds them.
TEST(PhotonBvh, ShrinksEveryFootprintInProportion) {
  const ViewSamples view = makeView({.width = 16, .height = 8});
  const PhotonMap map = withFootprints(500);
  for (const float limit : {0.0f, 0.1f}) {
    PhotonBvhSettings settings = defaults();
    settings.radiusMax = limit;
    const LargeVector<KeyedIndex> order = [] {
      LargeVector<KeyedIndex> all;
      for (std::uint32_t i = 0; i < 500; ++i) all.push_back({0, i});
      return all;
    }();
    photon_bvh::Ellipsoids whole, part;
    const auto areaOf = [&](float shrink, photon_bvh::Ellipsoids& out) {
      return makeEllipsoids(map, photon_bvh::shapeFor({view, map, 0.1f * shrink, shrink}, settings), order,
                            out);
    };
    EXPECT_NEAR(areaOf(0.25f, part) / areaOf(1.0f, whole), 1.0 / 16, 1e-6);
    for (std::size_t i = 0; i < 500; ++i)
      EXPECT_NEAR(part.photons[i].weightedPower.x, 16 * whole.photons[i].weightedPower.x,
                  1e-3f * part.photons[i].weightedPower.x);
  }
}

// IGPM, end of 4.3, in the units of its table 3.
TEST(PhotonBvh, RadiiFollowTheFourthRootOfTheSpacing) {
  const float spacing = 2.0f * std::sqrt(kPi / 256e3f);
  const FootprintSmoothing s{40.0f, 5.0f, 0.75f, 1.0f};
  for (const float way : {1.0f, 10.0f, 16.0f})  // [m]
    EXPECT_NEAR(smoothedRadius(s, spacing * way, spacing, 1u), 40.0f * spacing * std::pow(way, 0.25f), 1e-4f);
  EXPECT_FLOAT_EQ(smoothedRadius(s, 0.01f, spacing, 0u), 0.05f);
  const FootprintSmoothing none{2.0f, 5.0f, 0.0f, 3.0f};
  EXPECT_NEAR(smoothedRadius(none, 0.01f, spacing, 1u), 0.02f, 1e-6f);
}

TEST(PhotonBvh, TheMiddleRadiusIsInProportionToTheSmoothing) {
  const PhotonMap map = withFootprints(5000);
  const float one = middleRadius(map, defaults(), 1.0f);
  EXPECT_GT(one, 0.0f);
  EXPECT_NEAR(middleRadius(map, defaults(), 3.0f), 3.0f * one, 1e-5f * one);
  EXPECT_EQ(middleRadius(PhotonMap{}, defaults(), 1.0f), 0.0f);
  // Half of the scattered photons' radii lie below it.
  int below = 0, scattered = 0;
  for (const PhotonFootprint& f : map.footprints) {
    if (f.scattered == 0u) continue;
    const Ellipse e = shapedEllipse(f, {.radiusMin = 1e-6f, .radiusMax = 1e6f}, 1.0, 1.0);
    below += glm::length(e.major) * glm::length(e.minor) < double(one * one) ? 1 : 0;
    ++scattered;
  }
  EXPECT_NEAR(double(below) / scattered, 0.5, 0.03);
}

TEST(PhotonBvh, SkewedAxesSpanTheSameEllipse) {
  for (std::uint32_t i = 0; i < 200; ++i) {
    const vec3 n = normalize(random3(3, i, 0) - 0.5f);
    const mat3 frame = basisAround(n);
    const vec3 u = random3(3, i, 1) - 0.5f, w = random3(3, i, 2) - 0.5f;
    PhotonFootprint f{};
    f.axisX = frame[0] * u.x + frame[1] * u.y;
    f.axisY = i % 5 == 0 ? cross(n, f.axisX) : frame[0] * w.x + frame[1] * w.y;
    const FootprintAxes a = footprintAxes(f, n);
    EXPECT_GE(a.majorRadius, a.minorRadius * 0.9999f);
    EXPECT_NEAR(dot(a.major, a.minor), 0.0f, 1e-5f);
    for (float turn = 0.0f; turn < 1.0f; turn += 0.1f) {
      const vec3 p = f.axisX * std::cos(2 * kPi * turn) + f.axisY * std::sin(2 * kPi * turn);
      const float x = dot(p, a.major) / a.majorRadius, y = dot(p, a.minor) / a.minorRadius;
      EXPECT_NEAR(x * x + y * y, 1.0f, 2e-3f) << i;
    }
  }
}

/// The kernel integrates to 1 over the tangent plane whatever the height, and cuts another surface in the
/// section of the ellipsoid.
TEST(PhotonBvh, KernelsIntegrateToOneOverTheTangentPlane) {
  Photon p{};
  p.position = vec3(1, 2, 3);
  p.power = vec3(1.0f);
  const vec3 n = normalize(vec3(1, 2, -1));
  p.normal = p.direction = packDirection(n);
  const vec3 normal = unpackDirection(p.normal);
  const mat3 frame = basisAround(normal);
  const FootprintAxes axes{frame[0], 0.5f, frame[1], 0.2f};
  for (const uint kernel : {kKernelConstant, kKernelEpanechnikov})
    for (const float flatness : {0.1f, 1.0f}) {
      const PhotonEllipsoid e = photonEllipsoid(p, kernel, axes, normal, flatness);
      double sum = 0;
      constexpr int kSteps = 400;
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const float x = (float(i) + 0.5f) / kSteps * 1.2f - 0.6f,
                      y = (float(j) + 0.5f) / kSteps * 1.2f - 0.6f;
          const float t2 = ellipsoidDistance2(e, p.position + frame[0] * x + frame[1] * y);
          sum += double(kernelValue(kernel, t2)) * 1.44 / (kSteps * kSteps);
        }
      EXPECT_NEAR(sum * double(e.weightedPower.x), 1.0, 5e-3);
      const float height = flatness * 0.2f;
      EXPECT_NEAR(ellipsoidDistance2(e, p.position + normal * height), 1.0f, 1e-3f);
    }
}

/// The number of photons at which splitting ends grows with what overlaps at a point of a surface.
TEST(PhotonBvh, TheAutomaticLeafFollowsTheAreaOfFootprints) {
  const ViewSamples view = makeView({.width = 16, .height = 8});
  const PhotonMap map = withFootprints(20'000);
  PhotonBvhSettings settings = defaults();
  settings.smoothing = 1;
  double before = 0;
  for (const float radius : {0.03f, 0.1f, 0.3f}) {
    const Rendered r = render(settings, view, map, radius);
    EXPECT_GE(r.stats.counter("photon_bvh.leafPhotons"), before);
    before = r.stats.counter("photon_bvh.leafPhotons");
  }
  EXPECT_GT(before, 16);
}

}  // namespace
}  // namespace isophote

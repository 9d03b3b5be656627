// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/light_gbuffer/light_gbuffer.h"

#include "math/rng.shared.h"
#include "math/sampling.shared.h"
#include "trace/light_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace isophote {
namespace {

constexpr Bounds kBounds{vec3(-2, -1, -1), vec3(3, 1, 4)};

Light lightOf(std::uint32_t type, float outerDegrees = 40) {
  Light light{};
  light.type = type;
  light.position = vec3(0.1f, 0.2f, 0.3f);
  light.direction = normalize(vec3(0.3f, -1, 0.2f));
  light.colour = vec3(1, 2, 3);
  light.cosOuter = std::cos(outerDegrees * kPi / 180.0f);
  light.cosInner = std::cos(0.7f * outerDegrees * kPi / 180.0f);
  return light;
}

std::vector<LightView> viewsOf(const Light& light, std::uint32_t side, vec3 turn, float margin = 0) {
  std::vector<LightView> views;
  appendLightViews(light, 0, kBounds, lightViewFrame(light, turn), side, margin, views);
  for (LightView& view : views) view.subpixel = vec2(0.5f);
  return views;
}

double measureOf(const std::vector<LightView>& views) {
  double sum = 0;
  for (const LightView& v : views)
    for (std::uint32_t y = 0; y < v.height; ++y)
      for (std::uint32_t x = 0; x < v.width; ++x)
        sum += double(lightViewPixelMeasure(v, vec2(float(x), float(y))));
  return sum;
}

TEST(LightViews, PixelsOfACubeDivideTheSphere) {
  for (const std::uint32_t side : {1u, 2u, 7u, 64u, 301u}) {
    const std::vector<LightView> views = viewsOf(lightOf(kLightPoint), side, vec3(0.3f, 0.6f, 0.9f));
    ASSERT_EQ(views.size(), 6u);
    EXPECT_NEAR(measureOf(views) / (4.0 * double(kPi)), 1.0, 1e-6) << side;
  }
}

/// Against the integral of cos^3 over a pixel, by the midpoint rule with so many points that its error is
/// below 1e-6; and small pixels keep their digits.
TEST(LightViews, SolidAnglesAreExact) {
  const LightView view = viewsOf(lightOf(kLightPoint), 8, vec3(0.0f)).front();
  constexpr int kPoints = 200;
  for (const vec2 pixel : {vec2(0, 0), vec2(3, 3), vec2(7, 1)}) {
    const vec2 lower = lightViewPlane(view, pixel);
    const vec2 size = lightViewPlane(view, pixel + vec2(1)) - lower;
    double sum = 0;
    for (int i = 0; i < kPoints; ++i)
      for (int k = 0; k < kPoints; ++k) {
        const double x = double(lower.x) + double(size.x) * (i + 0.5) / kPoints;
        const double y = double(lower.y) + double(size.y) * (k + 0.5) / kPoints;
        sum += std::pow(1.0 + x * x + y * y, -1.5);
      }
    const double expected = sum * double(size.x) * double(size.y) / (kPoints * kPoints);
    EXPECT_NEAR(double(lightViewPixelMeasure(view, pixel)) / expected, 1.0, 3e-6);
  }
  const LightView fine = viewsOf(lightOf(kLightPoint), 4096, vec3(0.0f)).front();
  const double centre = double(lightViewPixelMeasure(fine, vec2(2048, 2048)));
  const double corner = double(lightViewPixelMeasure(fine, vec2(0, 0)));
  const double area = 4.0 / (4096.0 * 4096.0);
  EXPECT_NEAR(centre / area, 1.0, 1e-5);
  EXPECT_NEAR(corner / centre, std::pow(3.0, -1.5), 1e-3);
}

/// Every direction that a light sends light in lies in one view (borders apart), at the pixel whose ray runs
/// along it.
TEST(LightViews, CoverTheLightOnceAndProjectBack) {
  for (const float outer : {20.0f, 49.0f, 55.0f, 80.0f, 90.0f})
    for (const std::uint32_t type : {kLightPoint, kLightSpot}) {
      const Light light = lightOf(type, outer);
      const std::vector<LightView> views = viewsOf(light, 16, vec3(0.2f, 0.5f, 0.7f));
      for (std::uint32_t i = 0; i < 2000; ++i) {
        const vec3 u = random3(1, i, 0);
        const vec3 direction =
            type == kLightPoint ? sampleSphere(vec2(u.x, u.y))
                                : basisAround(light.direction) * sampleCone(vec2(u.x, u.y), light.cosOuter);
        int found = 0;
        for (const LightView& v : views) {
          const vec3 p = lightViewProject(v, light.position + direction * 3.0f);
          if (!(p.z > 0 && p.x >= 0 && p.y >= 0 && p.x < 16 && p.y < 16)) continue;
          ++found;
          EXPECT_LT(length(lightViewDirection(v, lightViewPlane(v, vec2(p.x, p.y))) - direction), 1e-5f);
        }
        EXPECT_EQ(found, 1) << outer << " " << i;
      }
    }
}

TEST(LightViews, DirectionalViewHoldsTheSceneAndItsPowerIsExact) {
  for (const vec3 direction :
       {vec3(0, -1, 0), normalize(vec3(1, -2, 0.5f)), normalize(vec3(-1, -0.01f, 3))}) {
    Light light = lightOf(kLightDirectional);
    light.direction = direction;
    const std::vector<LightView> views = viewsOf(light, 50, vec3(0.4f));
    ASSERT_EQ(views.size(), 1u);
    const LightView& v = views.front();
    EXPECT_EQ(std::max(v.width, v.height), 50u);
    for (int corner = 0; corner < 8; ++corner) {
      const vec3 at(corner & 1 ? kBounds.lower.x : kBounds.upper.x,
                    corner & 2 ? kBounds.lower.y : kBounds.upper.y,
                    corner & 4 ? kBounds.lower.z : kBounds.upper.z);
      const vec3 p = lightViewProject(v, at);
      EXPECT_GT(p.z, 0);
      EXPECT_GT(std::min(p.x, p.y), -1e-3f);
      EXPECT_LT(p.x, float(v.width) + 1e-3f);
      EXPECT_LT(p.y, float(v.height) + 1e-3f);
    }
    const vec3 extents = projectedHalfExtents(direction, 0.5f * kBounds.size());
    EXPECT_NEAR(measureOf(views) / double(4.0f * extents.x * extents.y), 1.0, 1e-5);
  }
}

TEST(LightViews, MarginWidensByWholePixels) {
  const LightView v = viewsOf(lightOf(kLightPoint), 20, vec3(0.0f), 2.0f).front();
  EXPECT_NEAR(lightViewPlane(v, vec2(2, 18)).x, -1.0f, 1e-5f);
  EXPECT_NEAR(lightViewPlane(v, vec2(2, 18)).y, 1.0f, 1e-5f);
}

// ---------------------------------------------------------------- the stage

TEST(LightGbuffer, HitsAreThoseOfSingleRays) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  const std::vector<std::uint32_t> pixels(scene.lights.size(), 20'000);
  LightSamples samples;
  Stats stats;
  LightGbuffer().run({trace, pixels, 5, 2}, samples, stats);
  ASSERT_EQ(samples.maps.size(), 1u);
  EXPECT_GE(samples.maps[0].photons, 20'000u);
  EXPECT_LT(samples.maps[0].photons, 21'000u);
  std::map<std::uint32_t, int> paths;
  for (const LightBlock& block : samples.blocks) {
    const Hit* hit = samples.hits.data() + block.firstHit;
    forEachPixel(block, [&](std::uint32_t number, vec2 pixel) {
      ++paths[block.firstPath + number];
      const LightView& view = samples.views[block.view];
      const EmittedPhoton photon = emitThroughPixel(scene.lights[0], view, pixel);
      const Hit expected = trace.closestHit({photon.origin, 0.0f, photon.direction});
      EXPECT_EQ(hit->instance, expected.instance);
      EXPECT_EQ(hit->triangle, expected.triangle);
      EXPECT_NEAR(hit->t, expected.t, 1e-4f * expected.t);
      ++hit;
    });
  }
  EXPECT_EQ(paths.size(), samples.hits.size()) << "two pixels share the key of their random numbers";
}

TEST(LightGbuffer, PassesAndSeedsLookThroughOtherPoints) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  const std::vector<std::uint32_t> pixels(scene.lights.size(), 600);
  Stats stats;
  LightSamples first, again, pass, seed;
  LightGbuffer stage;
  stage.run({trace, pixels, 1, 0}, first, stats);
  stage.run({trace, pixels, 1, 0}, again, stats);
  stage.run({trace, pixels, 1, 1}, pass, stats);
  stage.run({trace, pixels, 2, 0}, seed, stats);
  EXPECT_EQ(first.views[0].forward, again.views[0].forward);
  EXPECT_EQ(first.views[0].subpixel, again.views[0].subpixel);
  for (const LightSamples* other : {&pass, &seed}) {
    EXPECT_GT(length(first.views[0].forward - other->views[0].forward), 1e-3f);
    EXPECT_NE(first.views[0].subpixel, other->views[0].subpixel);
  }
}

TEST(LightGbuffer, LightsWithoutBudgetOrViewsAreLeftOut) {
  const Scene scene = loadScene("cornell-box");
  const TraceScene trace(scene);
  Stats stats;
  LightSamples samples;
  LightGbuffer().run({trace, std::vector<std::uint32_t>(scene.lights.size(), 1000)}, samples, stats);
  EXPECT_TRUE(samples.maps.empty());
  EXPECT_TRUE(samples.hits.empty());
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/direct/soft_shadows.h"

#include "scene/builtin/shapes.h"
#include "stages/direct/direct.h"
#include "stages/gbuffer/gbuffer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace isophote {
namespace {

constexpr int kWidth = 256, kHeight = 96;
constexpr float kLampHeight = 3.0f;
/// Half the angle under which the sun is seen.
constexpr float kSunDegrees = 5.0f;
/// Of the sun's shadow map, which holds a floor of 4 m and an eighth more on every side.
constexpr float kTexel = 4.0f / (0.75f * 2048.0f);

/// A floor, and above its left half (x < 0) a board at a height; a lamp straight above the board's edge, so
/// that the shadow's edge runs along x = 0. The camera looks straight down from beneath the board, and sees
/// `span` metres across.
struct EdgeScene {
  Scene scene;
  Camera camera;

  EdgeScene(float boardHeight, const Light& lamp, float span, bool orthographic = false) {
    Mesh floor, board;
    addQuad(floor, vec3(-2, 0, 2), vec3(4, 0, 0), vec3(0, 0, -4));
    addQuad(board, vec3(-2, boardHeight, 2), vec3(2, 0, 0), vec3(0, 0, -4));
    const std::uint32_t white = addMaterial(scene, lambert("white", vec3(0.8f)));
    addObject(scene, "floor", white, floor);
    addObject(scene, "board", white, board);
    scene.lights = {lamp};
    camera.eye = vec3(0, 0.9f * boardHeight, 0);
    camera.target = vec3(0, 0, 0);
    camera.up = vec3(0, 0, -1);
    const float tall = span * float(kHeight) / float(kWidth);
    if (orthographic)
      camera.orthographicHeight = tall;
    else
      camera.verticalFovDegrees = std::atan(0.5f * tall / camera.eye.y) * 360.0f / kPi;
    scene.cameras = {camera};
    finishScene(scene, "edge");
  }
};

Light lampAbove() {
  Light light{};
  light.type = kLightPoint;
  light.position = vec3(0, kLampHeight, 0);
  light.colour = vec3(10);
  return light;
}

Light spotAbove() {
  Light light = lampAbove();
  light.type = kLightSpot;
  light.direction = vec3(0, -1, 0);
  light.cosInner = std::cos(0.7f);
  light.cosOuter = std::cos(0.8f);
  return light;
}

Light sunAbove() {
  Light light{};
  light.type = kLightDirectional;
  light.direction = vec3(0, -1, 0);
  light.colour = vec3(2);
  return light;
}

Radiance lightOf(const Scene& scene, const DirectSettings& settings, ViewSamples& view,
                 std::uint32_t pass = 0) {
  const TraceScene trace(scene);
  Stats stats;
  Gbuffer({}).run({trace, cameraRays(scene.cameras.front(), kWidth, kHeight), kWidth, kHeight}, view, stats);
  Direct direct(settings);
  Radiance radiance;
  if (direct.wantsShadowMaps()) direct.prepare(RasterScene(trace), {}, stats);
  direct.run({trace, view, 0, pass}, radiance, stats);
  return radiance;
}

/// Part of the light that is left, by pixel.
std::vector<float> visibleParts(const Scene& scene, const DirectSettings& settings) {
  Scene open = scene;
  open.instances.resize(1);
  finishScene(open, "open");
  ViewSamples view;
  const Radiance blocked = lightOf(scene, settings, view);
  const Radiance full = lightOf(open, {}, view);
  std::vector<float> part(std::size_t(kWidth) * kHeight, 0.0f);
  for (std::size_t t = 0; t < view.primaryTiles; ++t)
    for (int lane = 0; lane < kTileLanes; ++lane)
      if (view.tiles[t].pixel[lane] != kNoPixel && full[t].r[lane] > 0.0f)
        part[view.tiles[t].pixel[lane]] = blocked[t].r[lane] / full[t].r[lane];
  return part;
}

/// Mean over the rows, by column.
std::vector<float> profile(const std::vector<float>& parts) {
  std::vector<float> mean(kWidth, 0.0f);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      mean[std::size_t(x)] += parts[std::size_t(y) * kWidth + std::size_t(x)] / float(kHeight);
  return mean;
}

/// Metres between the places where a tenth and nine tenths of the light arrive.
float edgeWidth(const std::vector<float>& columns, float span) {
  const auto first = [&](float part) {
    return std::ranges::find_if(columns, [&](float v) { return v >= part; }) - columns.begin();
  };
  return float(first(0.9f) - first(0.1f)) * span / float(kWidth);
}

/// Of a disc of radius 1, cut by a line: between a tenth and nine tenths of its area lie 1.3746 radii, since
/// acos(h) - h sqrt(1 - h^2) = pi / 10 at h = 0.6870.
constexpr float kTenthsOfDisc = 1.374f;

float penumbraOf(float radius, float height) { return radius * height / (kLampHeight - height); }

DirectSettings softened(Shadows shadows, float radius) {
  DirectSettings settings;
  settings.shadows = shadows;
  settings.lightRadius = radius;
  settings.lightAngle = radius > 0.0f ? kSunDegrees : 0.0f;
  settings.areaSamples = 64;
  settings.blurSamples = 49;
  settings.shadowResolution = 2048;
  return settings;
}

struct SoftCase {
  Shadows shadows;
  Light light;
  const char* name;
};
class SoftShadowTest : public ::testing::TestWithParam<SoftCase> {};

/// The edge is as wide as similar triangles say, whatever the distance from board to floor: contact is sharp.
TEST_P(SoftShadowTest, PenumbraGrowsWithTheDistanceOfWhatThrowsIt) {
  float last = 0.0f;
  for (const float height : {0.1f, 0.4f, 1.0f}) {
    constexpr float kRadius = 0.15f;
    const bool parallel = GetParam().light.type == kLightDirectional;
    const float expected =
        parallel ? height * std::tan(kSunDegrees * kPi / 180.0f) : penumbraOf(kRadius, height);
    const float span = 8.0f * expected;
    const EdgeScene edge(height, GetParam().light, span);
    const float width =
        edgeWidth(profile(visibleParts(edge.scene, softened(GetParam().shadows, kRadius))), span);
    std::printf("%s, board %.1f m above: edge %.4f m wide, expected %.4f\n", GetParam().name, height, width,
                kTenthsOfDisc * expected);
    // A pixel at each end, a twentieth for the light's and the disc's shape, and what a map cannot resolve.
    const float coarse = GetParam().shadows == Shadows::kPcss && parallel ? 2.0f * kTexel : 0.0f;
    EXPECT_NEAR(width, kTenthsOfDisc * expected, 2.0f * span / kWidth + 0.05f * expected + coarse);
    EXPECT_GT(width, 1.5f * last);
    last = width;
  }
}

/// Column by column, the light is that of rays to all of the lamp.
TEST_P(SoftShadowTest, IsTheLightOfRaysToAllOfTheLight) {
  const EdgeScene edge(0.6f, GetParam().light, 0.3f, true);
  const std::vector<float> got = profile(visibleParts(edge.scene, softened(GetParam().shadows, 0.15f)));
  const std::vector<float> truth = profile(visibleParts(edge.scene, softened(Shadows::kArea, 0.15f)));
  double squares = 0;
  for (std::size_t x = 0; x < got.size(); ++x) squares += double((got[x] - truth[x]) * (got[x] - truth[x]));
  const double rms = std::sqrt(squares / double(got.size()));
  std::printf("%s: rms %.4f of the light\n", GetParam().name, rms);
  EXPECT_LT(rms, 0.03);
}

/// As the light shrinks, hard shadows are what is left: of rays (gathered, area), or of the map (pcss).
TEST_P(SoftShadowTest, BecomesHardAsTheLightShrinks) {
  const EdgeScene edge(1.0f, GetParam().light, 2.0f);
  DirectSettings hard = softened(GetParam().shadows == Shadows::kPcss ? Shadows::kMap : Shadows::kTraced, 0);
  const std::vector<float> truth = visibleParts(edge.scene, hard);
  double last = 1;
  for (const float radius : {0.2f, 0.02f, 0.0002f, 0.0f}) {
    DirectSettings settings = softened(GetParam().shadows, radius);
    settings.lightAngle = 10.0f * radius;
    const std::vector<float> parts = visibleParts(edge.scene, settings);
    double sum = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) sum += double(std::abs(parts[i] - truth[i]));
    const double difference = sum / double(parts.size());
    EXPECT_LE(difference, last + 1e-6) << "radius " << radius;
    last = difference;
    if (radius == 0.0002f) {
      EXPECT_LT(difference, 0.004);
    }
  }
  EXPECT_EQ(last, 0.0) << "without a size shadows are hard";
}

INSTANTIATE_TEST_SUITE_P(Lights, SoftShadowTest,
                         ::testing::Values(SoftCase{Shadows::kGathered, lampAbove(), "GatheredPoint"},
                                           SoftCase{Shadows::kGathered, spotAbove(), "GatheredSpot"},
                                           SoftCase{Shadows::kGathered, sunAbove(), "GatheredSun"},
                                           SoftCase{Shadows::kPcss, lampAbove(), "PcssPoint"},
                                           SoftCase{Shadows::kPcss, spotAbove(), "PcssSpot"},
                                           SoftCase{Shadows::kPcss, sunAbove(), "PcssSun"},
                                           SoftCase{Shadows::kArea, lampAbove(), "AreaPoint"},
                                           SoftCase{Shadows::kArea, spotAbove(), "AreaSpot"},
                                           SoftCase{Shadows::kArea, sunAbove(), "AreaSun"}),
                         [](const auto& one) { return one.param.name; });

/// The size given to a point light is that of a sphere of the scene: the same light to the last photon.
TEST(SoftShadows, AreaIsTheLightOfASphereInTheScene) {
  EdgeScene given(0.6f, lampAbove(), 0.5f), own(0.6f, lampAbove(), 0.5f);
  own.scene.lights[0].radius = 0.15f;
  finishScene(own.scene, "own");
  DirectSettings traced;
  traced.areaSamples = 64;
  const std::vector<float> a = profile(visibleParts(given.scene, softened(Shadows::kArea, 0.15f)));
  ViewSamples view;
  const Radiance ra = lightOf(given.scene, softened(Shadows::kArea, 0.15f), view);
  const Radiance rb = lightOf(own.scene, traced, view);
  double sumA = 0, sumB = 0;
  for (std::size_t t = 0; t < ra.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      sumA += double(ra[t].r[lane]);
      sumB += double(rb[t].r[lane]);
    }
  EXPECT_GT(sumB, 0.0);
  EXPECT_NEAR(sumA / sumB, 1.0, 1e-4);
  EXPECT_GT(a.back(), 0.9f);
}

/// The cheaper mode: one width everywhere.
TEST(SoftShadows, BlurOfOneRadiusDoesNotGrow) {
  float widths[2];
  int i = 0;
  for (const float height : {0.2f, 1.0f}) {
    const EdgeScene edge(height, lampAbove(), 1.0f);
    DirectSettings settings = softened(Shadows::kGathered, 0.15f);
    settings.blurRadius = 0.1f;
    widths[i++] = edgeWidth(profile(visibleParts(edge.scene, settings)), 1.0f);
  }
  EXPECT_NEAR(widths[0], kTenthsOfDisc * 0.1f, 0.02f);
  EXPECT_NEAR(widths[1], widths[0], 0.02f);
}

/// The same bytes for any number of threads and again.
TEST(SoftShadows, ThreadsDoNotMatter) {
  Scene scene = loadScene("atrium");
  for (const Shadows shadows : {Shadows::kGathered, Shadows::kPcss}) {
    ViewSamples view;
    DirectSettings settings = softened(shadows, 0.2f);
    settings.shadowResolution = 256;
    const Radiance many = lightOf(scene, settings, view, 3);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Radiance single = lightOf(scene, settings, view, 3);
    for (std::size_t t = 0; t < many.size(); ++t)
      for (int lane = 0; lane < kTileLanes; ++lane) {
        if (view.tiles[t].pixel[lane] == kNoPixel) continue;
        ASSERT_EQ(many[t].r[lane], single[t].r[lane]) << int(shadows);
      }
  }
}

/// Every instruction set gives the same bytes.
TEST(SoftShadows, InstructionSetsAgree) {
  const Scene scene = loadScene("atrium");
  const TraceScene trace(scene);
  Stats stats;
  ViewSamples view;
  Gbuffer({}).run({trace, cameraRays(scene.cameras.front(), 160, 90), 160, 90}, view, stats);
  const direct::SoftLight light{scene.lights.at(0), 0.2f};
  ShadowMaps maps;
  maps.build(RasterScene(trace), trace.lights(), {}, {256, 2, 1.0f, 0.125f}, {});
  for (const bool mapped : {false, true}) {
    std::vector<direct::FloatLanes> expected;
    std::size_t between = 0;
    for (const SimdLevel level : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
      if (level > bestSimdLevel()) continue;
      direct::SoftShadows shadows;
      const direct::SoftShadows::In in{.trace = trace, .view = view, .simd = level};
      shadows.start(in, {});
      if (mapped)
        shadows.lookUp(maps, 0, light, {});
      else
        shadows.gather(light, {});
      EXPECT_GT(shadows.tilesBlurred(), 20u);
      for (std::size_t t = 0; t < view.primaryTiles; ++t) {
        direct::FloatLanes got;
        shadows.visibility(light, t, got);
        if (level == SimdLevel::kBaseline) expected.push_back(got);
        for (std::uint32_t lane = 0; lane < std::uint32_t(kTileLanes); ++lane) {
          if (view.tiles[t].pixel[lane] == kNoPixel) continue;
          ASSERT_EQ(got[lane], expected[t][lane]) << name(level) << ", tile " << t;
          between += got[lane] > 0.0f && got[lane] < 1.0f;
        }
      }
    }
    EXPECT_GT(between, 500u);
  }
}

/// Passes turn the discs.
TEST(SoftShadows, EveryPassLooksElsewhere) {
  const EdgeScene edge(0.6f, lampAbove(), 0.3f);
  DirectSettings settings = softened(Shadows::kGathered, 0.15f);
  settings.smooth = false;
  ViewSamples view;
  const Radiance first = lightOf(edge.scene, settings, view, 1),
                 second = lightOf(edge.scene, settings, view, 2);
  std::size_t differ = 0;
  for (std::size_t t = 0; t < view.primaryTiles; ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) differ += first[t].r[lane] != second[t].r[lane];
  EXPECT_GT(differ, 1000u);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The photon mapper against the path tracer: what the whole project rests on.
#include "agreement/agreement.h"

namespace isophote {
namespace {

/// Mean over the picture of what the view samples send to the eye.
double meanOfRadiance(const ViewSamples& view, const Radiance& radiance) {
  double sum = 0;
  for (std::size_t t = 0; t < view.tiles.size(); ++t)
    for (int lane = 0; lane < kTileLanes; ++lane) {
      const ViewTile& tile = view.tiles[t];
      if (tile.pixel[lane] == kNoPixel) continue;
      const vec3 throughput = throughputOf(tile, lane);
      sum += double(throughput.x * radiance[t].r[lane]) + double(throughput.y * radiance[t].g[lane]) +
             double(throughput.z * radiance[t].b[lane]);
    }
  return sum / (3.0 * double(view.width) * double(view.height));
}

/// Extrapolates to radius 0 the means at radius r and r / 2.
template <class Stage>
double extrapolatedMean(Stage& stage, const ViewSamples& view, const PhotonMap& map, float radius) {
  Stats stats;
  Radiance radiance;
  stage.run({view, map, radius}, radiance, stats);
  const double whole = meanOfRadiance(view, radiance);
  stage.run({view, map, 0.5f * radius}, radiance, stats);
  return 2.0 * meanOfRadiance(view, radiance) - whole;
}

void expectMeansAgree(const TraceScene& trace, const Case& c, const Mean& expected) {
  const int width = int(c.width);
  const int height = int(c.height);
  Stats stats;
  ViewSamples view;
  Gbuffer({}).run({trace, cameraRays(trace.scene().cameras.front(), width, height), width, height}, view,
                  stats);
  PhotonTrace photonTrace({.photons = c.photons});
  // One radius for all photons, and volumes flat enough not to reach from one small feature to the next.
  PhotonVolumes volumes({.radiusMin = 1, .radiusMax = 1, .flatness = 0.4f});
  PhotonKdtree kdtree({.nearest = 0});
  Trials byVolumes;
  Trials byKdtree;
  for (std::uint32_t seed = 0; seed < c.seeds; ++seed) {
    PhotonMap map;
    photonTrace.run({.trace = trace, .seed = seed}, map, stats);
    byVolumes.add(extrapolatedMean(volumes, view, map, c.radius));
    byKdtree.add(extrapolatedMean(kdtree, view, map, c.radius));
  }
  expectMeanAgrees(c, "volumes", byVolumes.mean(), expected);
  expectMeanAgrees(c, "kdtree", byKdtree.mean(), expected);
}

/// Default settings, the same primary samples as the reference: PSNR of the indirect light at so many stored
/// photons.
double psnrOfIndirect(const TraceScene& trace, const Case& c, std::uint32_t stored, const Film& expected) {
  RenderSettings settings;
  settings.frame.width = c.width;
  settings.frame.height = c.height;
  settings.photonTrace.photonsStored = stored;
  settings.direct.areaSamples = 1;
  Stats stats;
  const Film film = renderCpu(trace, trace.scene().cameras.front(), settings, stats);
  const double psnr = compareImages(film.layers.at("indirect"), expected.colour).psnr;
  std::printf("%s: %u photons stored, PSNR of the indirect light %.2f dB\n", c.scene.c_str(), stored, psnr);
  EXPECT_TRUE(psnr >= 20.0) << writeFailure(film.layers.at("indirect"), expected.colour);
  return psnr;
}

void expectAgreement(const Case& c) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  const std::optional<Scene> loaded = sceneOf(c.scene);
  if (!loaded) GTEST_SKIP() << whyNoScene();
  const Scene& scene = *loaded;
  const TraceScene trace(scene);
  const Film film = reference(trace, c);
  const Mean expected = meanOfReference(film);
  expectMeansAgree(trace, c, expected);

  const double few = psnrOfIndirect(trace, c, 10'000, film);
  const double more = psnrOfIndirect(trace, c, 50'000, film);
  const double many = psnrOfIndirect(trace, c, 200'000, film);
  EXPECT_GT(more, few);
  EXPECT_GT(many, more);
  EXPECT_GE(many, 30.0);
}

/// A closed room of albedo 1/2 that glows with radiance 1: three bounces of indirect light are 1/4 + 1/8 +
/// 1/16, everywhere.
void expectFurnace(const char* name, float radius) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  constexpr double kExact = 0.4375;
  const Scene scene = loadScene(name);
  const TraceScene trace(scene);
  const int side = 160;
  Stats stats;
  ViewSamples view;
  Gbuffer({}).run({trace, cameraRays(scene.cameras.front(), side, side), side, side}, view, stats);
  PhotonTrace photonTrace({.photons = 2'000'000});
  PhotonVolumes volumes({.radiusMin = 1, .radiusMax = 1});
  Trials trials;
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    PhotonMap map;
    Radiance radiance;
    photonTrace.run({.trace = trace, .seed = seed}, map, stats);
    volumes.run({view, map, radius}, radiance, stats);
    trials.add(meanOfRadiance(view, radiance));
  }
  const Mean mean = trials.mean();
  const std::string figures =
      fmt::format("{}: mean / exact = {:.4f} +- {:.4f}", name, mean.value / kExact, mean.deviation / kExact);
  std::printf("%s\n", figures.c_str());
  EXPECT_LT(mean.deviation / kExact, 0.0025) << figures;
  EXPECT_NEAR(mean.value / kExact, 1.0, 0.005) << figures;
}

// Without extrapolation: the sphere has no edges, and the radius is 0.005 of the box's side.
TEST(Agreement, FurnaceSphere) { expectFurnace("furnace", 0.02f); }
TEST(Agreement, FurnaceBox) { expectFurnace("furnace-box", 0.01f); }

TEST(Agreement, CornellBox) { expectAgreement({"cornell-box", 160, 160, 256, 3'000'000, 4, 0.02f}); }
TEST(Agreement, Atrium) { expectAgreement({"atrium", 160, 90, 384, 5'000'000, 10, 0.07f}); }
TEST(Agreement, SponzaDabrovic) {
  expectAgreement({"sponza-dabrovic.json", 160, 90, 512, 3'000'000, 5, 0.08f});
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "isophote/isophote.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

namespace isophote {
namespace {

using testing::Contains;
using testing::HasSubstr;

Settings smallSettings() {
  Settings settings;
  settings.set("frame.width", 32).set("frame.height", 24).set("photon_trace.photons", 4000);
  return settings;
}

std::string sentenceOf(auto&& call, ErrorKind kind) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

/// A square floor of 2 m under a camera that looks straight down on all of it.
WorldBuilder floorBuilder(float albedo) {
  WorldBuilder builder;
  const std::uint32_t grey = builder.addMaterial({.name = "grey", .baseColour = {albedo, albedo, albedo}});
  const float positions[] = {-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1};
  const std::uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  const std::uint32_t floor =
      builder.addMesh({.name = "floor", .positions = positions, .triangles = triangles, .material = grey});
  builder.addInstance(floor);
  builder.addView({.name = "top",
                   .eye = {0, 2, 0},
                   .target = {0, 0, 0},
                   .up = {0, 0, -1},
                   .verticalFovDegrees = 53,
                   .aspect = 1});
  return builder;
}

TEST(Api, RendersABuiltInScene) {
  const World world = World::load("cornell-box");
  EXPECT_GT(world.triangleCount(), 10u);
  EXPECT_GE(world.lightCount(), 1u);
  Renderer renderer(world, smallSettings());
  const Picture picture = renderer.render();
  EXPECT_EQ(picture.width(), 32);
  EXPECT_EQ(picture.height(), 24);
  ASSERT_EQ(picture.pixels().size(), 32u * 24 * 3);
  EXPECT_THAT(picture.layerNames(), Contains("indirect"));
  double sum = 0;
  for (const float value : picture.layer("indirect")) sum += double(value);
  EXPECT_GT(sum, 0.0);
  EXPECT_THAT(picture.statsJson(), HasSubstr("photonsStored"));
  EXPECT_EQ(picture.bytes().size(), 32u * 24 * 3);
}

TEST(Api, LightsABuiltWorldAsPhysicsSays) {
  WorldBuilder builder = floorBuilder(0.5f);
  // 40 W/m^2 on a Lambertian floor of reflectance 0.5: radiance 40 * 0.5 / pi everywhere on it.
  builder.addDirectionalLight({0, -1, 0}, {40, 40, 40});
  Renderer renderer(builder.build(), smallSettings().set("frame.height", 32));
  const Picture picture = renderer.render("top");
  const std::size_t centre = (16 * 32 + 16) * 3;
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(picture.pixels()[centre + k], 20.0f / 3.14159265f, 1e-3f);
}

TEST(Api, EveryLightThatABuilderTakesLights) {
  const std::function<void(WorldBuilder&)> lights[] = {
      [](WorldBuilder& b) {
        b.addPointLight({0, 1, 0}, {10, 10, 10});
      },
      [](WorldBuilder& b) {
        b.addPointLight({0, 1, 0}, {10, 10, 10}, 0.1f);
      },
      [](WorldBuilder& b) {
        b.addSpotLight({0, 1, 0}, {0, -1, 0}, {10, 10, 10}, 10, 40);
      },
      [](WorldBuilder& b) {
        b.addRectangleLight({0, 1, 0}, {0, 0, 0.5f}, {-0.5f, 0, 0}, {5, 5, 5});
      },
      [](WorldBuilder& b) {
        b.addEnvironmentLight({1, 1, 1});
      },
  };
  for (const auto& light : lights) {
    WorldBuilder builder = floorBuilder(0.5f);
    light(builder);
    Renderer renderer(builder.build(), smallSettings());
    const Picture picture = renderer.render(View{.eye = {0, 0.5f, 0.8f}, .target = {0, 0, 0}});
    EXPECT_GT(picture.pixels()[(12 * 32 + 16) * 3], 0.01f) << &light - lights;
  }
}

TEST(Api, SamePictureWithAnyNumberOfThreadsAndInTwoAtOnce) {
  const World world = World::load("cornell-box");
  const auto pixelsWith = [&](int threads) {
    Renderer renderer(world, smallSettings(), threads);
    const Picture picture = renderer.render();
    return std::vector<float>(picture.pixels().begin(), picture.pixels().end());
  };
  const std::vector<float> one = pixelsWith(1);
  EXPECT_EQ(one, pixelsWith(3));
  std::vector<float> a, b;
  std::thread first([&] { a = pixelsWith(0); });
  std::thread second([&] { b = pixelsWith(2); });
  first.join();
  second.join();
  EXPECT_EQ(one, a);
  EXPECT_EQ(one, b);
}

TEST(Api, ARendererGivesTheSamePictureAgain) {
  Renderer renderer(World::load("cornell-box"), smallSettings());
  const Picture first = renderer.render();
  const Picture elsewhere = renderer.render(View{.eye = {0.5f, 0.5f, 0.5f}, .target = {0, 0.5f, 0}});
  const Picture again = renderer.render();
  EXPECT_TRUE(std::equal(first.pixels().begin(), first.pixels().end(), again.pixels().begin()));
  EXPECT_FALSE(std::equal(first.pixels().begin(), first.pixels().end(), elsewhere.pixels().begin()));
}

TEST(Api, RefinesAPictureUntilTheViewChanges) {
  const World world = World::load("cornell-box");
  const View view = world.views().front();
  Renderer renderer(world, smallSettings());
  const auto copy = [](const Picture& p) { return std::vector<float>(p.pixels().begin(), p.pixels().end()); };
  const std::vector<float> first = copy(renderer.refine(view));
  const std::vector<float> second = copy(renderer.refine(view));
  EXPECT_NE(first, second);
  EXPECT_NE(copy(renderer.refine({.eye = {0.5f, 0.5f, 0.5f}, .target = {0, 0.5f, 0}})), second);
  EXPECT_EQ(copy(renderer.refine(view)), first);
  // Two passes at once are the same picture.
  Renderer twice(world, smallSettings().set("frame.passes", 2));
  EXPECT_EQ(copy(twice.render(view)), second);
}

/// A floor and a lamp of each kind that can be moved or turned; coordinates are exact in binary.
World lampsOver(Float3 point, Float3 spot, Float3 rectangle, Float3 sun) {
  WorldBuilder builder = floorBuilder(0.5f);
  builder.addPointLight(point, {20, 10, 5});
  builder.addSpotLight(spot, {0, -1, 0}, {5, 20, 10}, 20, 40);
  builder.addRectangleLight(rectangle, {0.5f, 0, 0}, {0, 0, 0.25f}, {9, 9, 20});
  builder.addDirectionalLight(sun, {2, 2, 2});
  return builder.build();
}

TEST(Api, AQualitySetsTheWorkAndLeavesTheWayToThePreset) {
  Settings settings = Settings::preset("clusters");
  settings.applyQuality("draft");
  EXPECT_EQ(settings.get("frame.estimator"), "clusters");
  EXPECT_EQ(settings.get("frame.subsample"), "8");
  EXPECT_EQ(settings.get("frame.passes"), "1");
  EXPECT_EQ(settings.applyQuality("preview").get("frame.passes"), "8");
  settings.set("photon_trace.photons", 2000);
  EXPECT_THAT(sentenceOf([&] { settings.applyQuality("prewiev"); }, ErrorKind::kBadUsage),
              HasSubstr("\"preview\""));
  EXPECT_EQ(settings.get("photon_trace.photons"), "2000") << "nothing changes where the name is wrong";
}

TEST(Api, ALightThatWasMovedLightsAsOneThatStoodThere) {
  const World before = lampsOver({0.5f, 1, 0}, {-0.5f, 1, 0.5f}, {0, 1.5f, -0.5f}, {0, -1, 0});
  const World after = lampsOver({-0.25f, 0.5f, 0.5f}, {0.5f, 0.75f, 0}, {-0.5f, 1, 0.25f}, {1, 0, 0});
  for (const Settings& preset : {Settings(), Settings::preset("ispm"), Settings::preset("jensen")}) {
    Settings settings = preset;
    settings.set("frame.width", 32).set("frame.height", 24).set("photon_trace.photons", 4000);
    Renderer moving(before, settings), standing(after, settings);
    const View view = before.views().front();
    const Picture first = moving.render(view);
    moving.refine(view);
    moving.moveLight(0, {-0.25f, 0.5f, 0.5f});
    moving.moveLight(1, {0.5f, 0.75f, 0});
    moving.moveLight(2, {-0.5f, 1, 0.25f});
    moving.aimLight(3, {1, 0, 0});
    const Picture moved = moving.render(view), stood = standing.render(view);
    EXPECT_TRUE(std::ranges::equal(moved.pixels(), stood.pixels()));
    EXPECT_FALSE(std::ranges::equal(moved.pixels(), first.pixels()));
    const Picture refined = moving.refine(view), anew = standing.refine(view);
    EXPECT_TRUE(std::ranges::equal(refined.pixels(), anew.pixels())) << "passes begin anew";
  }
}

TEST(Api, RefusesToMoveWhatCannotBeMoved) {
  Renderer renderer(lampsOver({0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, -1, 0}), smallSettings());
  EXPECT_THAT(sentenceOf([&] { renderer.moveLight(4, {0, 1, 0}); }, ErrorKind::kBadUsage), HasSubstr("4"));
  EXPECT_THAT(sentenceOf(
                  [&] {
                    renderer.moveLight(3, {0, 1, 0});
                  },
                  ErrorKind::kBadUsage),
              HasSubstr("directional"));
  EXPECT_THAT(sentenceOf(
                  [&] {
                    renderer.moveLight(0, {0, NAN, 0});
                  },
                  ErrorKind::kBadUsage),
              HasSubstr("stand"));
  EXPECT_THAT(sentenceOf([&] { renderer.aimLight(0, {0, 1, 0}); }, ErrorKind::kBadUsage), HasSubstr("point"));
}

TEST(Api, AgreesWithItsReference) {
  const World world = World::load("cornell-box");
  const Picture reference =
      renderReference(world, world.views().front(), {.width = 32, .height = 32, .samplesPerPixel = 64});
  Renderer renderer(world, smallSettings().set("frame.height", 32).set("photon_trace.photons", 100000));
  const Picture picture = renderer.render();
  double photons = 0, paths = 0;
  for (const float value : picture.layer("indirect")) photons += double(value);
  for (const float value : reference.layer("indirect")) paths += double(value);
  // The photons' kernel darkens edges by a few per cent; 64 paths a pixel leave 0.5 % of noise in the mean.
  EXPECT_NEAR(photons / paths, 1.0, 0.06);
}

/// The middle pixel's red of a world seen by its first view.
float middleOf(const World& world) {
  Renderer renderer(
      world, smallSettings().set("frame.height", 32).set("photon_trace.photons", 1).set("frame.bounces", 0));
  return renderer.render().pixels()[(16 * 32 + 16) * 3];
}

TEST(Api, AnEnvironmentMapShinesFromItsDirections) {
  // Bright above the horizon only: the floor of reflectance 0.5 gets all of it, whatever lies below.
  constexpr int kWidth = 32, kHeight = 16;
  std::vector<float> sky(kWidth * kHeight * 3, 0.0f);
  std::fill(sky.begin(), sky.begin() + kWidth * kHeight / 2 * 3, 2.0f);
  WorldBuilder builder = floorBuilder(0.5f);
  builder.addEnvironmentLight(kWidth, kHeight, sky);
  // The row at the horizon is interpolated with the dark one below.
  EXPECT_NEAR(middleOf(builder.build()), 1.0f, 0.1f);
  EXPECT_THAT(sentenceOf([&] { floorBuilder(0.5f).addEnvironmentLight(4, 2, sky); }, ErrorKind::kBadInput),
              HasSubstr("4 x 2"));
}

TEST(Api, EveryPartOfAMaterialIsHeard) {
  const auto redOf = [](MaterialData material, std::span<const float> colours = {}) {
    WorldBuilder builder;
    // Red 1, green 0.5, blue 0, alpha 0.5.
    const std::uint8_t texel[] = {255, 128, 0, 128};
    const std::uint32_t texture =
        builder.addTexture({.name = "texel", .width = 1, .height = 1, .rgba = texel, .srgb = false});
    for (std::uint32_t* index : {&material.baseColourTexture, &material.emissionTexture})
      if (*index == 0) *index = texture;
    const float positions[] = {-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1};
    const float uvs[] = {0, 0, 0, 1, 1, 1, 1, 0};
    const std::uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    const std::uint32_t id = builder.addMaterial(material);
    builder.addInstance(builder.addMesh(
        {.positions = positions, .uvs = uvs, .colours = colours, .triangles = triangles, .material = id}));
    builder.addView({.eye = {0, 2, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}});
    builder.addDirectionalLight({0, -1, 0}, {3.14159265f, 0, 0});
    return middleOf(builder.build());
  };
  const float tolerance = 2e-3f;
  EXPECT_NEAR(redOf({.baseColour = {0.8f, 0, 0}}), 0.8f, tolerance);
  EXPECT_NEAR(redOf({.baseColour = {0.8f, 0, 0}, .baseColourTexture = 0}), 0.8f, tolerance);
  EXPECT_NEAR(redOf({.baseColour = {0.8f, 0, 0}, .unlit = true}), 0.8f, tolerance);
  EXPECT_NEAR(redOf({.baseColour = {0, 0, 0}, .emission = {3, 0, 0}}), 3.0f, tolerance);
  EXPECT_NEAR(redOf({.baseColour = {0, 0, 0}, .emission = {3, 3, 3}, .emissionTexture = 0}), 3.0f, tolerance);
  EXPECT_NEAR(redOf({.baseColour = {0.8f, 0, 0}, .coverage = Coverage::kBlend, .alpha = 0.25f}), 0.2f,
              tolerance);
  EXPECT_NEAR(redOf({.baseColour = {0.8f, 0, 0}, .coverage = Coverage::kMask, .alpha = 0.25f}), 0.0f,
              tolerance);
  const std::vector<float> half(16, 0.5f);
  EXPECT_NEAR(redOf({.baseColour = {0.8f, 0, 0}}, half), 0.4f, tolerance);
  EXPECT_LT(redOf({.baseColour = {0, 0, 0}, .roughness = 0.5f, .specular = 1}),
            redOf({.baseColour = {0, 0, 0}, .metallic = 0, .roughness = 0.5f, .specular = 1, .ior = 2.0f}));
  EXPECT_LT(
      redOf({.baseColour = {0, 0, 0}, .roughness = 0.5f, .specular = 1, .specularColour = {0.1f, 1, 1}}),
      redOf({.baseColour = {0, 0, 0}, .roughness = 0.5f, .specular = 1}));
}

TEST(Api, StopsAndStaysUsable) {
  Renderer renderer(World::load("cornell-box"), smallSettings());
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(
      sentenceOf([&] { renderer.render("", Job{.stop = stop.get_token()}); }, ErrorKind::kStopped).empty(),
      false);
  EXPECT_EQ(renderer.render().width(), 32);
}

TEST(Api, ReportsProgressAndWarnings) {
  std::atomic<int> reports{0};
  Job job;
  job.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, 0.0);
    EXPECT_LE(fraction, 1.0);
    ++reports;
  };
  std::string warning;
  job.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::kWarning) warning = message;
  };
  const World world = floorBuilder(0.5f).build(job);  // No light: a default one, and a warning.
  EXPECT_THAT(warning, HasSubstr("light"));
  Renderer(world, smallSettings(), 0, job).render("", job);
  EXPECT_GT(reports.load(), 0);
}

TEST(Api, SettingsAreReadAndWrittenByKey) {
  Settings settings = Settings::preset("jensen");
  EXPECT_EQ(settings.get("frame.estimator"), "kdtree");
  settings.setJson(R"({"frame": {"width": 77}, "photon_trace.photons": 123})");
  EXPECT_EQ(settings.get("frame.width"), "77");
  EXPECT_EQ(settings.get("photon_trace.photons"), "123");
  Settings copy;
  copy.setJson(settings.json());
  EXPECT_EQ(copy.json(), settings.json());
  EXPECT_THAT(sentenceOf([&] { settings.set("frame.widht", 3); }, ErrorKind::kBadUsage),
              HasSubstr("frame.width"));
  // Nothing changes where any key is wrong.
  sentenceOf([&] { settings.setJson(R"({"frame.width": 5, "frame.nothing": 1})"); }, ErrorKind::kBadUsage);
  EXPECT_EQ(settings.get("frame.width"), "77");
}

TEST(Api, RefusesBadWorldsWithASentence) {
  WorldBuilder builder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const float broken[] = {0, 0, 0, 1, nan, 0, 0, 1, 0};
  const std::uint32_t triangle[] = {0, 1, 2}, beyond[] = {0, 1, 3};
  const auto refuses = [&](auto&& call, const char* words) {
    EXPECT_THAT(sentenceOf(call, ErrorKind::kBadInput), HasSubstr(words));
  };
  refuses([&] { builder.addMesh({.positions = positions, .triangles = triangle}); }, "material 0");
  builder.addMaterial({});
  refuses([&] { builder.addMaterial({.baseColour = {2, 0, 0}}); }, "baseColour");
  refuses([&] { builder.addMaterial({.baseColourTexture = 3}); }, "texture 3");
  refuses([&] { builder.addMesh({.positions = positions, .triangles = beyond}); }, "vertex 3");
  refuses([&] { builder.addInstance(5); }, "mesh 5");
  refuses([&] { builder.addPointLight({nan, 0, 0}, {1, 1, 1}); }, "position");
  refuses([&] { builder.addSpotLight({0, 0, 0}, {0, 1, 0}, {1, 1, 1}, 50, 40); }, "innerDegrees");
  refuses([&] { builder.addRectangleLight({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 1}); }, "edges");
  refuses([&] { builder.addView({.eye = {0, 0, 0}, .target = {0, 0, 0}}); }, "target");
  refuses([&] { builder.addTexture({.width = 2, .height = 2, .rgba = {}}); }, "bytes");
  refuses([&] { WorldBuilder().build(); }, "no triangles");
  const std::uint32_t mesh = builder.addMesh({.name = "bad", .positions = broken, .triangles = triangle});
  builder.addInstance(mesh);
  refuses([&] { builder.build(); }, "bad");
  refuses([&] { World::load("no-such-scene"); }, "no-such-scene");
}

TEST(Api, RefusesWhatThePictureDoesNotHave) {
  Renderer renderer(World::load("cornell-box"), smallSettings());
  const Picture picture = renderer.render();
  EXPECT_THAT(sentenceOf([&] { picture.layer("shine"); }, ErrorKind::kBadUsage), HasSubstr("indirect"));
  EXPECT_THAT(sentenceOf([&] { picture.save("picture.tiff"); }, ErrorKind::kBadUsage), HasSubstr(".exr"));
  EXPECT_THAT(sentenceOf([&] { renderer.render("nowhere"); }, ErrorKind::kBadUsage), HasSubstr("nowhere"));
  EXPECT_THAT(sentenceOf([&] { Renderer(World::load("cornell-box"), Settings(), -1); }, ErrorKind::kBadUsage),
              HasSubstr("threads"));
}

}  // namespace
}  // namespace isophote

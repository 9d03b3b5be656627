// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/description.h"

#include "base/error.h"
#include "physics/environment.shared.h"
#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace isophote {
namespace {

using testing::HasSubstr;

/// A description of one square in the plane z = 0, with more keys behind its model.
class Description : public testing::Test {
 protected:
  Description() {
    folder_.write("models/square.obj",
                  "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl paint\nf 1 2 3 4\n");
    folder_.write("models/square.mtl", "newmtl paint\nKd 0.5 0.25 0.125\nKe 1 1 1\nd 1\n");
  }
  Scene load(const std::string& text, const SceneOptions& options = {}) {
    return loadDescription(folder_.write("scene.json", text), options);
  }
  Scene loadWith(const std::string& keys) {
    return load(R"({"isophote": 1, "models": [{"file": "models/square.obj", "name": "sign"}])" +
                (keys.empty() ? "" : ", " + keys) + "}");
  }
  std::string errorWith(const std::string& keys) {
    return errorOf([&] { loadWith(keys); });
  }
  Light light(const std::string& text) { return loadWith("\"lights\": [" + text + "]").lights.at(0); }
  std::string lightError(const std::string& text) { return errorWith("\"lights\": [" + text + "]"); }
  Material material(const std::string& overrides) {
    return loadWith("\"materials\": {\"paint\": " + overrides + "}").materials.at(0);
  }

  TestFolder folder_;
};

void expectNear(vec3 a, vec3 b) {
  EXPECT_LT(length(a - b), 1e-5f * (1.0f + length(b))) << a.x << " " << a.y << " " << a.z;
}

TEST_F(Description, LoadsAModelBesideIt) {
  const Scene scene = loadWith("");
  EXPECT_EQ(scene.name, "scene");
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].name, "sign/square");
  EXPECT_EQ(scene.materials.at(0).name, "paint");
}

TEST_F(Description, PlacesModels) {
  const Scene scene = load(R"({"isophote": 1, "models": [{"file": "models/square.obj",
      "translation": [10, 20, 30], "rotation": [0, 0, 0.70710678, 0.70710678], "scale": [2, 3, 4]}]})");
  const mat4x3& m = scene.instances.at(0).worldFromObject;
  expectNear(m * vec4(0, 0, 0, 1), vec3(10, 20, 30));
  expectNear(m * vec4(1, 0, 0, 1), vec3(10, 22, 30));  // Scaled by 2, then turned from x to y.
  expectNear(m * vec4(0, 1, 0, 1), vec3(7, 20, 30));
  expectNear(m * vec4(0, 0, 1, 1), vec3(10, 20, 34));
}

TEST_F(Description, SharesTheMeshesOfRepeatedModels) {
  const Scene scene =
      load(R"({"isophote": 1, "models": [{"file": "models/square.obj", "translation": [1, 0, 0]},
      {"file": "models/../models/square.obj"}, {"file": "models/square.obj", "name": "b", "scale": 2}]})");
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  expectNear(scene.instances[0].worldFromObject[3], vec3(1, 0, 0));
  expectNear(scene.instances[1].worldFromObject[3], vec3(0));
  expectNear(scene.instances[2].worldFromObject[0], vec3(2, 0, 0));
  EXPECT_EQ(scene.instances[2].name, "b/square");
}

TEST_F(Description, PutsModelsTogether) {
  folder_.write("models/other.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
  const Scene scene =
      load(R"({"isophote": 1, "models": [{"file": "models/square.obj"}, {"file": "models/other.obj"},
      {"file": "cornell-box"}]})");
  ASSERT_GT(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.materials[scene.meshes[2].material].name, "b");
  EXPECT_EQ(scene.instances[2].mesh, 2u);
  EXPECT_FALSE(scene.cameras.empty()) << "a built-in scene brings its camera";
}

TEST_F(Description, SearchesAssetFoldersInOrder) {
  TestFolder first;
  TestFolder second;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  first.write("a/x.obj", triangle + "o first\nf 1 2 3\n");
  second.write("a/x.obj", triangle + "o second\nf 1 2 3\n");
  const std::string text = R"({"isophote": 1, "models": [{"file": "a/x.obj"}]})";
  EXPECT_EQ(load(text, {.assetFolders = {first.path(), second.path()}}).meshes.at(0).name, "first");
  EXPECT_EQ(load(text, {.assetFolders = {second.path(), first.path()}}).meshes.at(0).name, "second");
  folder_.write("a/x.obj", triangle + "o beside\nf 1 2 3\n");
  EXPECT_EQ(load(text, {.assetFolders = {first.path()}}).meshes.at(0).name, "beside");
}

TEST_F(Description, SaysWhereMissingModelsAreToBeHad) {
  const std::string text =
      R"({"isophote": 1, "models": [{"file": "b/lost.obj", "source": "example.org, folder b"}]})";
  const std::string sentence = errorOf([&] { load(text, {.assetFolders = {"/no/assets"}}); });
  EXPECT_THAT(sentence, HasSubstr("scene.json: models[0].file: there is no model \"b/lost.obj\" in"));
  EXPECT_THAT(sentence, HasSubstr("/no/assets"));
  EXPECT_THAT(sentence, HasSubstr("--assets"));
  EXPECT_THAT(sentence, HasSubstr("example.org, folder b"));
}

TEST_F(Description, ReadsCameras) {
  const Scene one = loadWith(R"("camera": {"eye": [0, 1, 5], "target": [0, 1, 0], "up": [5, 0, 0],
                                "verticalFovDegrees": 30, "aspect": 2})");
  ASSERT_EQ(one.cameras.size(), 1u);
  EXPECT_EQ(one.cameras[0].eye, vec3(0, 1, 5));
  EXPECT_EQ(one.cameras[0].up, vec3(1, 0, 0));
  EXPECT_EQ(one.cameras[0].verticalFovDegrees, 30.0f);
  EXPECT_EQ(one.cameras[0].aspect, 2.0f);
  const Scene two = loadWith(R"("cameras": [{"name": "a", "eye": [0, 1, 5], "target": [0, 1, 0]},
                                {"name": "b", "eye": [0, 2, 5], "target": [0, 1, 0], "orthographicHeight": 3}])");
  ASSERT_EQ(two.cameras.size(), 2u);
  EXPECT_EQ(two.cameras[1].name, "b");
  EXPECT_EQ(two.cameras[1].orthographicHeight, 3.0f);
  const Scene before = load(R"({"isophote": 1, "models": [{"file": "cornell-box"}],
                                "camera": {"name": "mine", "eye": [0, 1, 5], "target": [0, 1, 0]}})");
  EXPECT_EQ(before.cameras.at(0).name, "mine");
  EXPECT_GE(before.cameras.size(), 2u) << "cameras of the models stay, behind";
}

TEST_F(Description, PointLightsSpreadTheirWattsOverTheSphere) {
  const Light point = light(R"({"type": "point", "watts": 100, "position": [1, 2, 3], "radius": 0.5})");
  EXPECT_EQ(point.type, kLightPoint);
  EXPECT_EQ(point.position, vec3(1, 2, 3));
  EXPECT_EQ(point.radius, 0.5f);
  expectNear(point.colour * 4.0f * kPi, vec3(100));
  expectNear(light(R"({"type": "point", "watts": [1, 2, 3], "position": [0, 0, 0]})").colour * 4.0f * kPi,
             vec3(1, 2, 3));
}

TEST_F(Description, SpotLightsSpreadTheirWattsOverTheCone) {
  const Light spot = light(R"({"type": "spot", "watts": 60, "position": [0, 0, 0], "direction": [0, -2, 0],
                               "innerDegrees": 20, "outerDegrees": 50})");
  EXPECT_EQ(spot.direction, vec3(0, -1, 0));
  // Numerically, from glTF's definition of the falloff.
  double flux = 0;
  const int steps = 200000;
  for (int i = 0; i < steps; ++i) {
    const double cosine = 1.0 - (i + 0.5) / steps;
    const double ramp = (cosine - double(spot.cosOuter)) / double(spot.cosInner - spot.cosOuter);
    const double falloff = std::clamp(ramp, 0.0, 1.0);
    flux += 2.0 * M_PI * falloff * falloff / steps;
  }
  EXPECT_NEAR(double(spot.colour.x) * flux, 60.0, 1e-3);
}

TEST_F(Description, DirectionalAndEnvironmentLightsKeepTheirUnits) {
  const Light sun = light(R"({"type": "directional", "irradiance": [3, 2, 1], "direction": [0, -3, 4]})");
  EXPECT_EQ(sun.type, kLightDirectional);
  EXPECT_EQ(sun.colour, vec3(3, 2, 1));
  expectNear(sun.direction, vec3(0, -0.6f, 0.8f));
  const Light sky = light(R"({"type": "environment", "radiance": 0.25})");
  EXPECT_EQ(sky.type, kLightEnvironment);
  EXPECT_EQ(sky.colour, vec3(0.25f));
}

TEST_F(Description, EnvironmentsTakeMapsThatAreScaledAndTurned) {
  folder_.write("sky.hdr", std::string("#?RADIANCE\n\n-Y 1 +X 2\n") + "\x80\x40" + std::string(1, '\0') +
                               "\x81\x40\x80" + std::string(1, '\0') + "\x81");
  const Scene scene = loadWith(R"("lights": [{"type": "environment", "file": "sky.hdr", "radiance": [3, 2, 1],
                                  "rotationDegrees": 90}, {"type": "directional", "irradiance": 1,
                                  "direction": [0, -1, 0]}])");
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].mapped, 1u);
  EXPECT_EQ(scene.lights[0].colour, vec3(3, 2, 1));
  ASSERT_EQ(scene.environment.radiance.width, 2);
  EXPECT_EQ(scene.environment.radiance.at(0, 0), vec3(1.0f, 0.5f, 0.0f));
  // What was right of the map's middle has turned away from the eye, to -z; its middle, which was at -z,
  // left.
  expectNear(scene.lights[0].edgeU, vec3(0, 0, -1));
  expectNear(worldFromMap(scene.lights[0], vec3(0, 0, -1)), vec3(-1, 0, 0));
  EXPECT_EQ(light(R"({"type": "environment", "file": "sky.hdr"})").colour, vec3(1.0f));
}

TEST_F(Description, RectanglesAreCentredAndFaceTheirDirection) {
  for (const char* up : {"", R"(, "up": [1, 0, 0])", R"(, "up": [1, -5, 1])"}) {
    const Light lamp = light(fmt::format(R"({{"type": "rectangle", "radiance": 5, "position": [1, 2, 3],
                                              "direction": [0, -1, 0], "width": 2, "height": 3{}}})",
                                         up));
    expectNear(lamp.position + 0.5f * (lamp.edgeU + lamp.edgeV), vec3(1, 2, 3));
    expectNear(cross(lamp.edgeU, lamp.edgeV), vec3(0, -6, 0));
    EXPECT_NEAR(length(lamp.edgeU), 2.0f, 1e-6f);
    EXPECT_EQ(lamp.area, 6.0f);
    expectNear(lamp.direction, vec3(0, -1, 0));
    EXPECT_EQ(lamp.colour, vec3(5.0f));
  }
}

TEST_F(Description, LightsTakeThePlaceOfTheModels) {
  EXPECT_TRUE(loadWith("\"lights\": []").lights.empty());
  EXPECT_EQ(loadWith("\"lights\": []").materials.at(0).emission, vec3(1.0f)) << "emissive materials stay";
}

TEST_F(Description, NamesThePlaceOfWrongLights) {
  EXPECT_THAT(
      errorWith(R"("lights": [{"type": "environment", "radiance": 1}, {"type": "point", "watts": "much",
                           "position": [0, 0, 0]}])"),
      HasSubstr("scene.json: lights[1].watts: expected a number or [r, g, b], but this is a string"));
  EXPECT_THAT(lightError(R"({"type": "pint", "watts": 1})"),
              HasSubstr("no light type \"pint\" (did you mean \"point\"?)"));
  EXPECT_THAT(lightError(R"({"watts": 1})"), HasSubstr("lights[0]: the key \"type\" is missing"));
  EXPECT_THAT(lightError(R"({"type": "point", "watts": 1})"),
              HasSubstr("lights[0]: the key \"position\" is missing"));
  EXPECT_THAT(lightError(R"({"type": "point", "wats": 1, "position": [0, 0, 0]})"),
              HasSubstr("lights[0]: unknown key \"wats\" (did you mean \"watts\"?)"));
  EXPECT_THAT(lightError(R"({"type": "point", "watts": -1, "position": [0, 0, 0]})"),
              HasSubstr("lights[0].watts: must"));
  EXPECT_THAT(lightError(R"({"type": "point", "watts": 1e99, "position": [0, 0, 0]})"),
              HasSubstr("too large"));
  EXPECT_THAT(lightError(R"({"type": "point", "watts": 1, "position": [0, 0]})"),
              HasSubstr("lights[0].position: expected an array of 3 numbers, but this is one of 2"));
  EXPECT_THAT(lightError(R"({"type": "point", "watts": 1, "position": [0, null, 0]})"),
              HasSubstr("lights[0].position[1]: expected a number, but this is null"));
  EXPECT_THAT(lightError(R"({"type": "directional", "irradiance": 1, "direction": [0, 0, 0]})"),
              HasSubstr("lights[0].direction: must not be [0, 0, 0]"));
  EXPECT_THAT(lightError(R"({"type": "spot", "watts": 1, "position": [0, 0, 0], "direction": [0, -1, 0],
                             "innerDegrees": 40, "outerDegrees": 30})"),
              HasSubstr("lights[0].innerDegrees: must not be greater than outerDegrees"));
  EXPECT_THAT(
      lightError(R"({"type": "rectangle", "radiance": 1, "position": [0, 0, 0], "direction": [0, -1, 0],
                             "up": [0, 1, 0], "width": 1, "height": 1})"),
      HasSubstr("lights[0].up: must not be parallel"));
  EXPECT_THAT(lightError(R"({"type": "environment", "file": "lost.exr", "source": "example.org"})"),
              HasSubstr("lights[0].file: there is no environment map \"lost.exr\" in"));
  EXPECT_THAT(lightError(R"({"type": "environment", "file": "lost.exr", "source": "example.org"})"),
              HasSubstr("example.org"));
  EXPECT_THAT(lightError(R"({"type": "environment", "file": "models/square.mtl"})"),
              HasSubstr("models/square.mtl: is not a picture of a known format; a picture of radiance"));
  EXPECT_THAT(lightError(R"({"type": "environment", "radiance": 1, "rotationDegrees": 30})"),
              HasSubstr("lights[0].rotationDegrees: belongs to an environment map"));
  EXPECT_THAT(lightError(R"({"type": "environment"})"),
              HasSubstr("lights[0]: the key \"radiance\" is missing"));
  EXPECT_THAT(lightError(R"({"type": "environment", "radiance": 1}, {"type": "environment", "radiance": 2})"),
              HasSubstr("lights: has 2 environment lights"));
}

TEST_F(Description, OverridesMaterialsInGltfsSpelling) {
  const Material m =
      material(R"({"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5,
      "roughnessFactor": 0.25}, "emissiveFactor": [1, 2, 3], "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.7,
      "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.9}, "KHR_materials_ior": {"ior": 1.33},
      "KHR_materials_specular": {"specularFactor": 0.6, "specularColorFactor": [1, 0.5, 0]},
      "KHR_materials_volume": {"thicknessFactor": 0, "attenuationColor": [0.5, 1, 1], "attenuationDistance": 2},
      "KHR_materials_unlit": {},
      "KHR_materials_emissive_strength": {"emissiveStrength": 10}}})");
  EXPECT_EQ(m.baseColour, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.alpha, 0.4f);
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emission, vec3(10, 20, 30));
  EXPECT_EQ(m.flags, kMaterialDoubleSided | kMaterialAlphaMask | kMaterialThinWalled | kMaterialUnlit);
  EXPECT_EQ(m.specularColour, vec3(1.0f, 0.5f, 0.0f));
  EXPECT_NEAR(transmittanceOver(m.absorption, 4.0f).x, 0.25f, 1e-6f);
  EXPECT_EQ(m.alphaCutoff, 0.7f);
  EXPECT_EQ(m.transmission, 0.9f);
  EXPECT_EQ(m.ior, 1.33f);
  EXPECT_EQ(m.specular, 0.6f);
}

TEST_F(Description, OverridesChangeOnlyWhatTheyName) {
  const Material m = material(R"({"pbrMetallicRoughness": {"roughnessFactor": 0.25}})");
  EXPECT_EQ(m.baseColour, vec3(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emission, vec3(1.0f));
  EXPECT_EQ(m.specular, 0.0f);
}

TEST_F(Description, OverridesTheMaterialOfOneModel) {
  folder_.write("models/copy.obj", "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl paint\nf 1 2 3\n");
  const auto withMaterials = [&](const std::string& materials) {
    return load(R"({"isophote": 1, "models": [{"file": "models/square.obj", "name": "left"},
        {"file": "models/copy.obj", "name": "right"}], "materials": {)" +
                materials + "}}")
        .materials;
  };
  const auto one = withMaterials(R"("right/paint": {"doubleSided": true})");
  EXPECT_FALSE(one.at(0).flags & kMaterialDoubleSided);
  EXPECT_TRUE(one.at(1).flags & kMaterialDoubleSided);
  const auto both = withMaterials(R"("paint": {"doubleSided": true})");
  EXPECT_TRUE(both.at(0).flags & both.at(1).flags & kMaterialDoubleSided);
}

TEST_F(Description, NamesThePlaceOfWrongOverrides) {
  EXPECT_THAT(errorWith(R"("materials": {"pain": {}})"),
              HasSubstr("no model has a material \"pain\" (did you mean \"paint\"?)"));
  EXPECT_THAT(errorWith(R"("materials": {"x": {}})"), HasSubstr("there are \"paint\""));
  const auto error = [&](const std::string& overrides) {
    return errorWith("\"materials\": {\"paint\": " + overrides + "}");
  };
  EXPECT_THAT(error(R"({"baseColorFactor": [1, 1, 1]})"),
              HasSubstr("materials.paint: unknown key \"baseColorFactor\""));
  EXPECT_THAT(error(R"({"pbrMetallicRoughness": {"metallicFactor": 2}})"),
              HasSubstr("materials.paint.pbrMetallicRoughness.metallicFactor: must lie in [0, 1], but is 2"));
  EXPECT_THAT(error(R"({"alphaMode": "MIX"})"),
              HasSubstr("materials.paint.alphaMode: there is no alpha mode"));
  EXPECT_THAT(error(R"({"extensions": {"KHR_materials_volume": {"attenuationColor": 0.5}}})"),
              HasSubstr("no attenuationDistance after which it is left"));
  EXPECT_THAT(error(R"({"doubleSided": 1})"), HasSubstr("expected true or false, but this is a number"));
  EXPECT_THAT(error(R"({"extensions": {"KHR_materials_ior": {"ior": 0.5}}})"),
              HasSubstr("must be at least 1, but is 0.5"));
  EXPECT_THAT(error(R"({"extensions": {"KHR_materials_sheen": {}}})"),
              HasSubstr("unknown key \"KHR_materials_sheen\""));
}

TEST_F(Description, HandsSettingsOn) {
  const Scene scene = loadWith(R"("settings": {"photon_trace.photons": 50000, "direct.shadows": "traced"})");
  EXPECT_THAT(scene.settings, testing::UnorderedElementsAre(std::pair("photon_trace.photons", "50000"),
                                                            std::pair("direct.shadows", "\"traced\"")));
  EXPECT_THAT(errorWith(R"("settings": {"a.b": [1]})"), HasSubstr("settings.a.b: expected"));
}

TEST_F(Description, NamesThePlaceOfOtherMistakes) {
  EXPECT_THAT(errorWith(R"("light": [])"),
              HasSubstr("scene.json: unknown key \"light\" (did you mean \"lights\"?)"));
  EXPECT_THAT(errorWith(R"("camera": {"eye": [0, 0, 1]})"),
              HasSubstr("camera: the key \"target\" is missing"));
  EXPECT_THAT(errorWith(R"("camera": {"eye": [0, 0, 1], "target": [0, 0, 1]})"),
              HasSubstr("must differ from \"eye\""));
  EXPECT_THAT(errorWith(R"("camera": {"eye": [0, 0, 1], "target": [0, 0, 0], "up": [0, 0, 1]})"),
              HasSubstr("camera.up: must not be parallel"));
  EXPECT_THAT(errorWith(R"("camera": {"eye": [0, 0, 1], "target": [0, 0, 0], "verticalFovDegrees": 180})"),
              HasSubstr("camera.verticalFovDegrees: must lie in"));
  EXPECT_THAT(errorWith(R"("cameras": [{"eye": [0, 0, 1], "target": [0, 0, 0]}])"),
              HasSubstr("cameras[0]: the key \"name\" is missing"));
  EXPECT_THAT(errorOf([&] { load(R"({"models": []})"); }), HasSubstr("the key \"isophote\" is missing"));
  EXPECT_THAT(errorOf([&] { load(R"({"isophote": 2, "models": []})"); }), HasSubstr("isophote: is 2, but"));
  EXPECT_THAT(errorOf([&] { load(R"({"isophote": 1})"); }), HasSubstr("the key \"models\" is missing"));
  EXPECT_THAT(errorOf([&] { load(R"({"isophote": 1, "models": []})"); }), HasSubstr("models: at least one"));
  EXPECT_THAT(errorOf([&] { load(R"({"isophote": 1, "models": {}})"); }),
              HasSubstr("models: expected an array"));
  EXPECT_THAT(errorOf([&] { load("[1]"); }), HasSubstr("expected an object in {}, but this is an array"));
  const auto modelError = [&](const std::string& keys) {
    return errorOf(
        [&] { load(R"({"isophote": 1, "models": [{"file": "models/square.obj", )" + keys + "}]}"); });
  };
  EXPECT_THAT(modelError(R"("rotation": [0, 0, 0, 0])"),
              HasSubstr("models[0].rotation: must be a unit quaternion"));
  EXPECT_THAT(modelError(R"("scale": 0)"), HasSubstr("models[0].scale: must not be 0"));
  EXPECT_THAT(errorOf([&] { load(R"({"isophote": 1, "models": [{"file": "models/square.mtl"}]})"); }),
              HasSubstr("models[0].file: \"models/square.mtl\" is no model"));
}

TEST_F(Description, RefusesAKeyGivenTwice) {
  EXPECT_THAT(errorWith(R"("camera": {"eye": [0, 0, 1], "eye": [0, 0, 2]})"),
              HasSubstr("scene.json: camera: the key \"eye\" is given twice; keep one"));
}

TEST_F(Description, NamesLineAndColumnOfBadJson) {
  EXPECT_THAT(errorOf([&] { load("{\n  \"isophote\": 1,\n  \"models\" []\n}"); }),
              HasSubstr("scene.json: line 3, column 12"));
  EXPECT_THAT(errorOf([&] { load("{\"isophote\": 1,"); }), HasSubstr("the file ends too early"));
  EXPECT_THAT(errorOf([&] { load(""); }), HasSubstr("line 1, column 1"));
  EXPECT_THAT(errorOf([&] { load("{\"isophote\": 1e999}"); }), HasSubstr("not valid JSON"));
  EXPECT_THAT(errorOf([&] { load("{\"\xff\": 1}"); }), HasSubstr("not valid JSON"));
  EXPECT_THAT(errorOf([&] { load(std::string(200000, '[')); }), HasSubstr("not valid JSON"));
}

TEST_F(Description, SurvivesDamage) {
  const std::string good = R"({"isophote": 1, "models": [{"file": "models/square.obj", "scale": 2}],
      "camera": {"eye": [0, 0, 3], "target": [0, 0, 0]}, "lights": [{"type": "point", "watts": 1, "position": [0, 1, 0]}],
      "materials": {"paint": {"doubleSided": true}}, "settings": {"a.b": 1}})";
  std::mt19937 random(7);
  int errors = 0;
  for (int i = 0; i < 300; ++i) {
    std::string text = good;
    constexpr std::string_view kLetters = "0123456789-.e{}[]\",:tn\xff";
    text[random() % text.size()] = kLetters[random() % kLetters.size()];
    try {
      load(text);
    } catch (const Error& error) {
      ++errors;
      ASSERT_EQ(int(error.kind()), int(ErrorKind::kBadInput)) << error.what();
    }
  }
  EXPECT_GT(errors, 150);
}

TEST(Descriptions, OfTheProjectLoadWithEverythingFound) {
  const std::filesystem::path assets = publicScenes();
  if (assets.empty()) GTEST_SKIP() << "the public test scenes are not on this machine (ISOPHOTE_ASSETS)";
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".json") continue;
    SCOPED_TRACE(entry.path().filename().string());
    ++count;
    WarningLog log;
    const Scene scene = loadScene(entry.path().string(), {.assetFolders = {assets}}, log.job());
    EXPECT_FALSE(scene.cameras.empty());
    EXPECT_FALSE(scene.lights.empty());
    EXPECT_FALSE(scene.bounds.empty());
    for (const std::string& warning : log.warnings) {
      EXPECT_THAT(warning, testing::Not(HasSubstr("emits light"))) << "no scene relies on the default light";
    }
  }
  EXPECT_GE(count, 25);
}

}  // namespace
}  // namespace isophote

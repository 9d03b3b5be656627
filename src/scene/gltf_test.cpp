// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_test_fixture.h"

#include <png.h>

#include <cmath>
#include <fstream>

namespace isophote {
namespace {

using test::GltfModel;
using test::squareModel;

/// A PNG of one pixel.
std::string onePixelPng(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  const std::uint8_t rgb[3] = {r, g, b};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = image.height = 1;
  image.format = PNG_FORMAT_RGB;
  std::string bytes(1024, '\0');
  png_alloc_size_t size = bytes.size();
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb, 0, nullptr), 0);
  bytes.resize(size);
  return bytes;
}

TEST_F(Gltf, ReadsDataUrisAndGlb) {
  expectSquare(load(squareModel().gltf()));
  expectSquare(load(squareModel().glb(), "model.glb"));
  EXPECT_EQ(load(squareModel().gltf()).name, "model");
}

TEST_F(Gltf, ReadsEveryIndexTypeAndDrawingMode) {
  GltfModel m = squareModel();
  m.primitive()["indices"] = m.add<std::uint8_t>({0, 1, 2, 0, 2, 3}, 5121, "SCALAR", 1);
  expectSquare(load(m.gltf()));
  m.primitive()["indices"] = m.add<std::uint32_t>({0, 1, 2, 0, 2, 3}, 5125, "SCALAR", 1);
  expectSquare(load(m.gltf()));

  m.primitive()["mode"] = 5;
  m.primitive()["indices"] = m.add<std::uint8_t>({0, 1, 3, 2}, 5121, "SCALAR", 1);
  Scene s = load(m.gltf());
  EXPECT_EQ(s.meshes[0].triangles, (std::vector{uvec3(0, 1, 3), uvec3(1, 2, 3)}));
  m.primitive()["mode"] = 6;
  m.primitive().erase("indices");
  s = load(m.gltf());
  EXPECT_EQ(s.meshes[0].triangles, (std::vector{uvec3(1, 2, 0), uvec3(2, 3, 0)}));
  m.primitive()["mode"] = 1;
  expectRefused(m.gltf(), "no triangles");
  EXPECT_NE(warnings_.find("points or lines"), std::string::npos);
}

TEST_F(Gltf, KeepsOnlyTheVerticesThatTrianglesUse) {
  GltfModel m = squareModel();
  m.primitive()["indices"] = m.add<std::uint16_t>({3, 1, 2}, 5123, "SCALAR", 1);
  const Scene s = load(m.gltf());
  EXPECT_EQ(s.meshes[0].positions, (std::vector{vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0)}));
  EXPECT_EQ(s.meshes[0].triangles[0], uvec3(2, 0, 1));
}

TEST_F(Gltf, ReadsStridedNormalisedAndSparseAccessors) {
  GltfModel m = squareModel();
  // Vertices of 16 bytes: position, then two normalised 16-bit texture coordinates.
  std::vector<float> vertices(16, 0.0f);
  for (std::size_t i = 0; i < 4; ++i) {
    vertices[i * 4] = float(i);
    const std::uint16_t uv[2] = {std::uint16_t(65535 * (i % 2)), 13107};
    std::memcpy(&vertices[i * 4 + 3], uv, 4);
  }
  vertices[9] = 1.0f;
  m.primitive()["attributes"]["POSITION"] = m.addVec3(vertices);
  nlohmann::json& view = m.json["bufferViews"].back();
  view["byteStride"] = 16;
  m.json["accessors"].back()["count"] = 4;
  m.json["accessors"].push_back({{"bufferView", m.json["bufferViews"].size() - 1},
                                 {"byteOffset", 12},
                                 {"componentType", 5123},
                                 {"normalized", true},
                                 {"count", 4},
                                 {"type", "VEC2"}});
  m.primitive()["attributes"]["TEXCOORD_0"] = m.json["accessors"].size() - 1;
  m.primitive()["attributes"].erase("NORMAL");
  m.json["images"] = {{{"uri", "data:image/png;base64," + test::base64(onePixelPng(1, 2, 3))}}};
  m.json["textures"] = {{{"source", 0}}};
  m.material()["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  Scene s = load(m.gltf());
  EXPECT_TRUE(s.meshes[0].normals.empty());
  EXPECT_EQ(s.meshes[0].positions[2], vec3(2, 1, 0));
  EXPECT_NEAR(s.meshes[0].uvs[3].x, 1.0f, 1e-6f);
  EXPECT_NEAR(s.meshes[0].uvs[3].y, 0.2f, 1e-6f);

  m = squareModel();
  const int indices = m.add<std::uint16_t>({1, 3}, 5123, "SCALAR", 1);
  const int values = m.addVec3({5, 6, 7, 8, 9, 10});
  nlohmann::json& positions = m.json["accessors"][0];
  positions["sparse"] = {{"count", 2},
                         {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                         {"values", {{"bufferView", values}}}};
  s = load(m.gltf());
  EXPECT_EQ(s.meshes[0].positions, (std::vector{vec3(0), vec3(5, 6, 7), vec3(1, 1, 0), vec3(8, 9, 10)}));
  positions.erase("bufferView");
  s = load(m.gltf());
  EXPECT_EQ(s.meshes[0].positions, (std::vector{vec3(0), vec3(5, 6, 7), vec3(0), vec3(8, 9, 10)}));
  positions["sparse"]["count"] = 3;
  expectRefused(m.gltf(), "accessors[0].sparse.indices: reads 3 elements");
  positions["sparse"]["count"] = 2;
  positions["count"] = 3;
  expectRefused(m.gltf(), "accessors[0].sparse.indices: entry 1 is 3, but there are only 3");
}

TEST_F(Gltf, PlacesNodesByTheirHierarchy) {
  GltfModel m = squareModel();
  m.json["nodes"] = {{{"children", {1, 2}},
                      {"translation", {10, 0, 0}},
                      {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}},
                     {{"mesh", 0}, {"name", "scaled"}, {"scale", {2, 2, 2}}},
                     {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1}}}};
  const Scene s = load(m.gltf());
  EXPECT_EQ(s.meshes.size(), 1u) << "nodes share the mesh";
  ASSERT_EQ(s.instances.size(), 2u);
  EXPECT_EQ(s.instances[0].name, "scaled");
  EXPECT_NEAR(length(s.instances[0].worldFromObject * vec4(1, 0, 0, 1) - vec3(10, 2, 0)), 0.0f, 1e-6f);
  EXPECT_NEAR(length(s.instances[1].worldFromObject * vec4(1, 0, 0, 1) - vec3(7, 1, 0)), 0.0f, 1e-6f);
}

TEST_F(Gltf, OpensTheDefaultSceneAlone) {
  GltfModel m = squareModel();
  m.json["nodes"] = {{{"mesh", 0}, {"name", "first"}}, {{"mesh", 0}, {"name", "second"}}};
  m.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  m.json["scene"] = 1;
  EXPECT_EQ(load(m.gltf()).instances.at(0).name, "second");
  m.json.erase("scene");
  EXPECT_EQ(load(m.gltf()).instances.at(0).name, "first");
  m.json.erase("scenes");
  EXPECT_EQ(load(m.gltf()).instances.size(), 2u);
}

TEST_F(Gltf, RefusesCyclesAndSharedNodesButNotDepth) {
  GltfModel m = squareModel();
  m.json["nodes"] = {{{"children", {1}}}, {{"mesh", 0}, {"children", {0}}}};
  expectRefused(m.gltf(), "nodes[0]: is reached twice");
  m.json["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
  expectRefused(m.gltf(), "nodes[1]: is reached twice");
  m.json["nodes"] = nlohmann::json::array();
  for (int i = 0; i < 20000; ++i) m.json["nodes"].push_back({{"children", {i + 1}}});
  m.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(load(m.gltf()).instances.size(), 1u);
}

TEST_F(Gltf, ReadsInstancingAttributes) {
  GltfModel m = squareModel();
  const int translation = m.addVec3({1, 0, 0, 2, 0, 0, 3, 0, 0});
  const int scale = m.addVec3({1, 1, 1, 2, 2, 2, 3, 3, 3});
  m.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translation},
                                                                               {"SCALE", scale}};
  const Scene s = load(m.gltf());
  ASSERT_EQ(s.instances.size(), 3u);
  EXPECT_EQ(s.instances[2].worldFromObject * vec4(1, 0, 0, 1), vec3(6, 0, 0));
}

TEST_F(Gltf, ReadsCameras) {
  GltfModel m = squareModel();
  m.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.5}, {"znear", 0.1}}}},
      {{"type", "orthographic"},
       {"name", "flat"},
       {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"zfar", 1}, {"znear", 0}}}}};
  m.json["nodes"] = {{{"mesh", 0}},
                     {{"camera", 0},
                      {"name", "eye"},
                      {"translation", {0, 1, 5}},
                      {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}},
                     {{"camera", 1}}};
  m.json["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene s = load(m.gltf());
  ASSERT_EQ(s.cameras.size(), 2u);
  const Camera& eye = findCamera(s, "eye");
  EXPECT_EQ(eye.eye, vec3(0, 1, 5));
  EXPECT_NEAR(length(normalize(eye.target - eye.eye) - vec3(-1, 0, 0)), 0.0f, 1e-5f);
  EXPECT_NEAR(eye.verticalFovDegrees, 0.5f * 180.0f / kPi, 1e-4f);
  EXPECT_EQ(eye.aspect, 1.5f);
  EXPECT_EQ(findCamera(s, "flat").orthographicHeight, 4.0f);
  EXPECT_EQ(findCamera(s, "flat").aspect, 2.0f);
  m.json["cameras"][0]["perspective"]["yfov"] = 4;
  expectRefused(m.gltf(), "cameras[0].perspective.yfov: must be less than pi");
}

TEST_F(Gltf, ReadsPunctualLights) {
  GltfModel m = squareModel();
  m.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 10}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
      {{"type", "directional"}, {"intensity", 3}}};
  m.json["nodes"] = {{{"mesh", 0}}};
  for (int i = 0; i < 3; ++i)
    m.json["nodes"].push_back({{"translation", {i, 2, 0}},
                               {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}},
                               {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  m.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const Scene s = load(m.gltf());
  ASSERT_EQ(s.lights.size(), 3u);
  EXPECT_EQ(s.lights[0].type, kLightPoint);
  EXPECT_EQ(s.lights[0].colour, vec3(10, 5, 0));
  EXPECT_EQ(s.lights[1].type, kLightSpot);
  EXPECT_EQ(s.lights[1].position, vec3(1, 2, 0));
  EXPECT_NEAR(s.lights[1].cosInner, std::cos(0.25f), 1e-6f);
  EXPECT_NEAR(s.lights[1].cosOuter, std::cos(0.5f), 1e-6f);
  EXPECT_NEAR(length(s.lights[1].direction - vec3(0, -1, 0)), 0.0f, 1e-6f);
  EXPECT_EQ(s.lights[2].type, kLightDirectional);
  EXPECT_EQ(s.lights[2].colour, vec3(3));
  m.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 3;
  expectRefused(m.gltf(), "names light 3, but there are only 3");
}

TEST_F(Gltf, ReadsMaterials) {
  GltfModel m = squareModel();
  m.material() = {
      {"name", "everything"},
      {"doubleSided", true},
      {"alphaMode", "MASK"},
      {"alphaCutoff", 0.25},
      {"emissiveFactor", {0.5, 1, 0}},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.6}, {"roughnessFactor", 0.7}}},
      {"extensions",
       {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
        {"KHR_materials_ior", {{"ior", 1.33}}},
        {"KHR_materials_specular", {{"specularFactor", 0.8}, {"specularColorFactor", {0.2, 0.4, 2}}}},
        {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}}}}};
  Scene s = load(m.gltf());
  const NamedMaterial& all = s.materials.at(0);
  EXPECT_EQ(all.name, "everything");
  EXPECT_EQ(all.flags, kMaterialDoubleSided | kMaterialAlphaMask | kMaterialThinWalled);
  EXPECT_EQ(all.baseColour, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(all.alpha, 0.4f);
  EXPECT_EQ(all.alphaCutoff, 0.25f);
  EXPECT_EQ(all.metallic, 0.6f);
  EXPECT_EQ(all.roughness, 0.7f);
  EXPECT_EQ(all.emission, vec3(4, 8, 0));
  EXPECT_EQ(all.ior, 1.33f);
  EXPECT_EQ(all.specular, 0.8f);
  EXPECT_EQ(all.specularColour, vec3(0.2f, 0.4f, 2.0f));
  EXPECT_EQ(all.transmission, 0.9f);
  EXPECT_EQ(all.absorption, vec3(0.0f));
  m.material()["extensions"]["KHR_materials_volume"] = {
      {"thicknessFactor", 0.1}, {"attenuationColor", {1, 0.5, 0.25}}, {"attenuationDistance", 2}};
  const NamedMaterial solid = load(m.gltf()).materials.at(0);
  EXPECT_EQ(solid.flags & kMaterialThinWalled, 0u);
  EXPECT_NEAR(length(transmittanceOver(solid.absorption, 4.0f) - vec3(1.0f, 0.25f, 0.0625f)), 0.0f, 1e-6f);
  m.material()["extensions"]["KHR_materials_volume"]["attenuationDistance"] = 0;
  expectRefused(m.gltf(), "attenuationDistance: must be greater than 0");

  m.material() = nlohmann::json::object();
  s = load(m.gltf());
  EXPECT_EQ(s.materials.at(0).metallic, 1.0f) << "glTF's default";
  EXPECT_EQ(s.materials.at(0).name, "materials[0]");
  m.material()["alphaMode"] = "BLEND";
  EXPECT_EQ(load(m.gltf()).materials.at(0).flags, 0u) << "covers wholly";
  m.material()["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  EXPECT_EQ(load(m.gltf()).materials.at(0).flags, kMaterialAlphaBlend);
  m.material()["extensions"]["KHR_materials_unlit"] = nlohmann::json::object();
  EXPECT_EQ(load(m.gltf()).materials.at(0).flags, kMaterialAlphaBlend | kMaterialUnlit);
  m.primitive().erase("material");
  s = load(m.gltf());
  EXPECT_EQ(s.materials.at(0).baseColour, vec3(0.8f));
}

TEST_F(Gltf, ReadsTexturesFromFilesViewsAndUris) {
  GltfModel m = squareModel();
  std::filesystem::create_directories(folder_ / "a b");
  std::ofstream(folder_ / "a b" / "c.png", std::ios::binary) << onePixelPng(10, 20, 30);
  const std::string png = onePixelPng(40, 50, 60);
  m.add(std::vector<char>(png.begin(), png.end()), 5121, "SCALAR", 1);
  m.json["images"] = {{{"uri", "a%20b/c.png"}},
                      {{"bufferView", m.json["bufferViews"].size() - 1}, {"mimeType", "image/png"}},
                      {{"uri", "data:image/png;base64," + test::base64(onePixelPng(70, 80, 90))}},
                      {{"uri", "not_there.png"}}};
  m.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  m.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}}, {{"source", 2}}, {{"source", 3}}};
  m.material()["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}},
                                          {"metallicRoughnessTexture", {{"index", 1}}}};
  m.material()["emissiveTexture"]["index"] = 2;
  m.material()["emissiveFactor"] = {1, 1, 1};
  m.material()["normalTexture"] = {{"index", 2}, {"scale", -0.5}};
  m.material()["extensions"]["KHR_materials_specular"] = {{"specularTexture", {{"index", 2}}},
                                                          {"specularColorTexture", {{"index", 1}}}};
  Scene s = load(m.gltf());
  const NamedMaterial& paint = s.materials.at(0);
  ASSERT_EQ(s.textures.size(), 5u) << "an image read as colour and as numbers counts twice";
  EXPECT_FALSE(s.textures.at(std::size_t(paint.normalTexture)).srgb);
  EXPECT_EQ(paint.normalScale, -0.5f);
  EXPECT_EQ(paint.specularTexture, paint.normalTexture);
  EXPECT_TRUE(s.textures.at(std::size_t(paint.specularColourTexture)).srgb);
  const Texture& colour = s.textures.at(std::size_t(paint.baseColourTexture));
  EXPECT_EQ(colour.rgba, (LargeVector<std::uint8_t>{10, 20, 30, 255}));
  EXPECT_TRUE(colour.srgb);
  EXPECT_TRUE(colour.nearest);
  EXPECT_EQ(colour.wrapU, Wrap::kClamp);
  EXPECT_EQ(colour.wrapV, Wrap::kMirror);
  const Texture& surface = s.textures.at(std::size_t(paint.metallicRoughnessTexture));
  EXPECT_EQ(surface.rgba[1], 50);
  EXPECT_FALSE(surface.srgb);
  EXPECT_EQ(s.textures.at(std::size_t(paint.emissionTexture)).rgba[2], 90);

  m.json["textures"][0]["source"] = 3;
  expectRefused(m.gltf(), "not_there.png is missing");
  m.json["textures"][0]["source"] = 4;
  expectRefused(m.gltf(), "textures[0].source: names images[4], but there are only 4");
  m.json["textures"][0]["source"] = 1;
  m.json["bufferViews"].back()["byteLength"] = png.size() - 30;
  expectRefused(m.gltf(), "images[1]");
}

TEST_F(Gltf, ReadsVertexColours) {
  GltfModel m = squareModel();
  m.primitive()["attributes"]["COLOR_0"] =
      m.add<std::uint8_t>({255, 0, 51, 255, 0, 0, 0, 102, 1, 2, 3, 4, 5, 6, 7, 8}, 5121, "VEC4", 4);
  m.json["accessors"].back()["normalized"] = true;
  EXPECT_NEAR(length(load(m.gltf()).meshes[0].colours.at(0) - vec4(1.0f, 0.0f, 0.2f, 1.0f)), 0.0f, 1e-6f);
  m.material()["alphaMode"] = "BLEND";
  EXPECT_EQ(load(m.gltf()).materials.at(0).flags, kMaterialAlphaBlend) << "the vertices' alpha is below 1";
  m.primitive()["attributes"]["COLOR_0"] = m.addVec3({0.5, 0.25, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(load(m.gltf()).meshes[0].colours.at(0), vec4(0.5f, 0.25f, 1.0f, 1.0f));
  m.primitive()["attributes"]["COLOR_0"] = m.addVec2({0, 0});
  expectRefused(m.gltf(), "VEC3 is wanted here");
}

TEST_F(Gltf, ReadsTangentsWhereTheyAreNeeded) {
  GltfModel m = squareModel();
  m.primitive()["attributes"]["TANGENT"] =
      m.add<float>({0, 2, 0, -1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 5126, "VEC4", 4);
  EXPECT_TRUE(load(m.gltf()).meshes[0].tangents.empty());
  m.json["images"] = {{{"uri", "data:image/png;base64," + test::base64(onePixelPng(128, 128, 255))}}};
  m.json["textures"] = {{{"source", 0}}};
  m.material()["normalTexture"]["index"] = 0;
  EXPECT_EQ(load(m.gltf()).meshes[0].tangents.at(0), vec4(0, 1, 0, -1));
  // They belong to the coordinates of the file.
  m.material()["normalTexture"]["extensions"]["KHR_texture_transform"]["rotation"] = 1;
  EXPECT_TRUE(load(m.gltf()).meshes[0].tangents.empty());
}

TEST_F(Gltf, WarnsOnceOfMorphTargets) {
  GltfModel m = squareModel();
  m.json["meshes"][0]["primitives"].push_back(m.primitive());
  for (nlohmann::json& primitive : m.json["meshes"][0]["primitives"])
    primitive["targets"] = {{{"POSITION", 0}}};
  load(m.gltf());
  const std::size_t first = warnings_.find("has morph targets; such meshes keep their rest shape");
  ASSERT_NE(first, std::string::npos) << warnings_;
  EXPECT_EQ(warnings_.find("morph", first + 10), std::string::npos) << warnings_;
}

TEST_F(Gltf, BakesTextureTransforms) {
  GltfModel m = squareModel();
  m.json["images"] = {{{"uri", "data:image/png;base64," + test::base64(onePixelPng(1, 2, 3))}}};
  m.json["textures"] = {{{"source", 0}}};
  nlohmann::json& info = m.material()["pbrMetallicRoughness"]["baseColorTexture"];
  info["index"] = 0;
  info["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0.25}}, {"scale", {2, 3}}, {"rotation", kPi / 2}};
  const Scene s = load(m.gltf());
  // uv (1, 0) scales to (2, 0), and a quarter turn counter-clockwise takes it up, to (0, -2).
  EXPECT_NEAR(length(s.meshes[0].uvs[2] - vec2(0.5f, -1.75f)), 0.0f, 1e-5f);
}

TEST_F(Gltf, MirroredNodesKeepTheirFront) {
  GltfModel m = squareModel();
  m.json["nodes"][0]["scale"] = {-1, 1, 1};
  m.material()["emissiveFactor"] = {1, 1, 1};
  const Scene s = load(m.gltf());
  ASSERT_EQ(s.emissiveTriangles.size(), 2u);
  for (const EmissiveTriangle& t : s.emissiveTriangles) EXPECT_GT(cross(t.edge1, t.edge2).z, 0.0f);
}

}  // namespace
}  // namespace isophote

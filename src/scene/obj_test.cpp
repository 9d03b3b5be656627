// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/obj.h"

#include "base/error.h"
#include "scene/obj_geometry.h"
#include "scene/obj_material.h"
#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <chrono>
#include <random>

namespace isophote {
namespace {

using testing::HasSubstr;

class Obj : public testing::Test {
 protected:
  Scene load(const std::string& text) { return loadObj(folder_.write("a.obj", text), log_.job()); }
  std::string loadError(const std::string& text) {
    return errorOf([&] { load(text); });
  }
  void writePng(const std::string& name, int width, std::vector<std::uint8_t> rgba) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(width);
    image.height = png_uint_32(int(rgba.size()) / 4 / width);
    image.format = PNG_FORMAT_RGBA;
    const std::filesystem::path file = folder_.write(name, "");
    ASSERT_NE(png_image_write_to_file(&image, file.c_str(), 0, rgba.data(), 0, nullptr), 0);
  }

  TestFolder folder_;
  WarningLog log_;
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(Obj, ReadsPolygonsWithSharedVertices) {
  const Scene scene = load("# a square\n" + kSquare + "f 1 2 3 4\n");
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "a");
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
  EXPECT_EQ(scene.meshes[0].triangles, (std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(scene.meshes[0].normals.empty());
  EXPECT_TRUE(scene.meshes[0].uvs.empty());
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].worldFromObject, mat4x3(1.0f));
  EXPECT_EQ(scene.materials[0].baseColour, vec3(0.5f));
  EXPECT_EQ(scene.materials[0].specular, 0.0f);
  EXPECT_EQ(scene.materials[0].flags, kMaterialDoubleSided);
}

TEST_F(Obj, CountsNegativeIndicesBackwardsFromTheFace) {
  const Scene scene = load(kSquare + "f -4 -3 -2\nv 5 5 5\nf -1 -3 -2\n");
  EXPECT_EQ(scene.meshes[0].positions[0], vec3(0, 0, 0));
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(scene.meshes[0].positions[scene.meshes[0].triangles[1].x], vec3(5, 5, 5));
  EXPECT_EQ(scene.meshes[0].positions[scene.meshes[0].triangles[1].y], vec3(1, 1, 0));
}

TEST_F(Obj, ReadsEveryFormOfCorner) {
  const std::string lines = kSquare + "vt 0.25 0.75\nvn 0 0 1\n";
  EXPECT_TRUE(load(lines + "f 1 2 3\n").meshes[0].uvs.empty());
  const Scene uv = load(lines + "f 1/1 2/1 3/1\n");
  EXPECT_EQ(uv.meshes[0].uvs.at(0), vec2(0.25f, 0.25f)) << "v grows downwards here and upwards in the file";
  EXPECT_TRUE(uv.meshes[0].normals.empty());
  const Scene normal = load(lines + "f 1//1 2//1 3//-1\n");
  EXPECT_EQ(normal.meshes[0].normals.at(2), vec3(0, 0, 1));
  EXPECT_TRUE(normal.meshes[0].uvs.empty());
  const Scene both = load(lines + "f 1/1/1 2/1/1 3/1/1\n");
  EXPECT_EQ(both.meshes[0].uvs.size(), 3u);
  EXPECT_EQ(both.meshes[0].normals.size(), 3u);
}

TEST_F(Obj, SplitsAVertexWhereNormalsDiffer) {
  const Scene scene = load(kSquare + "vn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1//2 3//1 4//1\n");
  EXPECT_EQ(scene.meshes[0].positions.size(), 5u) << "1//1, 2//1, 3//1, 1//2, 4//1";
}

TEST_F(Obj, KeepsFacesWithAndWithoutNormalsApart) {
  const Scene scene = load(kSquare + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\nf 1//1 2 3//1\n");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].normals.size(), 3u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  EXPECT_TRUE(scene.meshes[1].normals.empty());
  EXPECT_EQ(scene.meshes[1].triangles.size(), 2u);
}

TEST_F(Obj, MakesOneMeshAnObjectAndMaterial) {
  folder_.write("m.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nnewmtl unused\nKd 0 1 0\n");
  const Scene scene = load("mtllib m.mtl\n" + kSquare +
                           "o left\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n"
                           "g right\nf 1 2 4\no left\nusemtl red\nf 2 3 4\no empty\n");
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.meshes[0].name, "left");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u) << "an object may be taken up again";
  EXPECT_EQ(scene.meshes[2].name, "right");
  ASSERT_EQ(scene.materials.size(), 2u) << "unused materials stay out";
  EXPECT_EQ(scene.materials[scene.meshes[0].material].baseColour, vec3(1, 0, 0));
  EXPECT_EQ(scene.materials[scene.meshes[1].material].name, "blue");
  EXPECT_TRUE(log_.warnings.empty());
}

TEST_F(Obj, ReadsWhatOtherProgramsWrite) {
  const Scene scene = load(
      "\xEF\xBB\xBFv 0 0 0 1\r\nv +1 0 0 0.5 0.5 0.5\r\nv 1. .5e0 -0 # corner\r\n"
      "s off\r\nl 1 2\r\nf 1 \\\r\n 2 3");
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions[2], vec3(1.0f, 0.5f, 0.0f));
  EXPECT_TRUE(log_.warnings.empty());
  load(kSquare + "f 1 2 3\nsurf 0 1 0 1 1 2\nsurf 0 1 0 1 1 2\n");
  ASSERT_EQ(log_.warnings.size(), 1u);
  EXPECT_THAT(log_.warnings[0], HasSubstr("line 6: \"surf\" is not supported"));
}

TEST_F(Obj, TakesVerticesBelowTheFace) {
  EXPECT_EQ(load("f 1 2 3\n" + kSquare).meshes[0].positions[1], vec3(1, 0, 0));
}

TEST_F(Obj, NamesLineAndElementOfBadIndices) {
  EXPECT_THAT(loadError(kSquare + "\nf 1 2 5\n"),
              HasSubstr("a.obj: line 6: the face refers to v 5, but the file has 4"));
  EXPECT_THAT(loadError(kSquare + "f 1 2 0\n"), HasSubstr("refers to v 0"));
  EXPECT_THAT(loadError(kSquare + "f 1 2 -5\n"),
              HasSubstr("v -5, but the file has 4 v lines, 4 of them above"));
  EXPECT_THAT(loadError(kSquare + "f 1 2 4294967297\n"), HasSubstr("v 4294967297"));
  EXPECT_THAT(loadError(kSquare + "f 1 2 99999999999999999999999\n"),
              HasSubstr("line 5: the face refers to v 9999"));
  EXPECT_THAT(loadError(kSquare + "f 1 2 -9223372036854775808\n"),
              HasSubstr("line 5: the face refers to v -922"));
  EXPECT_THAT(loadError(kSquare + "f 1/1 2/1 3/1\n"), HasSubstr("vt 1, but the file has 0 vt lines"));
  EXPECT_THAT(loadError(kSquare + "f 1//2 2//1 3//1\n"), HasSubstr("vn 2"));
  EXPECT_THAT(loadError(kSquare + "f 1 2 three\n"), HasSubstr("\"three\" is no index"));
  EXPECT_THAT(loadError(kSquare + "f 1 2 3.5\n"), HasSubstr("\"3.5\" is no index"));
  EXPECT_THAT(loadError(kSquare + "f /1 2 3\n"), HasSubstr("\"\" is no index"));
  EXPECT_THAT(loadError(kSquare + "f 1/1/1/1 2 3\n"), HasSubstr("is no corner"));
  EXPECT_THAT(loadError(kSquare + "f 1 2\n"), HasSubstr("at least 3 corners, not 2"));
}

TEST_F(Obj, NamesLineOfBadNumbers) {
  EXPECT_THAT(loadError("v 0 0 nan\nf 1 1 1\n"),
              HasSubstr("line 1: a coordinate of v must be a finite number, not \"nan\""));
  EXPECT_THAT(loadError("v inf 0 0\nf 1 1 1\n"), HasSubstr("\"inf\""));
  EXPECT_THAT(loadError("v 1e39 0 0\nf 1 1 1\n"), HasSubstr("\"1e39\""));
  EXPECT_THAT(loadError("v 0,5 0 0\nf 1 1 1\n"), HasSubstr("\"0,5\""));
  EXPECT_THAT(loadError("v 0 0\nf 1 1 1\n"), HasSubstr("line 1: a coordinate of v is missing"));
  EXPECT_THAT(loadError("\n\nvn 0 0 x\n"), HasSubstr("line 3: a coordinate of vn"));
  EXPECT_THAT(loadError("vt 0 --1\n"), HasSubstr("second coordinate of vt"));
}

TEST_F(Obj, RefusesFilesWithoutFaces) {
  EXPECT_THAT(loadError(""), HasSubstr("holds no faces"));
  EXPECT_THAT(loadError(kSquare), HasSubstr("holds no faces"));
  EXPECT_THAT(loadError(std::string("\0\x01\x02\xff\n\0", 6)), HasSubstr("is not a text file"));
  EXPECT_THAT(errorOf([&] { loadObj(folder_.path() / "none.obj"); }), HasSubstr("none.obj"));
}

TEST_F(Obj, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  Job job;
  job.stop = stop.get_token();
  const std::filesystem::path file = folder_.write("a.obj", kSquare + "f 1 2 3\n");
  errorOf([&] { loadObj(file, job); }, ErrorKind::kStopped);
}

TEST_F(Obj, KeepsWithinTheMemoryBudget) {
  std::string text = kSquare;
  for (int i = 0; i < 1000; ++i) text += "f 1 2 3 4\n";
  Job job;
  job.memoryBudgetBytes = 30000;
  const std::filesystem::path file = folder_.write("a.obj", text);
  errorOf([&] { loadObj(file, job); }, ErrorKind::kResources);
}

TEST_F(Obj, ShowsGreyWhereMaterialsAreMissing) {
  const Scene scene = load("mtllib none.mtl\n" + kSquare + "usemtl steel\nf 1 2 3\n");
  EXPECT_EQ(scene.materials[0].name, "steel");
  EXPECT_EQ(scene.materials[0].baseColour, vec3(0.5f));
  ASSERT_EQ(log_.warnings.size(), 1u);
  EXPECT_THAT(log_.warnings[0], HasSubstr("\"none.mtl\" is not there"));
  folder_.write("m.mtl", "newmtl iron\nKd 1 0 0\n");
  EXPECT_EQ(load("mtllib m.mtl\n" + kSquare + "usemtl steel\nf 1 2 3\n").materials[0].baseColour, vec3(0.5f));
  ASSERT_EQ(log_.warnings.size(), 2u);
  EXPECT_THAT(log_.warnings[1], HasSubstr("no material file has \"steel\""));
}

TEST_F(Obj, FindsFilesThatMovedFromOtherSystems) {
  writePng("Textures/Wood.PNG", 1, {10, 20, 30, 255});
  folder_.write(
      "My Materials.mtl",
      "newmtl a\nmap_Kd textures\\wood.png\nnewmtl b\nmap_Kd -s 1 1 1 -clamp on C:\\scans\\Leaf one.png\n");
  writePng("leaf one.png", 1, {1, 2, 3, 255});
  const Scene scene = load("mtllib My Materials.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.textures[std::size_t(scene.materials[0].baseColourTexture)].rgba[1], 20);
  EXPECT_EQ(scene.materials[0].baseColour, vec3(1.0f)) << "no Kd beside the map";
  const Texture& leaf = scene.textures[std::size_t(scene.materials[1].baseColourTexture)];
  EXPECT_EQ(leaf.rgba[0], 1);
  EXPECT_EQ(int(leaf.wrapU), int(Wrap::kClamp));
}

TEST_F(Obj, NamesMissingTextures) {
  folder_.write("m.mtl", "newmtl a\nmap_Kd lost.png\n");
  EXPECT_THAT(loadError("mtllib m.mtl\n" + kSquare + "usemtl a\nf 1 2 3\n"),
              HasSubstr("m.mtl: material \"a\": the texture map_Kd lost.png is missing"));
}

TEST_F(Obj, ReadsMapsOfReflectionAndNormals) {
  writePng("grey.png", 4, {0, 0, 0, 255, 128, 128, 128, 255, 255, 255, 255, 255, 128, 128, 128, 255});
  writePng("blue.png", 2, {128, 128, 255, 255, 0, 128, 128, 255});
  folder_.write("m.mtl",
                "newmtl coat\nKs 0.1\nNs 98\nmap_Ks blue.png\nmap_Ns grey.png\nmap_Bump -bm 25 grey.png\n"
                "newmtl normal\nnorm blue.png\nnewmtl disguised\nbump blue.png\n");
  const Scene scene = load("mtllib m.mtl\n" + kSquare +
                           "usemtl coat\nf 1 2 3\nusemtl normal\nf 1 2 3\nusemtl disguised\nf 1 2 3\n");
  const NamedMaterial& coat = scene.materials[0];
  EXPECT_TRUE(scene.textures.at(std::size_t(coat.specularColourTexture)).srgb);
  const Texture& roughness = scene.textures.at(std::size_t(coat.metallicRoughnessTexture));
  EXPECT_EQ(coat.roughness, 1.0f);
  EXPECT_EQ(roughness.rgba[1], 255) << "exponent 0";
  EXPECT_NEAR(roughness.rgba[9], 255.0f * std::sqrt(std::sqrt(0.02f)), 0.51f) << "exponent 98";
  EXPECT_EQ(roughness.rgba[2], 255) << "metallic stays";
  // From black over grey to white: a quarter of the width high, so one texel up over two.
  const Texture& normals = scene.textures.at(std::size_t(coat.normalTexture));
  const float slope = 0.5f;
  EXPECT_NEAR(normals.rgba[4], 127.5f * (1.0f - slope / std::sqrt(1.0f + slope * slope)), 1.0f);
  EXPECT_NEAR(normals.rgba[5], 127.5f, 1.0f);
  EXPECT_NEAR(normals.rgba[8], 127.5f, 1.0f) << "the summit is flat";
  EXPECT_FALSE(normals.srgb);
  for (const std::size_t i : {1u, 2u})
    EXPECT_EQ(scene.textures.at(std::size_t(scene.materials[i].normalTexture)).rgba[2], 255);
}

TEST_F(Obj, CutsHolesWhereMapDIsBlack) {
  writePng("colour.png", 2, {10, 10, 10, 255, 20, 20, 20, 255});
  writePng("holes.png", 2, {0, 0, 0, 255, 255, 255, 255, 255});
  writePng("leaf.png", 2, {10, 10, 10, 0, 20, 20, 20, 200});
  folder_.write("m.mtl",
                "newmtl two\nKd 0 0 0\nmap_Kd colour.png\nmap_d holes.png\n"
                "newmtl one\nmap_Kd leaf.png\nmap_d leaf.png\nnewmtl holes\nKd 1 0 0\nmap_d holes.png\n");
  const Scene scene =
      load("mtllib m.mtl\n" + kSquare + "usemtl two\nf 1 2 3\nusemtl one\nf 1 2 3\nusemtl holes\nf 1 2 3\n");
  const auto texels = [&](std::size_t material) {
    return scene.textures[std::size_t(scene.materials[material].baseColourTexture)].rgba;
  };
  EXPECT_EQ(texels(0), (LargeVector<std::uint8_t>{10, 10, 10, 0, 20, 20, 20, 255}));
  EXPECT_EQ(texels(1), (LargeVector<std::uint8_t>{10, 10, 10, 0, 20, 20, 20, 200}));
  EXPECT_EQ(texels(2), (LargeVector<std::uint8_t>{0, 0, 0, 0, 255, 255, 255, 255}));
  EXPECT_EQ(scene.materials[0].baseColour, vec3(1.0f)) << "Kd 0 beside a map would hide it";
  EXPECT_EQ(scene.materials[2].baseColour, vec3(1, 0, 0));
  for (const NamedMaterial& material : scene.materials) EXPECT_TRUE(material.flags & kMaterialAlphaMask);
}

/// Damaged text gives a mesh or an Error, and never an index out of range.
TEST(ObjDamage, IsFoundOrHarmless) {
  const std::string good = kSquare +
                           "vt 0 1\nvn 0 0 1\no a\nusemtl m\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -1 -2 -3\ng b \\\n "
                           "c\nf 1//1 2//1 3//1\n";
  const std::string mtl =
      "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd -s 1 1 -clamp on a b.png\nd -halo 0.5\nillum 2\nTf 1\n";
  std::mt19937 random(7);
  int errors = 0;
  const auto damaged = [&](std::string text) {
    for (int changes = int(random() % 4) + 1; changes > 0; --changes) {
      const std::size_t at = random() % text.size();
      if (random() % 8 == 0) {
        text.resize(at + 1);
      } else {
        constexpr std::string_view kLetters = "0123456789-+./ \n\r\\#efvtn\xff";
        text[at] = random() % 4 == 0 ? char(random() % 256) : kLetters[random() % kLetters.size()];
      }
    }
    return text;
  };
  for (int i = 0; i < 20000; ++i) {
    try {
      const ObjGeometry geometry = parseObj(damaged(good), "a.obj", "a");
      for (const ObjGroup& group : geometry.groups) {
        const Mesh mesh = buildObjMesh(geometry, group);
        for (const uvec3& t : mesh.triangles) ASSERT_LT(max(t.x, max(t.y, t.z)), mesh.positions.size());
      }
      for (const MtlMaterial& material : parseMtl(damaged(mtl), "m.mtl")) materialFromMtl(material);
    } catch (const Error& error) {
      ++errors;
      ASSERT_EQ(int(error.kind()), int(ErrorKind::kBadInput)) << error.what();
    }
  }
  EXPECT_GT(errors, 5000);
  EXPECT_LT(errors, 19000);
}

struct PublicObj {
  const char* file;
  std::size_t triangles;
};

TEST(ObjPublicScenes, HaveTheTrianglesThatTheirTableSays) {
  const std::filesystem::path folder = publicScenes();
  if (folder.empty()) GTEST_SKIP() << "the public test scenes are not on this machine (ISOPHOTE_ASSETS)";
  constexpr PublicObj kFiles[] = {{"sponza-dabrovic/sponza.obj", 66445},
                                  {"sibenik/sibenik.obj", 75284},
                                  {"conference/conference.obj", 331179},
                                  {"cornell-mcguire/CornellBox-Original.obj", 36},
                                  {"cornell-mcguire/CornellBox-Mirror.obj", 36},
                                  {"cornell-mcguire/CornellBox-Sphere.obj", 2188},
                                  {"cornell-mcguire/CornellBox-Water.obj", 7088},
                                  {"cornell-mcguire/water.obj", 4900},
                                  {"cornell-mcguire/CornellBox-Glossy.obj", 1112},
                                  {"cornell-mcguire/CornellBox-Glossy-Floor.obj", 1112},
                                  {"cornell-mcguire/CornellBox-Empty-CO.obj", 12},
                                  {"cornell-mcguire/CornellBox-Empty-RG.obj", 12},
                                  {"cornell-mcguire/CornellBox-Empty-White.obj", 12},
                                  {"mnrt/MNSimple.obj", 28},
                                  {"mnrt/MNRoom.obj", 452},
                                  {"mnrt/MNCardioid.obj", 130},
                                  {"mnrt/MNRing.obj", 6146},
                                  {"caustics-torus/caustics.obj", 18893},
                                  {"caustics-torus/torus.obj", 23614},
                                  {"bunny/bunny.obj", 69451},
                                  {"dragon/dragon_202k.obj", 202520},
                                  {"dragon/dragon_47k.obj", 47794},
                                  {"armadillo/armadillo.obj", 99976},
                                  {"common-models/spot.obj", 5856},
                                  {"common-models/teapot.obj", 6320},
                                  {"common-models/suzanne.obj", 968}};
  for (const PublicObj& expected : kFiles) {
    const auto start = std::chrono::steady_clock::now();
    const Scene scene = loadObj(folder / expected.file);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    EXPECT_EQ(triangles, expected.triangles) << expected.file;
    RecordProperty(expected.file, std::to_string(seconds.count()));
    EXPECT_EQ(scene.meshes.size(), scene.instances.size());
  }
}

TEST(ObjPublicScenes, CornellLampsShineDown) {
  const std::filesystem::path folder = publicScenes();
  if (folder.empty()) GTEST_SKIP() << "the public test scenes are not on this machine (ISOPHOTE_ASSETS)";
  for (const char* name :
       {"Original", "Mirror", "Sphere", "Water", "Empty-CO", "Empty-RG", "Empty-White", "Empty-Squashed"}) {
    const Scene scene = loadObj(folder / fmt::format("cornell-mcguire/CornellBox-{}.obj", name));
    int lamps = 0;
    for (const Mesh& mesh : scene.meshes) {
      if (scene.materials[mesh.material].emission == vec3(0.0f)) continue;
      ++lamps;
      EXPECT_EQ(scene.materials[mesh.material].flags & kMaterialDoubleSided, 0u);
      for (const uvec3& t : mesh.triangles) {
        const vec3 a = mesh.positions[t.x];
        EXPECT_LT(cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a).y, 0.0f) << name;
      }
    }
    EXPECT_EQ(lamps, 1) << name;
  }
}

}  // namespace
}  // namespace isophote

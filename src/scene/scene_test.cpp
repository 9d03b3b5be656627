// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.h"

#include "base/error.h"
#include "scene/light_power.h"
#include "scene/mesh_emission.h"
#include "scene/texture_sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace isophote {
namespace {

/// One triangle in the plane z = 0 with its front towards +z and area 0.5, placed once.
Scene triangleScene() {
  Scene scene;
  scene.materials.push_back({makeMaterial(), "grey"});
  scene.meshes.push_back({.name = "triangle",
                          .positions = {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)},
                          .normals = {},
                          .uvs = {},
                          .triangles = {uvec3(0, 1, 2)}});
  scene.instances.push_back({.name = "placed"});
  return scene;
}

/// A cube around the origin of half size 1; its fronts look out, or in where `inwards`.
Scene boxScene(bool inwards) {
  Scene scene = triangleScene();
  Mesh& mesh = scene.meshes[0];
  mesh.positions.clear();
  mesh.triangles.clear();
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = uint(mesh.positions.size());
      for (const vec2 corner : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)}) {
        vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = corner.x;
        p[(axis + 2) % 3] = corner.y;
        mesh.positions.push_back(p);
      }
      const uvec3 quad[2] = {uvec3(0, 1, 2) + first, uvec3(0, 2, 3) + first};
      for (const uvec3& t : quad)
        mesh.triangles.push_back((side > 0.0f) != inwards ? t : uvec3(t.x, t.z, t.y));
    }
  }
  return scene;
}

std::string errorOf(Scene scene) {
  try {
    finishScene(scene, "test.gltf");
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadInput);
    return e.what();
  }
  return "";
}

void expectError(const Scene& scene, const std::string& part) {
  const std::string what = errorOf(scene);
  EXPECT_NE(what.find(part), std::string::npos) << what;
  EXPECT_EQ(what.rfind("test.gltf: ", 0), 0u) << what;
  EXPECT_EQ(what.find('\n'), std::string::npos) << what;
}

TEST(FinishScene, RefusesBadNumbersAndIndicesByName) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Scene s = triangleScene();
  s.meshes[0].positions[2].y = nan;
  expectError(s, "mesh 0 \"triangle\", vertex 2");
  s = triangleScene();
  s.meshes[0].positions[1].x = 1e16f;
  expectError(s, "too far");
  s = triangleScene();
  s.meshes[0].triangles[0].y = 3;
  expectError(s, "triangle 0 names vertex 3, but there are only 3");
  s = triangleScene();
  s.meshes[0].material = 7;
  expectError(s, "material 7");
  s = triangleScene();
  s.meshes[0].normals.resize(2);
  expectError(s, "2 normals for 3 positions");
  s = triangleScene();
  s.meshes[0].uvs = {vec2(0), vec2(nan, 0), vec2(0)};
  expectError(s, "vertex 1: the texture coordinate");
  s = triangleScene();
  s.materials[0].emissionTexture = 0;
  expectError(s, "material 0 \"grey\" names texture 0");
  s = triangleScene();
  s.materials[0].ior = 0;
  expectError(s, "index of refraction 0");
  s = triangleScene();
  s.instances[0].mesh = 4;
  expectError(s, "instance 0 \"placed\" names mesh 4");
  s = triangleScene();
  s.instances[0].worldFromObject[3].x = nan;
  expectError(s, "instance 0 \"placed\" has a transform");
  s = triangleScene();
  s.textures.push_back({.name = "t", .width = 2, .height = 2, .rgba = LargeVector<std::uint8_t>(15)});
  expectError(s, "texture 0 \"t\" holds 15 bytes");
}

TEST(FinishScene, RefusesBadLightsAndCameras) {
  Light light{};
  light.type = kLightPoint;
  light.colour = vec3(1, -1, 1);
  Scene s = triangleScene();
  s.lights = {light};
  expectError(s, "light 0 has strength -1");
  light.colour = vec3(1);
  light.type = kLightDirectional;
  s.lights = {light};
  expectError(s, "light 0 has direction (0, 0, 0)");
  light.type = kLightRectangle;
  s.lights = {light};
  expectError(s, "light 0 has no area");
  light.type = kLightSpot;
  light.direction = vec3(0, -1, 0);
  light.cosInner = 0.5f;
  light.cosOuter = 0.7f;
  s.lights = {light};
  expectError(s, "cone angles");
  s = triangleScene();
  s.cameras.push_back({.name = "c", .eye = vec3(1), .target = vec3(1)});
  expectError(s, "camera \"c\" has eye and target at the same point");
}

TEST(FinishScene, RefusesASceneWithoutTriangles) {
  Scene s = triangleScene();
  s.instances.clear();
  expectError(s, "no triangles");
}

TEST(FinishScene, GivesZeroNormalsThatOfTheirTriangles) {
  Scene s = triangleScene();
  s.meshes[0].normals = {vec3(0), vec3(0, 0, 5), vec3(3, 0, 4)};
  finishScene(s, "test.gltf");
  EXPECT_EQ(s.meshes[0].normals[0], vec3(0, 0, 1));
  EXPECT_EQ(s.meshes[0].normals[1], vec3(0, 0, 1));
  EXPECT_NEAR(length(s.meshes[0].normals[2] - vec3(0.6f, 0, 0.8f)), 0.0f, 1e-6f);
}

TEST(FinishScene, MirroredInstancesKeepTheirFront) {
  Scene s = triangleScene();
  s.materials[0].emission = vec3(1);
  s.instances[0].worldFromObject[0].x = -1.0f;
  s.instances.push_back(s.instances[0]);
  finishScene(s, "test.gltf");
  ASSERT_EQ(s.meshes.size(), 2u) << "the mirrored mesh is shared";
  ASSERT_EQ(s.emissiveTriangles.size(), 2u);
  EXPECT_GT(glm::determinant(mat3(s.instances[0].worldFromObject)), 0.0f);
  const EmissiveTriangle& t = s.emissiveTriangles[0];
  EXPECT_EQ(normalize(cross(t.edge1, t.edge2)), vec3(0, 0, 1));
  EXPECT_EQ(s.bounds.lower, vec3(-1, 0, 0));
  EXPECT_EQ(s.bounds.upper, vec3(0, 1, 0));
}

TEST(FinishScene, LeavesOutFlatInstancesWithAWarning) {
  Scene s = triangleScene();
  s.instances.push_back(s.instances[0]);
  s.instances[1].worldFromObject = mat4x3(0.0f);
  int warnings = 0;
  Job job;
  job.log = [&](LogLevel, std::string_view message) {
    warnings += message.find("scaled flat") != std::string_view::npos ? 1 : 0;
  };
  finishScene(s, "test.gltf", job);
  EXPECT_EQ(s.instances.size(), 1u);
  EXPECT_EQ(warnings, 1);
}

TEST(FinishScene, MakesMeshLightsOfEmissiveInstances) {
  Scene s = triangleScene();
  Mesh& mesh = s.meshes[0];
  mesh.positions.push_back(vec3(4, 0, 0));
  mesh.triangles = {uvec3(0, 1, 2), uvec3(0, 0, 1), uvec3(1, 3, 2)};  // areas 0.5, 0 and 1.5
  s.materials[0].emission = vec3(1, 2, 3);
  s.instances.push_back(s.instances[0]);
  for (int column = 0; column < 3; ++column) s.instances[1].worldFromObject[column] *= 2.0f;
  finishScene(s, "test.gltf");
  ASSERT_EQ(s.lights.size(), 2u);
  ASSERT_EQ(s.emissiveTriangles.size(), 4u) << "triangles without area emit nothing";
  EXPECT_EQ(s.lights[1].type, kLightMesh);
  EXPECT_EQ(s.lights[1].firstTriangle, 2u);
  EXPECT_NEAR(s.lights[0].power, kPi * 2.0f * 2.0f, 1e-5f);
  EXPECT_NEAR(s.lights[1].area, 8.0f, 1e-5f);
  EXPECT_NEAR(s.lights[1].power, 4.0f * s.lights[0].power, 1e-4f);
  EXPECT_NEAR(s.emissiveTriangles[0].probability, 0.25f, 1e-6f);
  EXPECT_NEAR(s.emissiveTriangles[1].probability, 0.75f, 1e-6f);
  EXPECT_EQ(s.emissiveAliases.size(), 4u);
  EXPECT_EQ(s.emissiveTriangles[3].triangle, 2u);

  s.materials[0].flags |= kMaterialDoubleSided;
  finishScene(s, "test.gltf");
  ASSERT_EQ(s.lights.size(), 2u) << "finishing again replaces mesh lights";
  EXPECT_NEAR(s.lights[0].power, kPi * 2.0f * 2.0f * 2.0f, 1e-4f);
}

TEST(FinishScene, AveragesTheEmissionTextureOverEachTriangle) {
  Scene s = triangleScene();
  // The left half of the texture is dark.
  s.textures.push_back({.name = "t", .width = 2, .height = 1, .rgba = {0, 0, 0, 255, 255, 255, 255, 255}});
  s.textures[0].wrapU = s.textures[0].wrapV = Wrap::kClamp;
  s.textures[0].nearest = true;
  s.materials[0].emission = vec3(1, 2, 3);
  s.materials[0].emissionTexture = 0;
  Mesh& mesh = s.meshes[0];
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {3, 0, 0},
                    {2, 1, 0}, {4, 0, 0}, {5, 0, 0}, {4, 1, 0}};
  mesh.normals.clear();
  mesh.triangles = {uvec3(0, 1, 2), uvec3(3, 4, 5), uvec3(6, 7, 8)};
  mesh.uvs = {{0.1f, 0.5f}, {0.2f, 0.5f}, {0.1f, 0.6f},   // on the dark half
              {0.6f, 0.5f}, {0.9f, 0.5f}, {0.6f, 0.6f},   // on the bright one
              {0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}};  // three quarters of it on the bright one
  finishScene(s, "test.gltf");
  ASSERT_EQ(s.emissiveTriangles.size(), 3u);
  EXPECT_EQ(s.emissiveTriangles[0].radiance, vec3(0.0f));
  EXPECT_EQ(s.emissiveTriangles[0].probability, 0.0f);
  EXPECT_EQ(s.emissiveTriangles[1].radiance, vec3(1, 2, 3));
  EXPECT_GT(s.emissiveTriangles[1].probability, s.emissiveTriangles[2].probability);
  EXPECT_GT(s.emissiveTriangles[2].probability, 0.3f);
  for (int i = 0; i < 1000; ++i)
    ASSERT_NE(chooseTriangle(s, s.lights[0], (float(i) + 0.5f) / 1000.0f).triangle, 0u);
  s.materials[0].emission = vec3(0.0f, 0.0f, 0.0f);
  s.lights.push_back({});
  finishScene(s, "test.gltf");
  EXPECT_TRUE(s.emissiveTriangles.empty());
}

TEST(FinishScene, RefusesEnvironmentMapsThatCannotBe) {
  Scene s = triangleScene();
  Light light{};
  light.type = kLightEnvironment;
  light.mapped = 1u;
  light.edgeU = vec3(1, 0, 0);
  light.edgeV = vec3(0, 1, 0);
  s.lights.push_back(light);
  EXPECT_NE(errorOf(s).find("environment map is 0 x 0 pixels"), std::string::npos);
  s.environment.radiance = Image(2, 1, vec3(1.0f));
  EXPECT_EQ(errorOf(s), "");
  s.environment.radiance.pixels[1].y = -1.0f;
  EXPECT_NE(errorOf(s).find("texel that is negative"), std::string::npos);
  s.environment.radiance.pixels[1].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(errorOf(s).find("texel that is negative"), std::string::npos);
  s.environment.radiance.pixels[1].y = 1.0f;
  s.lights[0].edgeV = vec3(1, 1, 0);
  EXPECT_NE(errorOf(s).find("perpendicular and unit"), std::string::npos);
  s.lights[0].edgeV = vec3(0, 1, 0);
  s.lights.push_back(s.lights[0]);
  EXPECT_NE(errorOf(s).find("2 environment lights have a map"), std::string::npos);
}

TEST(FinishScene, HolesOfAMaskDoNotEmit) {
  Scene s = triangleScene();
  s.textures.push_back({.name = "t", .width = 1, .height = 1, .rgba = {255, 255, 255, 0}});
  s.materials[0].emission = vec3(1);
  s.materials[0].baseColourTexture = 0;
  s.materials[0].flags |= kMaterialAlphaMask;
  s.materials[0].alphaCutoff = 0.5f;
  s.meshes[0].uvs = {{0, 0}, {1, 0}, {0, 1}};
  s.lights.push_back({});
  finishScene(s, "test.gltf");
  EXPECT_TRUE(s.emissiveTriangles.empty());
  s.textures[0].rgba[3] = 255;
  finishScene(s, "test.gltf");
  EXPECT_EQ(s.emissiveTriangles.size(), 1u);
}

TEST(AliasTable, ChoosesByProbability) {
  Scene scene;
  Light light{};
  for (const std::vector<float>& parts :
       {std::vector<float>{1.0f}, {0.25f, 0.75f}, {0.0f, 0.5f, 0.0f, 0.5f}, {0.1f, 0.2f, 0.3f, 0.4f, 0.0f}}) {
    scene.emissiveAliases = aliasTable(parts);
    light.triangleCount = std::uint32_t(parts.size());
    scene.emissiveTriangles.assign(parts.size(), {});
    for (std::uint32_t i = 0; i < parts.size(); ++i) scene.emissiveTriangles[i].triangle = i;
    constexpr int kSteps = 100'000;
    std::vector<int> count(parts.size());
    for (int i = 0; i < kSteps; ++i)
      ++count[chooseTriangle(scene, light, (float(i) + 0.5f) / float(kSteps)).triangle];
    for (std::size_t i = 0; i < parts.size(); ++i)
      EXPECT_NEAR(double(count[i]) / kSteps, double(parts[i]), 1e-4) << parts.size() << " parts, " << i;
  }
}

TEST(LightPower, OfEachType) {
  Bounds unitBox;
  unitBox.extend(vec3(0));
  unitBox.extend(vec3(1));
  Light light{};
  light.colour = vec3(1, 2, 3);
  light.type = kLightPoint;
  EXPECT_NEAR(lightPower(light, unitBox), 8.0f * kPi, 1e-4f);
  light.type = kLightRectangle;
  light.area = 3.0f;
  EXPECT_NEAR(lightPower(light, unitBox), 6.0f * kPi, 1e-4f);
  light.type = kLightDirectional;
  light.direction = vec3(0, -1, 0);
  EXPECT_NEAR(lightPower(light, unitBox), 2.0f, 1e-5f);
  light.direction = normalize(vec3(1, -1, 0));
  EXPECT_NEAR(lightPower(light, unitBox), 2.0f * std::sqrt(2.0f), 1e-5f) << "two faces are seen";
  light.type = kLightEnvironment;  // pi L over the surface of the box
  EXPECT_NEAR(lightPower(light, unitBox), 2.0f * kPi * 6.0f, 1e-4f);

  light.type = kLightSpot;
  light.cosInner = 0.9f;
  light.cosOuter = 0.4f;
  double sum = 0;
  constexpr int kSteps = 100000;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = -1.0 + 2.0 * (i + 0.5) / kSteps;
    const double t = std::clamp((cosine - 0.4) / 0.5, 0.0, 1.0);
    sum += t * t * 2.0 / kSteps;
  }
  EXPECT_NEAR(lightPower(light, unitBox), 2.0 * 2.0 * 3.14159265 * sum, 1e-3);
}

TEST(Defaults, AnObjectIsSeenFromOutside) {
  Scene s = boxScene(false);
  finishScene(s, "test.gltf");
  ASSERT_EQ(s.cameras.size(), 1u);
  const CameraRays rays = cameraRays(s.cameras[0], 400, 300);
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 p(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const vec3 offset = p - rays.eye;
    const float depth = dot(offset, rays.forward);
    EXPECT_GT(depth, 0.0f);
    EXPECT_LT(abs(dot(offset, rays.right)) / dot(rays.right, rays.right), depth);
    EXPECT_LT(abs(dot(offset, rays.up)) / dot(rays.up, rays.up), depth);
  }
  ASSERT_EQ(s.lights.size(), 2u);
  EXPECT_EQ(s.lights[0].type, kLightDirectional);
  EXPECT_GT(s.lights[0].power, 0.0f);
}

TEST(Defaults, ARoomIsSeenFromInside) {
  Scene s = boxScene(true);
  finishScene(s, "test.gltf");
  const vec3 eye = s.cameras.at(0).eye;
  EXPECT_LT(max(abs(eye.x), max(abs(eye.y), abs(eye.z))), 1.0f);
  ASSERT_EQ(s.lights.size(), 1u);
  EXPECT_EQ(s.lights[0].type, kLightPoint);
  EXPECT_LT(s.lights[0].position.y, 1.0f);
}

/// A statue from an OBJ file, whose surfaces all are double-sided, is no room.
TEST(Defaults, DoubleSidedSurfacesDoNotMakeARoom) {
  for (const bool inwards : {false, true}) {
    Scene s = boxScene(inwards);
    s.materials[0].flags |= kMaterialDoubleSided;
    finishScene(s, "test.obj");
    EXPECT_EQ(length(s.cameras.at(0).eye) < 1.0f, inwards);
    EXPECT_EQ(s.lights.at(0).type, inwards ? kLightPoint : kLightDirectional);
  }
}

/// The three sides that are seen are lit, each differently, and white ones stay in range.
TEST(Defaults, AnObjectIsLitAllAround) {
  Scene s = boxScene(false);
  finishScene(s, "test.gltf");
  const auto radiance = [&](vec3 normal) {
    return s.lights[0].colour.x * std::max(-dot(s.lights[0].direction, normal), 0.0f) / kPi +
           s.lights[1].colour.x;
  };
  const float side = radiance({1, 0, 0}), front = radiance({0, 0, 1}), top = radiance({0, 1, 0});
  EXPECT_GT(side, 1.3f * s.lights[1].colour.x) << "the sky is seen behind";
  EXPECT_GT(front, 1.3f * side);
  EXPECT_GT(top, 1.3f * front);
  EXPECT_LT(top, 1.0f);
}

TEST(Defaults, AStageIsSeenThroughItsOpenSide) {
  Scene s = boxScene(true);
  // The last quad is that at z = 1.
  s.meshes[0].triangles.resize(10);
  finishScene(s, "test.gltf");
  const Camera& camera = s.cameras.at(0);
  EXPECT_GT(camera.eye.z, 1.0f);
  EXPECT_EQ(camera.eye.x, 0.0f);
  EXPECT_EQ(camera.target, vec3(0));
}

TEST(Camera, FindsByNameAndListsNames) {
  Scene s = triangleScene();
  s.cameras.push_back({.name = "left"});
  s.cameras.push_back({.name = "right"});
  EXPECT_EQ(findCamera(s, "").name, "left");
  EXPECT_EQ(findCamera(s, "right").name, "right");
  try {
    findCamera(s, "top");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadUsage);
    EXPECT_NE(std::string(e.what()).find("\"left\", \"right\""), std::string::npos) << e.what();
  }
}

TEST(Camera, RaysSpanTheFieldOfView) {
  Camera camera{.name = "c", .eye = vec3(1, 2, 3), .target = vec3(1, 2, -7), .verticalFovDegrees = 90};
  CameraRays rays = cameraRays(camera, 200, 100);
  EXPECT_NEAR(length(rays.forward - vec3(0, 0, -1)), 0.0f, 1e-6f);
  EXPECT_NEAR(length(rays.up - vec3(0, 1, 0)), 0.0f, 1e-6f);
  EXPECT_NEAR(length(rays.right - vec3(2, 0, 0)), 0.0f, 1e-6f);
  camera.orthographicHeight = 4;
  rays = cameraRays(camera, 200, 100);
  EXPECT_EQ(rays.orthographic, 1.0f);
  EXPECT_NEAR(length(rays.right), 4.0f, 1e-6f);
  EXPECT_NEAR(length(rays.up), 2.0f, 1e-6f);
  camera.target = vec3(1, -5, 3);  // straight down, along `up`
  rays = cameraRays(camera, 100, 100);
  EXPECT_NEAR(dot(rays.right, rays.forward), 0.0f, 1e-6f);
  EXPECT_NEAR(length(rays.right), 2.0f, 1e-6f);
}

TEST(TextureSample, DecodesSrgbExactly) {
  for (std::uint32_t i = 0; i < 256; ++i) {
    const double c = double(i) / 255.0;
    EXPECT_NEAR(linearFrom8(i, true), c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4), 1e-7);
  }
}

TEST(TextureSample, FiltersAndWraps) {
  Texture t{.name = "", .width = 2, .height = 1, .rgba = {0, 0, 0, 255, 255, 255, 255, 0}, .srgb = false};
  EXPECT_NEAR(sampleTexture(t, vec2(0.25f, 0.5f)).x, 0.0f, 1e-6f);
  EXPECT_NEAR(sampleTexture(t, vec2(0.75f, 0.5f)).x, 1.0f, 1e-6f);
  EXPECT_NEAR(sampleTexture(t, vec2(0.5f, 0.1f)).x, 0.5f, 1e-6f);
  EXPECT_NEAR(sampleTexture(t, vec2(0.5f, 0.1f)).w, 0.5f, 1e-6f);
  EXPECT_NEAR(sampleTexture(t, vec2(0.0f, 0.5f)).x, 0.5f, 1e-6f) << "repeat blends with the far end";
  EXPECT_NEAR(sampleTexture(t, vec2(-2.25f, 7.5f)).x, 1.0f, 1e-6f);
  t.wrapU = Wrap::kClamp;
  EXPECT_NEAR(sampleTexture(t, vec2(0.0f, 0.5f)).x, 0.0f, 1e-6f);
  EXPECT_NEAR(sampleTexture(t, vec2(9.0f, 0.5f)).x, 1.0f, 1e-6f);
  t.wrapU = Wrap::kMirror;
  EXPECT_NEAR(sampleTexture(t, vec2(1.25f, 0.5f)).x, 1.0f, 1e-6f);
  EXPECT_NEAR(sampleTexture(t, vec2(1.75f, 0.5f)).x, 0.0f, 1e-6f);
  EXPECT_NEAR(sampleTexture(t, vec2(-0.25f, 0.5f)).x, 0.0f, 1e-6f);
  t.nearest = true;
  EXPECT_EQ(sampleTexture(t, vec2(0.49f, 0.5f)).x, 0.0f);
  EXPECT_EQ(sampleTexture(t, vec2(0.51f, 0.5f)).x, 1.0f);
}

TEST(TextureSample, SurvivesAnyNumber) {
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror}) {
    const Texture t{.name = "",
                    .width = 3,
                    .height = 2,
                    .rgba = LargeVector<std::uint8_t>(24, 255),
                    .wrapU = wrap,
                    .wrapV = wrap};
    for (const float u : {1e30f, -1e30f, 1.0f, 0.99999994f, -1e-9f, std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN()})
      EXPECT_NEAR(sampleTexture(t, vec2(u, -u)).x, 1.0f, 1e-6f) << u;
  }
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/builtin.h"

#include "scene/builtin/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

namespace isophote {
namespace {

vec3 geometricNormal(const Mesh& mesh, uvec3 triangle) {
  const vec3 a = mesh.positions[triangle.x];
  return cross(mesh.positions[triangle.y] - a, mesh.positions[triangle.z] - a);
}

/// Triangles of all instances.
std::size_t worldTriangles(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) count += scene.meshes[instance.mesh].triangles.size();
  return count;
}

/// Half-edges, by the bits of their end points, that no half-edge of the opposite direction answers. None:
/// the meshes together are closed, with one side out everywhere.
std::size_t openEdges(std::span<const Mesh> meshes) {
  using Point = std::tuple<float, float, float>;
  std::map<std::pair<Point, Point>, int> balance;
  for (const Mesh& mesh : meshes) {
    const auto point = [&](uint index) {
      const vec3 p = mesh.positions[index];
      return Point(p.x, p.y, p.z);
    };
    for (const uvec3 t : mesh.triangles) {
      for (const auto& [from, to] : {std::pair(t.x, t.y), std::pair(t.y, t.z), std::pair(t.z, t.x)}) {
        ++balance[{point(from), point(to)}];
        --balance[{point(to), point(from)}];
      }
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : balance) open += count > 0 ? std::size_t(count) : 0;
  return open;
}

/// Volume that a closed mesh encloses; negative when it is inside out.
float enclosedVolume(const Mesh& mesh) {
  double volume = 0;
  for (const uvec3 t : mesh.triangles) {
    volume += dot(mesh.positions[t.x], cross(mesh.positions[t.y], mesh.positions[t.z])) / 6.0;
  }
  return float(volume);
}

class Builtin : public testing::TestWithParam<const BuiltinScene*> {
 protected:
  const Scene scene_ = GetParam()->make();
};

TEST_P(Builtin, HasWhatARenderNeeds) {
  EXPECT_EQ(scene_.name, GetParam()->name);
  EXPECT_FALSE(GetParam()->description.empty());
  EXPECT_FALSE(scene_.cameras.empty());
  bool emits = !scene_.lights.empty();
  for (const NamedMaterial& material : scene_.materials) emits |= length(material.emission) > 0.0f;
  EXPECT_TRUE(emits);
}

TEST_P(Builtin, IndicesAreInRange) {
  for (const Instance& instance : scene_.instances) ASSERT_LT(instance.mesh, scene_.meshes.size());
  for (const NamedMaterial& material : scene_.materials) {
    ASSERT_LT(material.baseColourTexture, int(scene_.textures.size())) << material.name;
  }
  for (const Mesh& mesh : scene_.meshes) {
    ASSERT_LT(mesh.material, scene_.materials.size()) << mesh.name;
    ASSERT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size()) << mesh.name;
    ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size()) << mesh.name;
    for (const uvec3 t : mesh.triangles)
      ASSERT_LT(max(t.x, max(t.y, t.z)), mesh.positions.size()) << mesh.name;
  }
}

TEST_P(Builtin, EveryTriangleHasAreaAndFacesItsNormals) {
  for (const Mesh& mesh : scene_.meshes) {
    EXPECT_FALSE(mesh.triangles.empty()) << mesh.name;
    for (const uvec3 t : mesh.triangles) {
      const vec3 geometric = geometricNormal(mesh, t);
      ASSERT_GT(length(geometric), 1e-10f) << mesh.name;
      if (mesh.normals.empty()) continue;
      for (const uint corner : {t.x, t.y, t.z}) {
        ASSERT_NEAR(length(mesh.normals[corner]), 1.0f, 1e-5f) << mesh.name;
        ASSERT_GT(dot(mesh.normals[corner], geometric), 0.0f) << mesh.name;
      }
    }
  }
}

TEST_P(Builtin, KeepsAlbedosPhysical) {
  constexpr float kBrightest = 0.8f;
  constexpr int kBrightestCode = 231;  // of 0.8 in sRGB
  for (const NamedMaterial& material : scene_.materials) {
    const bool lambertian = material.metallic == 0.0f && material.transmission == 0.0f;
    if (!lambertian) continue;
    EXPECT_EQ(material.specular, 0.0f) << material.name;
    if (material.baseColourTexture < 0) {
      const vec3 albedo = material.baseColour;
      EXPECT_LE(max(albedo.x, max(albedo.y, albedo.z)), kBrightest) << material.name;
      continue;
    }
    const Texture& texture = scene_.textures[std::size_t(material.baseColourTexture)];
    ASSERT_EQ(texture.rgba.size(), std::size_t(texture.width) * std::size_t(texture.height) * 4);
    int brightest = 0;
    for (std::size_t i = 0; i < texture.rgba.size(); ++i) {
      if (i % 4 != 3) brightest = std::max(brightest, int(texture.rgba[i]));
    }
    EXPECT_LE(brightest, kBrightestCode) << texture.name;
  }
}

TEST_P(Builtin, FinishesWithoutAWarning) {
  Scene finished = scene_;
  std::string warnings;
  Job job;
  job.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::kWarning) warnings += message;
  };
  finishScene(finished, scene_.name, job);
  EXPECT_EQ(warnings, "");
  EXPECT_FALSE(finished.bounds.empty());
  ASSERT_FALSE(finished.lights.empty());
  for (const Light& light : finished.lights) EXPECT_GT(light.power, 0.0f);
}

TEST_P(Builtin, IsTheSameEveryTime) {
  const Scene again = GetParam()->make();
  ASSERT_EQ(again.meshes.size(), scene_.meshes.size());
  for (std::size_t i = 0; i < again.meshes.size(); ++i) {
    EXPECT_TRUE(again.meshes[i].positions == scene_.meshes[i].positions) << again.meshes[i].name;
    EXPECT_TRUE(again.meshes[i].normals == scene_.meshes[i].normals) << again.meshes[i].name;
    EXPECT_TRUE(again.meshes[i].uvs == scene_.meshes[i].uvs) << again.meshes[i].name;
    EXPECT_TRUE(again.meshes[i].triangles == scene_.meshes[i].triangles) << again.meshes[i].name;
  }
  ASSERT_EQ(again.textures.size(), scene_.textures.size());
  for (std::size_t i = 0; i < again.textures.size(); ++i)
    EXPECT_TRUE(again.textures[i].rgba == scene_.textures[i].rgba) << again.textures[i].name;
}

std::vector<const BuiltinScene*> allScenes() {
  std::vector<const BuiltinScene*> scenes;
  for (const BuiltinScene& scene : builtinScenes()) scenes.push_back(&scene);
  return scenes;
}

INSTANTIATE_TEST_SUITE_P(All, Builtin, testing::ValuesIn(allScenes()), [](const auto& which) {
  std::string name(which.param->name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(BuiltinList, FindsByName) {
  const BuiltinScene* found = findBuiltinScene("cornell-box");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->name, "cornell-box");
  EXPECT_EQ(findBuiltinScene("cornell"), nullptr);
}

TEST(BuiltinCornellBox, CameraEndsAtTheOpening) {
  const Camera camera = findBuiltinScene("cornell-box")->make().cameras.front();
  const float distance = camera.eye.z - 1.0f;
  EXPECT_NEAR(distance * std::tan(0.5f * camera.verticalFovDegrees * kPi / 180.0f), 1.0f, 1e-5f);
  EXPECT_EQ(camera.aspect, 1.0f);
}

TEST(BuiltinColourBleed, IsClosedAndHasThirtyTriangles) {
  const Scene scene = findBuiltinScene("colour-bleed")->make();
  EXPECT_EQ(worldTriangles(scene), 30u);
  EXPECT_EQ(openEdges(scene.meshes), 0u);
}

TEST(BuiltinGlassSphere, SolidsAreClosed) {
  const Scene scene = findBuiltinScene("glass-sphere")->make();
  const std::array spheres{scene.meshes[scene.meshes.size() - 2], scene.meshes.back()};
  for (const Mesh& sphere : spheres) EXPECT_EQ(openEdges({&sphere, 1}), 0u) << sphere.name;
  EXPECT_EQ(scene.materials[spheres[1].material].flags & kMaterialThinWalled, 0u);
}

TEST(BuiltinCausticRing, IsAClosedRingWhoseInnerWallIsAnExactCylinder) {
  const Scene scene = findBuiltinScene("caustic-ring")->make();
  const Mesh& ring = scene.meshes.back();
  EXPECT_EQ(openEdges({&ring, 1}), 0u);
  EXPECT_GT(enclosedVolume(ring), 0.0f);
  std::size_t onWall = 0;
  for (const uvec3 t : ring.triangles) {
    const vec3 p = ring.positions[t.x], q = ring.positions[t.y], r = ring.positions[t.z];
    const auto radius = [](vec3 v) { return std::hypot(v.x, v.z); };
    if (max(radius(p), max(radius(q), radius(r))) > 0.30001f) continue;
    ++onWall;
    EXPECT_NEAR(dot(ring.normals[t.x], vec3(p.x, 0, p.z) / radius(p)), -1.0f, 1e-6f);
  }
  EXPECT_EQ(onWall, 2u * 512u);
  EXPECT_GT(scene.lights.front().radius, 0.0f);
}

TEST(BuiltinAtrium, HasTheSizeThatBenchmarksCountOn) {
  const Scene scene = findBuiltinScene("atrium")->make();
  EXPECT_GE(worldTriangles(scene), 65'000u);
  EXPECT_LE(worldTriangles(scene), 120'000u);
  EXPECT_LT(scene.meshes.size(), scene.instances.size());
}

TEST(BuiltinAtrium, LeafTextureHasLeavesAndGaps) {
  const Scene scene = findBuiltinScene("atrium")->make();
  std::size_t masked = 0;
  for (const NamedMaterial& material : scene.materials) {
    if ((material.flags & kMaterialAlphaMask) == 0) continue;
    ++masked;
    ASSERT_GE(material.baseColourTexture, 0);
    const LargeVector<std::uint8_t>& rgba = scene.textures[std::size_t(material.baseColourTexture)].rgba;
    std::size_t opaque = 0;
    for (std::size_t i = 3; i < rgba.size(); i += 4) opaque += rgba[i] >= 128 ? 1 : 0;
    const double part = double(opaque) / double(rgba.size() / 4);
    EXPECT_GT(part, 0.15);
    EXPECT_LT(part, 0.7);
  }
  EXPECT_EQ(masked, 1u);
}

TEST(BuiltinFurnace, RoomsAreClosedConvexAndFaceInwards) {
  for (const char* name : {"furnace", "furnace-box"}) {
    const Scene scene = findBuiltinScene(name)->make();
    EXPECT_EQ(openEdges(scene.meshes), 0u) << name;
    const Mesh& walls = scene.meshes.front();
    for (const uvec3 t : walls.triangles) {
      // Convex: no vertex lies behind any wall by more than rounding.
      const vec3 normal = normalize(geometricNormal(walls, t));
      const float plane = dot(normal, walls.positions[t.x]);
      ASSERT_LT(plane, 0.0f) << name;
      for (std::size_t i = 0; i < walls.positions.size(); i += 7) {
        ASSERT_GE(dot(normal, walls.positions[i]), plane - 1e-5f) << name;
      }
    }
  }
}

TEST(Shapes, BoxEnclosesItsVolume) {
  Mesh mesh;
  addBox(mesh, {-1, 0, 2}, {1, 3, 2.5f});
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(openEdges({&mesh, 1}), 0u);
  EXPECT_NEAR(enclosedVolume(mesh), 3.0f, 1e-4f);
  flip(mesh);
  EXPECT_NEAR(enclosedVolume(mesh), -3.0f, 1e-4f);
}

TEST(Shapes, SphereIsClosedAndOutwards) {
  Mesh mesh;
  addSphere(mesh, vec3(0.0f), 2.0f, 64, 32);
  EXPECT_EQ(mesh.triangles.size(), 2u * 64u * 31u);
  EXPECT_EQ(openEdges({&mesh, 1}), 0u);
  // An inscribed polyhedron of 64 x 32 facets lacks about half a per cent of the ball.
  const float ball = 4.0f / 3.0f * kPi * 8.0f;
  EXPECT_GT(enclosedVolume(mesh), 0.99f * ball);
  EXPECT_LT(enclosedVolume(mesh), ball);
}

TEST(Shapes, LatheTurnsACylinderWithSharpEdges) {
  constexpr int kSlices = 48;
  const std::array<ProfilePoint, 6> profile{{{0, 0}, {1, 0}, {1, 0}, {1, 2}, {1, 2}, {0, 2}}};
  Mesh mesh;
  addLathe(mesh, profile, kSlices);
  EXPECT_EQ(openEdges({&mesh, 1}), 0u);
  const float prism = 0.5f * kSlices * std::sin(2.0f * kPi / kSlices) * 2.0f;
  EXPECT_NEAR(enclosedVolume(mesh), prism, 1e-4f);
  for (const uvec3 t : mesh.triangles) {
    const vec3 normal = normalize(geometricNormal(mesh, t));
    const float tilt = kPi / kSlices;  // between a facet of the side and the true cylinder at its edges
    EXPECT_GE(dot(normal, mesh.normals[t.x]), std::cos(tilt) - 1e-5f);
  }
}

TEST(Shapes, MouldingFacesOutOrIntoAYard) {
  // A wall of unit height around 2 x 4 m.
  const std::array<ProfilePoint, 2> upright{ProfilePoint{0, 0}, ProfilePoint{0, 1}};
  for (const bool inwards : {false, true}) {
    Mesh mesh;
    addMoulding(mesh, upright, {1, 2}, inwards);
    EXPECT_EQ(mesh.triangles.size(), 8u);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const float out = dot(mesh.normals[i], vec3(mesh.positions[i].x, 0, mesh.positions[i].z));
      if (inwards) {
        EXPECT_LT(out, 0.0f);
      } else {
        EXPECT_GT(out, 0.0f);
      }
    }
  }
}

TEST(Shapes, RepeatedProfilePointsLeaveNoEmptyPatch) {
  const std::array<ProfilePoint, 5> profile{{{1, 0}, {1, 1}, {1, 1}, {1, 1}, {0.5f, 1}}};
  Mesh mesh;
  addLathe(mesh, profile, 12);
  EXPECT_EQ(mesh.positions.size(), 2u * 2u * 13u);
}

TEST(Shapes, LatheCanBeSquare) {
  const std::array<ProfilePoint, 6> profile{
      {{0, 0, 1}, {1, 0, 1}, {1, 0, 1}, {1, 1, 1}, {1, 1, 1}, {0, 1, 1}}};
  Mesh mesh;
  addLathe(mesh, profile, 8);
  EXPECT_EQ(openEdges({&mesh, 1}), 0u);
  EXPECT_NEAR(enclosedVolume(mesh), 4.0f, 1e-4f);
}

TEST(Shapes, TurningKeepsShapeAndNormals) {
  Mesh mesh;
  addQuad(mesh, {0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  transform(mesh, turnedAndMoved(90, {5, 0, 0}));
  EXPECT_NEAR(mesh.normals[0].x, 1.0f, 1e-6f);  // z turns towards x
  EXPECT_NEAR(mesh.positions[1].z, -2.0f, 1e-6f);
  EXPECT_NEAR(mesh.positions[1].x, 5.0f, 1e-6f);
}

}  // namespace
}  // namespace isophote

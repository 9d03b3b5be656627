// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/surface.h"

#include "support/statistics.h"
#include "trace/tangents.h"

#include <gtest/gtest.h>

#include <array>

namespace isophote {
namespace {

/// The unit square in the plane z = 0 with texture coordinates: u along x, v against y.
Mesh square() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, vec3(0, 0, 1));
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Scene sceneOf(Mesh mesh, const Material& material, std::vector<Texture> textures = {}) {
  Scene scene;
  scene.materials.push_back({material, "paint"});
  scene.textures = std::move(textures);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.emplace_back();
  finishScene(scene, "square");
  return scene;
}

Texture oneTexel(std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a = 255) {
  Texture texture{"texel", 1, 1, {r, g, b, a}};
  texture.srgb = false;
  return texture;
}

Surface seenFrom(const TraceScene& trace, vec3 origin, vec3 direction = {0, 0, -1}) {
  const Ray ray{origin, 0.0f, direction, 1e30f};
  return surfaceAt(trace, ray, trace.closestHit(ray));
}

Material normalMapped(float scale = 1.0f) {
  Material m = makeMaterial();
  m.normalTexture = 0;
  m.normalScale = scale;
  return m;
}

TEST(NormalMap, RedTiltsAlongUAndGreenAgainstV) {
  const std::vector<Texture> towardsU{oneTexel(218, 128, 218)}, upwards{oneTexel(128, 218, 218)};
  const float tilt = std::sqrt(0.5f);
  for (const float z : {1.0f, -1.0f}) {
    // Seen from the back, the whole frame is turned round.
    const Scene right = sceneOf(square(), normalMapped(), towardsU);
    const vec3 n = seenFrom(TraceScene(right), {0.6f, 0.3f, z}, {0, 0, -z}).ns;
    EXPECT_NEAR(length(n - z * vec3(tilt, 0, tilt)), 0.0f, 0.01f);
    const Scene up = sceneOf(square(), normalMapped(), upwards);
    EXPECT_NEAR(length(seenFrom(TraceScene(up), {0.6f, 0.3f, z}, {0, 0, -z}).ns - z * vec3(0, tilt, tilt)),
                0.0f, 0.01f);
  }
  const Scene half = sceneOf(square(), normalMapped(-0.5f), towardsU);
  EXPECT_NEAR(length(seenFrom(TraceScene(half), {0.6f, 0.3f, 1}).ns - normalize(vec3(-0.5f, 0, 1))), 0.0f,
              0.01f);
}

TEST(NormalMap, FollowsMirroredTexturesAndTheFilesTangents) {
  Mesh mesh = square();
  for (vec2& uv : mesh.uvs) uv.x = -uv.x;
  const std::vector<Texture> towardsU{oneTexel(218, 128, 218)}, upwards{oneTexel(128, 218, 218)};
  EXPECT_LT(seenFrom(TraceScene(sceneOf(mesh, normalMapped(), towardsU)), {0.6f, 0.3f, 1}).ns.x, -0.7f);
  EXPECT_GT(seenFrom(TraceScene(sceneOf(mesh, normalMapped(), upwards)), {0.6f, 0.3f, 1}).ns.y, 0.7f);
  mesh.tangents.assign(4, vec4(0, -1, 0, -1));
  const Scene turned = sceneOf(mesh, normalMapped(), towardsU);
  EXPECT_LT(seenFrom(TraceScene(turned), {0.6f, 0.3f, 1}).ns.y, -0.7f);
  // An instance that mirrors keeps the picture on its surface.
  Scene mirrored = sceneOf(square(), normalMapped(), towardsU);
  mirrored.instances[0].worldFromObject = mat4x3({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0});
  finishScene(mirrored, "mirrored");
  EXPECT_LT(seenFrom(TraceScene(mirrored), {-0.6f, 0.3f, 1}).ns.x, -0.7f);
}

TEST(NormalMap, StaysAboveTheSurface) {
  const Scene scene = sceneOf(square(), normalMapped(40.0f), {oneTexel(255, 200, 128)});
  const Surface s = seenFrom(TraceScene(scene), {0.6f, 0.3f, 1});
  EXPECT_GE(dot(s.ns, s.ng), 0.9f * kLeastNormalCosine);
  EXPECT_NEAR(length(s.ns), 1.0f, 1e-5f);
}

TEST(NormalMap, WithoutCoordinatesLeavesNormalsAlone) {
  Mesh mesh = square();
  mesh.uvs.clear();
  const Scene scene = sceneOf(mesh, normalMapped(), {oneTexel(255, 128, 128)});
  EXPECT_NEAR(seenFrom(TraceScene(scene), {0.6f, 0.3f, 1}).ns.z, 1.0f, 1e-6f);
}

TEST(Tangents, PackInOneWord) {
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const vec3 t = sampleSphere(vec2(randomTriple(1, i).x, randomTriple(1, i).y));
    for (const float sign : {1.0f, -1.0f}) {
      const uint bits = packTangent(t, sign);
      ASSERT_NE(bits, kNoDirection);
      ASSERT_EQ(tangentSign(bits), sign);
      ASSERT_LT(length(unpackTangent(bits) - t), 2e-4f);
    }
  }
}

TEST(Surface, VertexColoursMultiplyTheBaseColour) {
  Mesh mesh = square();
  mesh.colours = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}};
  Material m = makeMaterial();
  m.baseColour = vec3(0.5f, 1.0f, 1.0f);
  const Scene scene = sceneOf(mesh, m);
  const vec3 c = seenFrom(TraceScene(scene), {0.5f, 0.25f, 1}).baseColour;
  EXPECT_NEAR(length(c - vec3(0.25f, 0.25f, 0.25f)), 0.0f, 0.005f);
}

TEST(Surface, UnlitShowsItsColourAndScattersNothing) {
  Material m = makeMaterial();
  m.baseColour = vec3(0.2f, 0.4f, 0.8f);
  m.flags = kMaterialUnlit;
  const Scene scene = sceneOf(square(), m);
  for (const float z : {1.0f, -1.0f}) {
    const Surface s = seenFrom(TraceScene(scene), {0.5f, 0.25f, z}, {0, 0, -z});
    EXPECT_EQ(s.emission, m.baseColour);
    EXPECT_EQ(hasNonDeltaLobe(s.bsdf) + hasDeltaLobe(s.bsdf), 0.0f);
  }
  EXPECT_TRUE(scene.emissiveTriangles.empty());
}

TEST(Surface, ReflectsTheSpecularColour) {
  Material m = makeMaterial();
  m.specular = 0.5f;
  m.specularColour = vec3(1.0f, 0.5f, 100.0f);
  m.specularTexture = 0;
  m.specularColourTexture = 1;
  const Scene scene = sceneOf(square(), m, {oneTexel(0, 0, 0, 51), oneTexel(255, 51, 255)});
  const Bsdf b = seenFrom(TraceScene(scene), {0.5f, 0.25f, 1}).bsdf;
  EXPECT_NEAR(length(b.f0 - 0.1f * vec3(0.04f, 0.004f, 1.0f)), 0.0f, 1e-6f) << "at most all is reflected";
  EXPECT_NEAR(b.f90, 0.1f, 1e-6f);
  EXPECT_NEAR(b.coupling0, 0.1f, 1e-6f);
}

class Curtain : public testing::Test {
 protected:
  Scene scene_ = [] {
    Material m = makeMaterial();
    m.flags = kMaterialAlphaBlend;
    m.alpha = 0.5f;
    m.baseColourTexture = 0;
    return sceneOf(square(), m, {oneTexel(255, 255, 255, 153)});
  }();
  static constexpr float kAlpha = 0.3f;
};

TEST_F(Curtain, IsMetByChanceAsOftenAsItCovers) {
  const TraceScene trace(scene_);
  constexpr std::uint32_t kRays = 40'000;
  Moments met, occluded, sameRay;
  std::array<Ray, 16> rays;
  std::array<Hit, 16> hits;
  for (std::uint32_t i = 0; i < kRays; ++i) {
    const vec3 u = randomTriple(1, i);
    const Ray ray{{u.x, u.y, 1}, 0, {0, 0, -1}, 1e30f};
    met.add(trace.closestHit(ray).valid() ? 1 : 0);
    occluded.add(trace.occluded(ray) ? 1 : 0);
    Ray same{{0.25f, 0.5f, 1}, 0, {0, 0, -1}, 1e30f};
    same.salt = i;
    sameRay.add(trace.closestHit(same).valid() ? 1 : 0);
    // One ray has one answer, however it is asked.
    rays[i % 16] = ray;
    if (i % 16 != 15) continue;
    trace.closestHits(rays, hits, true);
    for (std::size_t k = 0; k < 16; ++k) ASSERT_EQ(hits[k].valid(), trace.closestHit(rays[k]).valid());
  }
  for (const Moments& m : {met, occluded, sameRay}) EXPECT_TRUE(hasMean(m, double(kAlpha), 3));
}

TEST_F(Curtain, IsSeenAlwaysAndLetsItsShareOfLightPass) {
  scene_.instances.emplace_back();  // a second one behind the first
  scene_.instances[1].worldFromObject[3] = vec3(0, 0, -1);
  finishScene(scene_, "curtains");
  const TraceScene trace(scene_);
  const Ray ray{{0.3f, 0.6f, 1}, 0, {0, 0, -1}, 1e30f};
  const Hit hit = trace.closestHit(ray, Blended::kAlways);
  ASSERT_TRUE(hit.valid());
  EXPECT_NEAR(hit.t, 1.0f, 1e-5f);
  EXPECT_NEAR(surfaceAt(trace, ray, hit).coverage, kAlpha, 1e-6f);
  std::array<Ray, 3> rays{ray, ray, ray};
  rays[1].tMax = 1.5f;
  rays[2].origin.x = 2.0f;
  std::array<float, 3> visible{};
  trace.visibility(rays, visible);
  EXPECT_NEAR(visible[0], (1 - kAlpha) * (1 - kAlpha), 1e-6f);
  EXPECT_NEAR(visible[1], 1 - kAlpha, 1e-6f);
  EXPECT_EQ(visible[2], 1.0f);
}

TEST_F(Curtain, ThatCoversWhollyIsOpaque) {
  scene_.materials[0].alpha = 1.0f;
  scene_.textures[0] = oneTexel(1, 2, 3, 255);
  finishScene(scene_, "board");
  EXPECT_EQ(scene_.materials[0].flags & kMaterialAlphaBlend, 0u);
}

}  // namespace
}  // namespace isophote

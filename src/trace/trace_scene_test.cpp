// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/trace_scene.h"

#include "base/error.h"
#include "math/rng.shared.h"
#include "trace/surface.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace isophote {
namespace {

/// A cloud of random triangles, every `repeat` instances of it turned and moved.
Scene randomScene(std::uint32_t triangles, std::uint32_t repeat) {
  Scene scene;
  scene.materials.push_back({makeMaterial(), "grey"});
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
    const vec3 centre = random3(1, i / 3, 0) * 2.0f - vec3(1);
    mesh.positions.push_back(centre + (random3(2, i, 0) - vec3(0.5f)) * 0.4f);
  }
  for (std::uint32_t i = 0; i < triangles; ++i) mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  scene.meshes.push_back(mesh);
  for (std::uint32_t i = 0; i < repeat; ++i) {
    Instance instance;
    const float a = 0.7f * float(i);
    instance.worldFromObject = mat4x3(vec3(std::cos(a), 0, -std::sin(a)), vec3(0, 1.0f + 0.1f * float(i), 0),
                                      vec3(std::sin(a), 0, std::cos(a)), vec3(2.0f * float(i), 0, 0));
    scene.instances.push_back(instance);
  }
  finishScene(scene, "random");
  return scene;
}

Hit bruteForce(const Scene& scene, const Ray& ray) {
  Hit best;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const uvec3 index = mesh.triangles[t];
      const vec3 p0 = instance.worldFromObject * vec4(mesh.positions[index.x], 1.0f);
      const vec3 e1 = vec3(instance.worldFromObject * vec4(mesh.positions[index.y], 1.0f)) - p0;
      const vec3 e2 = vec3(instance.worldFromObject * vec4(mesh.positions[index.z], 1.0f)) - p0;
      const vec3 p = cross(ray.direction, e2);
      const float determinant = dot(e1, p);
      if (std::abs(determinant) < 1e-12f) continue;
      const vec3 s = ray.origin - p0;
      const float u = dot(s, p) / determinant;
      const vec3 q = cross(s, e1);
      const float v = dot(ray.direction, q) / determinant;
      const float distance = dot(e2, q) / determinant;
      if (u >= 0 && v >= 0 && u + v <= 1 && distance > ray.tMin && distance < best.t)
        best = {distance, u, v, i, t};
    }
  }
  return best;
}

Ray randomRay(std::uint32_t i) {
  const vec3 origin = (random3(3, i, 0) - vec3(0.5f)) * 8.0f;
  const vec3 target = random3(4, i, 0) * 2.0f - vec3(1);
  return {origin, 0.0f, normalize(target - origin), 1e30f};
}

void expectAgreesWithBruteForce(const Scene& scene) {
  const TraceScene trace(scene);
  int hits = 0;
  int differing = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const Ray ray = randomRay(i);
    const Hit expected = bruteForce(scene, ray);
    const Hit hit = trace.closestHit(ray);
    hits += expected.valid();
    if (hit.instance != expected.instance || hit.triangle != expected.triangle ||
        (hit.valid() && std::abs(hit.t - expected.t) > 1e-4f * expected.t))
      ++differing;
    EXPECT_EQ(trace.occluded(ray), hit.valid());
  }
  EXPECT_GT(hits, 500);
  // Rays through an edge may go either way.
  EXPECT_LE(differing, 2);
}

TEST(TraceScene, AgreesWithBruteForceBaked) { expectAgreesWithBruteForce(randomScene(200, 1)); }
TEST(TraceScene, AgreesWithBruteForceInstanced) { expectAgreesWithBruteForce(randomScene(100, 3)); }

TEST(TraceScene, PacketsEqualSingleRays) {
  const Scene scene = randomScene(100, 3);
  const TraceScene trace(scene);
  for (std::size_t count : {1u, 7u, 16u}) {
    std::array<Ray, 16> rays;
    std::array<Hit, 16> hits;
    std::array<std::uint8_t, 16> occluded{};
    for (std::uint32_t i = 0; i < count; ++i) rays[i] = randomRay(1000 + i);
    trace.closestHits(std::span(rays).first(count), std::span(hits).first(count), false);
    trace.occluded(std::span(rays).first(count), std::span(occluded).first(count));
    float columns[6][16] = {};
    for (std::uint32_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        columns[k][i] = rays[i].origin[k];
        columns[3 + k][i] = rays[i].direction[k];
      }
    std::array<Hit, 16> ofColumns;
    trace.closestHits({{columns[0], columns[1], columns[2]}, {columns[3], columns[4], columns[5]}},
                      std::span(ofColumns).first(count), false);
    for (std::size_t i = 0; i < count; ++i) {
      const Hit single = trace.closestHit(rays[i]);
      EXPECT_EQ(hits[i].instance, single.instance);
      EXPECT_EQ(hits[i].triangle, single.triangle);
      EXPECT_EQ(ofColumns[i].instance, hits[i].instance);
      EXPECT_EQ(ofColumns[i].triangle, hits[i].triangle);
      EXPECT_EQ(ofColumns[i].t, hits[i].t);
      EXPECT_EQ(occluded[i] != 0, single.valid());
    }
  }
}

TEST(TraceScene, ColumnsOfShadowRaysEqualSingleOnes) {
  const Scene scene = randomScene(100, 3);
  const TraceScene trace(scene);
  int blocked = 0;
  for (std::uint32_t packet = 0; packet < 50; ++packet) {
    std::array<std::array<float, 16>, 6> columns;
    std::array<float, 16> distances, visible;
    std::array<Ray, 16> rays;
    for (std::uint32_t i = 0; i < 16; ++i) {
      rays[i] = randomRay(16 * packet + i);
      rays[i].tMax = distances[i] = 5.0f * random3(4, 16 * packet + i, 0).x;
      for (int axis = 0; axis < 3; ++axis) {
        columns[std::size_t(axis)][i] = rays[i].origin[axis];
        columns[std::size_t(3 + axis)][i] = rays[i].direction[axis];
      }
    }
    const std::uint32_t wanted = hash3(uvec3(6, packet, 0)).x & 0xffffu;
    trace.visibility({{columns[0].data(), columns[1].data(), columns[2].data()},
                      {columns[3].data(), columns[4].data(), columns[5].data()}},
                     distances.data(), wanted, visible.data());
    for (std::uint32_t i = 0; i < 16; ++i) {
      const bool asked = (wanted >> i & 1u) != 0u;
      const bool occluded = trace.occluded(rays[i]);
      EXPECT_EQ(visible[i], asked && !occluded ? 1.0f : 0.0f);
      blocked += asked && occluded;
    }
  }
  EXPECT_GT(blocked, 20);
}

TEST(TraceScene, MaskedTexelsLetRaysPass) {
  Scene scene;
  NamedMaterial leaf{makeMaterial(), "leaf"};
  leaf.flags = kMaterialAlphaMask;
  leaf.baseColourTexture = 0;
  scene.materials.push_back(leaf);
  // Left half opaque, right half clear.
  Texture texture{"leaf", 2, 1, {255, 255, 255, 255, 255, 255, 255, 0}};
  texture.nearest = true;
  scene.textures.push_back(texture);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.push_back(mesh);
  scene.instances.emplace_back();
  finishScene(scene, "leaf");
  const TraceScene trace(scene);
  for (float x : {0.1f, 0.3f, 0.45f, 0.55f, 0.7f, 0.9f}) {
    const Ray ray{{x, 0.5f, 1}, 0, {0, 0, -1}, 1e30f};
    EXPECT_EQ(trace.closestHit(ray).valid(), x < 0.5f) << x;
    EXPECT_EQ(trace.occluded(ray), x < 0.5f) << x;
  }
}

TEST(TraceScene, SurfacesHaveConsistentNormalsAndPositions) {
  const Scene scene = randomScene(100, 3);
  const TraceScene trace(scene);
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Ray ray = randomRay(i);
    const Hit hit = trace.closestHit(ray);
    if (!hit.valid()) continue;
    const Surface s = surfaceAt(trace, ray, hit);
    EXPECT_NEAR(length(s.position - (ray.origin + ray.direction * hit.t)), 0.0f, 1e-4f);
    EXPECT_NEAR(length(s.ng), 1.0f, 1e-5f);
    EXPECT_LE(dot(s.ng, ray.direction), 0.0f);
    // A ray that leaves on either side does not meet its own surface.
    for (float side : {1.0f, -1.0f}) {
      const Hit next = trace.closestHit(rayFrom(s.position, s.ng, s.ng * side));
      EXPECT_FALSE(next.instance == hit.instance && next.triangle == hit.triangle);
    }
  }
}

TEST(TraceScene, RefusesToExceedItsBudget) {
  const Scene scene = randomScene(200, 1);
  Job job;
  job.memoryBudgetBytes = 1000;
  EXPECT_THROW(TraceScene(scene, job), Error);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh_emission.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

/// Most points of a triangle along each edge at which its texture is looked up for the mean.
constexpr int kMostSteps = 256;
/// Part of its light's mean that a triangle counts with besides its own where its texture was too fine for
/// these, so that none that shines is never chosen.
constexpr float kDefence = 0.05f;

float meanOf(vec3 colour) { return (colour.x + colour.y + colour.z) / 3.0f; }

/// Longest edge of a triangle on its textures, in texels: points no farther apart than one miss none.
float texelsAcross(const Scene& scene, const Mesh& mesh, const uvec3& triangle) {
  const Material& m = scene.materials[mesh.material];
  float longest = 1.0f;
  if (mesh.uvs.empty()) return longest;
  for (const int index : {m.emissionTexture, isMasked(scene, mesh) ? m.baseColourTexture : -1}) {
    if (index < 0) continue;
    const Texture& texture = scene.textures[std::size_t(index)];
    const vec2 size(float(texture.width), float(texture.height));
    for (int k = 0; k < 3; ++k)
      longest = max(longest, length((mesh.uvs[triangle[k]] - mesh.uvs[triangle[(k + 1) % 3]]) * size));
  }
  return longest;
}

struct MeanRadiance {
  vec3 value{0.0f};
  bool exact = true;  ///< Whether no texel was missed.
};

/// Of the centres of n^2 equal parts of the triangle.
MeanRadiance meanRadiance(const Scene& scene, const Mesh& mesh, std::uint32_t index) {
  const float across = texelsAcross(scene, mesh, mesh.triangles[index]);
  const int n = int(std::min(std::ceil(across), float(kMostSteps)));
  glm::dvec3 sum(0.0);
  for (int row = 0; row < n; ++row)
    for (int i = 0; i < 2 * (n - row) - 1; ++i) {
      // Every second part stands upside down.
      const float third = i % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
      const vec2 b((float(i / 2) + third) / float(n), (float(row) + third) / float(n));
      sum += glm::dvec3(emittedRadiance(scene, mesh, index, b));
    }
  return {vec3(sum / (double(n) * double(n))), across <= float(kMostSteps)};
}

/// The triangles of one instance, with probabilities, and its light, of power 0 where nothing is emitted.
struct MeshLight {
  Light light{};
  std::vector<EmissiveTriangle> triangles;
};

void findTriangles(const Scene& scene, const Instance& instance, std::uint32_t instanceIndex,
                   std::vector<EmissiveTriangle>& triangles, std::vector<float>& areas) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  const bool doubleSided = (scene.materials[mesh.material].flags & kMaterialDoubleSided) != 0u;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    vec3 v[3];
    for (int k = 0; k < 3; ++k)
      v[k] = instance.worldFromObject * vec4(mesh.positions[mesh.triangles[i][k]], 1.0f);
    EmissiveTriangle triangle{};
    triangle.v0 = v[0];
    triangle.instance = instanceIndex;
    triangle.edge1 = v[1] - v[0];
    triangle.triangle = std::uint32_t(i);
    triangle.edge2 = v[2] - v[0];
    triangle.doubleSided = doubleSided ? 1u : 0u;
    const float area = 0.5f * length(cross(triangle.edge1, triangle.edge2));
    if (!(area > 0.0f)) continue;
    triangles.push_back(triangle);
    areas.push_back(area);
  }
}

MeshLight meshLight(const Scene& scene, std::uint32_t instanceIndex, const Job& job) {
  MeshLight result;
  const Instance& instance = scene.instances[instanceIndex];
  const Mesh& mesh = scene.meshes[instance.mesh];
  std::vector<float> areas;
  findTriangles(scene, instance, instanceIndex, result.triangles, areas);
  std::vector<std::uint8_t> exact(areas.size(), 1);
  const bool uneven = emitsUnevenly(scene, mesh);
  tbb::parallel_for(std::size_t(0), areas.size(), [&](std::size_t i) {
    if (job.stop.stop_requested()) return;
    EmissiveTriangle& triangle = result.triangles[i];
    triangle.radiance = scene.materials[mesh.material].emission;
    if (!uneven) return;
    const MeanRadiance mean = meanRadiance(scene, mesh, triangle.triangle);
    triangle.radiance = mean.value;
    exact[i] = mean.exact ? 1 : 0;
  });
  job.throwIfStopped();
  double area = 0, power = 0, weights = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    area += double(areas[i]);
    power += double(areas[i]) * double(meanOf(result.triangles[i].radiance));
  }
  const double floor = area > 0 ? double(kDefence) * power / area : 0.0;
  std::vector<double> weight(areas.size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double own = double(meanOf(result.triangles[i].radiance));
    weight[i] = double(areas[i]) * (exact[i] != 0 ? own : own + std::max(floor, 1e-30));
    weights += weight[i];
  }
  for (std::size_t i = 0; i < areas.size(); ++i)
    result.triangles[i].probability = weights > 0 ? float(weight[i] / weights) : 0.0f;
  Light& light = result.light;
  light.type = kLightMesh;
  light.colour = vec3(1.0f);
  light.triangleCount = std::uint32_t(areas.size());
  light.area = float(area);
  const bool doubleSided = (scene.materials[mesh.material].flags & kMaterialDoubleSided) != 0u;
  light.power = weights > 0 ? kPi * float(power) * (doubleSided ? 2.0f : 1.0f) : 0.0f;
  return result;
}

}  // namespace

std::vector<AliasSlot> aliasTable(std::span<const float> probabilities) {
  const std::size_t n = probabilities.size();
  std::vector<AliasSlot> slots(n, AliasSlot{1.0f, 0});
  std::vector<double> left(n);
  std::vector<std::uint32_t> small, large;
  double sum = 0;
  for (const float p : probabilities) sum += double(p);
  for (std::size_t i = 0; i < n; ++i) {
    slots[i].other = std::uint32_t(i);
    left[i] = sum > 0 ? double(probabilities[i]) / sum * double(n) : 1.0;
    (left[i] < 1.0 ? small : large).push_back(std::uint32_t(i));
  }
  // Each slot that is not filled by its own gets the rest from one that has too much.
  while (!small.empty() && !large.empty()) {
    const std::uint32_t poor = small.back(), rich = large.back();
    small.pop_back();
    slots[poor] = {float(left[poor]), rich};
    left[rich] -= 1.0 - left[poor];
    if (left[rich] < 1.0) {
      large.pop_back();
      small.push_back(rich);
    }
  }
  // What is left differs from a full slot by rounding, unless it has no probability at all.
  for (const std::uint32_t i : small)
    if (left[i] <= 0.0 && n > 1)
      slots[i] = {0.0f, std::uint32_t(std::max_element(left.begin(), left.end()) - left.begin())};
  return slots;
}

float triangleProbability(const Scene& scene, const Light& light, std::uint32_t triangle) {
  const auto first = scene.emissiveTriangles.begin() + light.firstTriangle;
  // Where no triangle was left out, each is at its own place.
  if (triangle < light.triangleCount && first[triangle].triangle == triangle)
    return first[triangle].probability;
  const auto last = first + light.triangleCount;
  const auto found = std::lower_bound(
      first, last, triangle, [](const EmissiveTriangle& t, std::uint32_t i) { return t.triangle < i; });
  return found != last && found->triangle == triangle ? found->probability : 0.0f;
}

void addMeshLights(Scene& scene, const Job& job) {
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    if (scene.materials[mesh.material].emission == vec3(0.0f)) continue;
    MeshLight found = meshLight(scene, i, job);
    if (!(found.light.power > 0.0f)) continue;
    found.light.firstTriangle = std::uint32_t(scene.emissiveTriangles.size());
    std::vector<float> probabilities;
    for (const EmissiveTriangle& t : found.triangles) probabilities.push_back(t.probability);
    const std::vector<AliasSlot> aliases = aliasTable(probabilities);
    scene.emissiveTriangles.insert(scene.emissiveTriangles.end(), found.triangles.begin(),
                                   found.triangles.end());
    scene.emissiveAliases.insert(scene.emissiveAliases.end(), aliases.begin(), aliases.end());
    scene.lights.push_back(found.light);
  }
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/light_power.h"

#include "physics/emission.shared.h"
#include "scene/texture_sample.h"

#include <array>

namespace isophote {

namespace {

float meanOf(vec3 colour) { return (colour.x + colour.y + colour.z) / 3.0f; }

/// Mean linear colour of all texels; exact, by histogram.
vec3 textureMean(const Texture& texture) {
  std::array<std::array<std::uint64_t, 256>, 3> histogram{};
  for (std::size_t i = 0; i + 3 < texture.rgba.size(); i += 4)
    for (std::size_t k = 0; k < 3; ++k) ++histogram[k][texture.rgba[i + k]];
  vec3 mean(0.0f);
  for (std::size_t k = 0; k < 3; ++k) {
    double sum = 0;
    for (std::uint32_t value = 0; value < 256; ++value)
      sum += double(histogram[k][value]) * double(linearFrom8(value, texture.srgb));
    mean[int(k)] = float(sum / double(texture.rgba.size() / 4));
  }
  return mean;
}

/// Appends the triangles of one instance; returns the light that holds them, with power 0 where nothing is
/// emitted.
Light addMeshLight(Scene& scene, std::uint32_t instanceIndex, vec3 radiance) {
  const Instance& instance = scene.instances[instanceIndex];
  const Mesh& mesh = scene.meshes[instance.mesh];
  const bool doubleSided = (scene.materials[mesh.material].flags & kMaterialDoubleSided) != 0u;
  Light light{};
  light.type = kLightMesh;
  light.colour = vec3(1.0f);
  light.firstTriangle = std::uint32_t(scene.emissiveTriangles.size());
  double area = 0;
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
    triangle.radiance = radiance;
    triangle.doubleSided = doubleSided ? 1u : 0u;
    const float size = 0.5f * length(cross(triangle.edge1, triangle.edge2));
    if (!(size > 0.0f)) continue;
    area += double(size);
    // One radiance for the whole mesh: power is in proportion to area.
    triangle.cumulativePower = float(area);
    scene.emissiveTriangles.push_back(triangle);
  }
  light.triangleCount = std::uint32_t(scene.emissiveTriangles.size()) - light.firstTriangle;
  for (std::size_t i = light.firstTriangle; i < scene.emissiveTriangles.size(); ++i)
    scene.emissiveTriangles[i].cumulativePower =
        float(double(scene.emissiveTriangles[i].cumulativePower) / area);
  if (light.triangleCount > 0) scene.emissiveTriangles.back().cumulativePower = 1.0f;
  light.area = float(area);
  light.power = kPi * light.area * meanOf(radiance) * (doubleSided ? 2.0f : 1.0f);
  return light;
}

}  // namespace

float lightPower(const Light& light, const Bounds& bounds) {
  const float strength = meanOf(light.colour);
  switch (light.type) {
    case kLightPoint:
      return 4.0f * kPi * strength;
    case kLightSpot:
      // The integral of t^2 over the falloff, t rising linearly with the cosine, is a third of its width.
      return 2.0f * kPi * strength * ((1.0f - light.cosInner) + (light.cosInner - light.cosOuter) / 3.0f);
    case kLightDirectional: {
      const vec3 extents = projectedHalfExtents(light.direction, 0.5f * bounds.size());
      return strength * 4.0f * extents.x * extents.y;
    }
    case kLightRectangle:
      return kPi * light.area * strength;
    case kLightEnvironment:
      // Irradiance pi L on the whole of the bounding sphere's surface, 4 pi r^2.
      return kPi * strength * 4.0f * kPi * bounds.radius() * bounds.radius();
    default:
      return light.power;
  }
}

void addMeshLights(Scene& scene) {
  std::vector<vec3> radiance(scene.materials.size(), vec3(0.0f));
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const NamedMaterial& material = scene.materials[i];
    if (material.emission == vec3(0.0f)) continue;
    const bool textured = material.emissionTexture >= 0;
    radiance[i] =
        material.emission * (textured ? textureMean(scene.textures[material.emissionTexture]) : vec3(1.0f));
  }
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const vec3 emitted = radiance[scene.meshes[scene.instances[i].mesh].material];
    if (emitted == vec3(0.0f)) continue;
    const Light light = addMeshLight(scene, i, emitted);
    if (light.triangleCount > 0) scene.lights.push_back(light);
  }
}

}  // namespace isophote

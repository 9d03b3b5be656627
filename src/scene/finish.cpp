// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "scene/defaults.h"
#include "scene/light_power.h"
#include "scene/mesh_emission.h"
#include "scene/scene.h"
#include "scene/validate.h"

#include <tbb/parallel_for.h>

#include <map>

namespace isophote {

namespace {

float determinant(const mat4x3& m) { return dot(cross(m[0], m[1]), m[2]); }

/// A copy whose x axis points the other way, wound so that its front stays its front.
Mesh mirrored(Mesh mesh) {
  for (vec3& p : mesh.positions) p.x = -p.x;
  for (vec3& n : mesh.normals) n.x = -n.x;
  for (vec4& t : mesh.tangents) t = vec4(-t.x, t.y, t.z, -t.w);
  for (uvec3& t : mesh.triangles) t = uvec3(t.x, t.z, t.y);
  return mesh;
}

/// Gives instances that mirror their mesh (negative determinant) a mirrored mesh of their own, so that
/// everything after this may take the front of a triangle from its winding alone, in object space as in world
/// space. Drops instances that are scaled flat: they have no inverse, and files use them to hide things.
void straightenInstances(Scene& scene, const std::string& subject, const Job& job) {
  std::map<std::uint32_t, std::uint32_t> mirrorOf;
  std::vector<Instance> kept;
  kept.reserve(scene.instances.size());
  for (Instance& instance : scene.instances) {
    mat4x3& m = instance.worldFromObject;
    const float size = length(m[0]) * length(m[1]) * length(m[2]);
    const float det = determinant(m);
    if (!(abs(det) > 1e-7f * size)) {
      job.warn(fmt::format("{}: instance \"{}\" is scaled flat and left out", subject, instance.name));
      continue;
    }
    if (det < 0.0f) {
      const auto [entry, isNew] = mirrorOf.try_emplace(instance.mesh, std::uint32_t(scene.meshes.size()));
      if (isNew) scene.meshes.push_back(mirrored(scene.meshes[instance.mesh]));
      instance.mesh = entry->second;
      m[0] = -m[0];
    }
    kept.push_back(std::move(instance));
  }
  scene.instances = std::move(kept);
}

bool hasClearTexel(const Texture& texture) {
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
    if (texture.rgba[i] != 255) return true;
  return false;
}

/// Many files blend whatever they show. What covers wholly everywhere is opaque, and costs rays nothing.
void dropNeedlessBlending(Scene& scene) {
  std::vector<bool> clear(scene.materials.size(), false);
  for (const Mesh& mesh : scene.meshes)
    for (const vec4& colour : mesh.colours)
      if (colour.w < 1.0f) clear[mesh.material] = true;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    Material& m = scene.materials[i];
    if ((m.flags & kMaterialAlphaBlend) == 0u || m.alpha < 1.0f || clear[i]) continue;
    const int texture = m.baseColourTexture;
    if (texture < 0 || !hasClearTexel(scene.textures[std::size_t(texture)])) m.flags &= ~kMaterialAlphaBlend;
  }
}

Bounds boundsOf(const Mesh& mesh, const mat4x3& worldFromObject) {
  Bounds bounds;
  for (const uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) bounds.extend(worldFromObject * vec4(mesh.positions[t[k]], 1.0f));
  return bounds;
}

void computeBounds(Scene& scene, const std::string& subject, const Job& job) {
  std::vector<Bounds> bounds(scene.instances.size());
  tbb::parallel_for(std::size_t(0), scene.instances.size(), [&](std::size_t i) {
    job.throwIfStopped();
    const Instance& instance = scene.instances[i];
    bounds[i] = boundsOf(scene.meshes[instance.mesh], instance.worldFromObject);
  });
  scene.bounds = Bounds{};
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    if (bounds[i].empty()) continue;
    const vec3 reach = max(abs(bounds[i].lower), abs(bounds[i].upper));
    if (!(max(reach.x, max(reach.y, reach.z)) <= kLargestCoordinate))
      failInput(subject, "instance {} \"{}\" reaches beyond {:g} m once placed; check its transform", i,
                scene.instances[i].name, kLargestCoordinate);
    scene.bounds.extend(bounds[i]);
  }
  if (scene.bounds.empty())
    failInput(subject, "the scene has no triangles to render; a mesh of triangles must be placed in it");
}

}  // namespace

void finishScene(Scene& scene, const std::string& subject, const Job& job) {
  // A scene may be finished again after a change: mesh lights are derived, so they start afresh.
  std::erase_if(scene.lights, [](const Light& light) { return light.type == kLightMesh; });
  scene.emissiveTriangles.clear();
  scene.emissiveAliases.clear();
  validateScene(scene, subject, job);
  dropNeedlessBlending(scene);
  straightenInstances(scene, subject, job);
  computeBounds(scene, subject, job);
  addMeshLights(scene, job);
  addDefaults(scene, subject, job);
  for (Light& light : scene.lights) {
    if (light.type == kLightEnvironment && light.mapped != 0u) {
      prepareEnvironment(scene.environment, light, scene.bounds);
      light.power = environmentPower(scene.environment);
    }
    light.power = lightPower(light, scene.bounds);
  }
}

std::uint64_t sceneBytes(const Scene& scene) {
  const auto bytesOf = [](const auto& items) { return std::uint64_t(items.size()) * sizeof(items[0]); };
  std::uint64_t bytes = bytesOf(scene.instances) + bytesOf(scene.materials) + bytesOf(scene.lights) +
                        bytesOf(scene.emissiveTriangles) + bytesOf(scene.emissiveAliases) +
                        scene.environment.bytes();
  for (const Mesh& mesh : scene.meshes)
    bytes += bytesOf(mesh.positions) + bytesOf(mesh.normals) + bytesOf(mesh.uvs) + bytesOf(mesh.tangents) +
             bytesOf(mesh.colours) + bytesOf(mesh.triangles);
  for (const Texture& texture : scene.textures) bytes += bytesOf(texture.rgba) + bytesOf(texture.floats);
  return bytes;
}

}  // namespace isophote

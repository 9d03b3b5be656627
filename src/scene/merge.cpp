// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/merge.h"

#include <iterator>

namespace isophote {

namespace {

template <class T>
void moveBehind(std::vector<T>& to, std::vector<T>&& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

vec3 transformPoint(const mat4x3& m, vec3 p) { return m * vec4(p, 1.0f); }
vec3 transformVector(const mat4x3& m, vec3 v) { return m * vec4(v, 0.0f); }

void shift(int& index, std::size_t by) {
  if (index >= 0) index += int(by);
}

void transformLight(Light& light, const mat4x3& m) {
  light.position = transformPoint(m, light.position);
  if (light.type == kLightSpot || light.type == kLightDirectional) {
    light.direction = normalize(transformVector(m, light.direction));
  }
  if (light.type == kLightRectangle) {
    // Its flux stays the same when it grows: that is what lights do in glTF.
    const float before = light.area;
    light.edgeU = transformVector(m, light.edgeU);
    light.edgeV = transformVector(m, light.edgeV);
    const vec3 normal = cross(light.edgeU, light.edgeV);
    light.area = length(normal);
    light.direction = normal / light.area;
    light.colour *= before / light.area;
  }
}

/// b first, then a.
mat4x3 product(const mat4x3& a, const mat4x3& b) {
  const auto column = [&](int i, float w) { return a * vec4(b[i], w); };
  return mat4x3(column(0, 0.0f), column(1, 0.0f), column(2, 0.0f), column(3, 1.0f));
}

}  // namespace

MergedModel appendModel(Scene& scene, Scene&& model, const mat4x3& worldFromModel) {
  MergedModel merged;
  const std::size_t firstMesh = scene.meshes.size();
  merged.firstMaterial = scene.materials.size();
  merged.materialCount = model.materials.size();
  const std::size_t firstTexture = scene.textures.size();
  for (Mesh& mesh : model.meshes) mesh.material += std::uint32_t(merged.firstMaterial);
  for (NamedMaterial& material : model.materials) {
    shift(material.baseColourTexture, firstTexture);
    shift(material.metallicRoughnessTexture, firstTexture);
    shift(material.emissionTexture, firstTexture);
    shift(material.normalTexture, firstTexture);
    shift(material.transmissionTexture, firstTexture);
    shift(material.specularTexture, firstTexture);
    shift(material.specularColourTexture, firstTexture);
  }
  merged.instances = std::move(model.instances);
  for (Instance& instance : merged.instances) instance.mesh += std::uint32_t(firstMesh);
  for (Light& light : model.lights) transformLight(light, worldFromModel);
  for (Camera& camera : model.cameras) {
    camera.eye = transformPoint(worldFromModel, camera.eye);
    camera.target = transformPoint(worldFromModel, camera.target);
    camera.up = transformVector(worldFromModel, camera.up);
    camera.orthographicHeight *= length(transformVector(worldFromModel, vec3(0, 1, 0)));
  }
  moveBehind(scene.meshes, std::move(model.meshes));
  moveBehind(scene.materials, std::move(model.materials));
  moveBehind(scene.textures, std::move(model.textures));
  moveBehind(scene.lights, std::move(model.lights));
  moveBehind(scene.cameras, std::move(model.cameras));
  return merged;
}

void placeModel(Scene& scene, const MergedModel& model, const mat4x3& worldFromModel,
                const std::string& name) {
  for (const Instance& original : model.instances) {
    Instance& instance = scene.instances.emplace_back(original);
    instance.worldFromObject = product(worldFromModel, original.worldFromObject);
    if (!name.empty()) instance.name = name + "/" + original.name;
  }
}

}  // namespace isophote

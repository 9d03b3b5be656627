// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf.h"

#include "scene/gltf_accessor.h"
#include "scene/gltf_document.h"
#include "scene/gltf_material.h"
#include "scene/gltf_mesh.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace isophote {

namespace {

/// Read whole, or as far as a picture without them is still right in kind (a sheen or a clear coat is left
/// out).
constexpr std::array<std::string_view, 11> kRead{"KHR_lights_punctual",
                                                 "KHR_materials_transmission",
                                                 "KHR_materials_ior",
                                                 "KHR_materials_specular",
                                                 "KHR_materials_volume",
                                                 "KHR_materials_emissive_strength",
                                                 "KHR_texture_transform",
                                                 "KHR_mesh_quantization",
                                                 "EXT_mesh_gpu_instancing",
                                                 "KHR_materials_unlit",
                                                 "KHR_xmp"};
constexpr std::array<std::string_view, 6> kLeftOut{"KHR_materials_sheen",       "KHR_materials_clearcoat",
                                                   "KHR_materials_iridescence", "KHR_materials_anisotropy",
                                                   "KHR_materials_dispersion",  "KHR_materials_variants"};

bool contains(std::span<const std::string_view> names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> extensionNames(const JsonValue& root, std::string_view key) {
  std::vector<std::string> names;
  if (const std::optional<JsonValue> list = root.find(key))
    for (const JsonValue& element : list->elements()) names.push_back(element.string());
  return names;
}

void checkExtensions(const GltfDocument& document, const Job& job) {
  std::vector<std::string> refused;
  for (const std::string& name : extensionNames(document.root(), "extensionsRequired"))
    if (!contains(kRead, name) && !contains(kLeftOut, name)) refused.push_back(name);
  if (!refused.empty())
    failInput(document.file(), "requires {}, which cannot be read; export the model again without {}",
              fmt::join(refused, " and "), refused.size() > 1 ? "them" : "it");
  std::vector<std::string> ignored;
  for (const std::string& name : extensionNames(document.root(), "extensionsUsed"))
    if (!contains(kRead, name)) ignored.push_back(name);
  if (!ignored.empty())
    job.warn(fmt::format("{}: is read without {}", document.file(), fmt::join(ignored, ", ")));
  std::string motion;
  for (const std::string_view key : {"animations", "skins"})
    if (document.root().has(key)) motion += fmt::format("{}{}", motion.empty() ? "" : " and ", key);
  if (!motion.empty())
    job.warn(fmt::format("{}: is read in its rest pose, without its {}", document.file(), motion));
}

glm::dmat4 transformOf(const std::vector<float>& translation, const std::vector<float>& rotation,
                       const std::vector<float>& scale, const JsonValue& place) {
  glm::dquat q(rotation[3], rotation[0], rotation[1], rotation[2]);
  const double size = std::sqrt(glm::dot(q, q));
  if (!(size > 0.0)) place.fail("has a rotation of length zero; it must be a unit quaternion");
  q = q / size;
  const glm::dmat4 translated =
      glm::translate(glm::dmat4(1.0), {translation[0], translation[1], translation[2]});
  return glm::scale(translated * glm::mat4_cast(q), {scale[0], scale[1], scale[2]});
}

glm::dmat4 localTransform(const JsonValue& node) {
  if (const std::optional<JsonValue> matrix = node.find("matrix")) {
    const std::vector<float> v = matrix->numbers(16);
    glm::dmat4 m;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) m[column][row] = v[std::size_t(column * 4 + row)];
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
      matrix->fail("its last row must be 0 0 0 1: only affine transforms are possible");
    return m;
  }
  const auto numbers = [&](std::string_view key, const std::vector<float>& fallback) {
    const std::optional<JsonValue> member = node.find(key);
    return member ? member->numbers(fallback.size()) : fallback;
  };
  return transformOf(numbers("translation", {0, 0, 0}), numbers("rotation", {0, 0, 0, 1}),
                     numbers("scale", {1, 1, 1}), node);
}

/// Walks the node tree and fills a scene.
class SceneBuilder {
 public:
  SceneBuilder(GltfDocument& document, Scene& scene, const Job& job)
      : document_(document),
        scene_(scene),
        job_(job),
        materials_(document, scene, job),
        meshes_(document, scene, materials_, job) {
    if (const std::optional<JsonValue> lights = findExtension(document.root(), "KHR_lights_punctual"))
      lights_ = lights->at("lights").elements();
  }

  void build() {
    struct Visit {
      std::size_t node;
      glm::dmat4 parent;
    };
    const std::vector<JsonValue>& nodes = document_.array("nodes");
    std::vector<bool> visited(nodes.size(), false);
    // A stack of our own: hostile files nest nodes deeper than calls may.
    std::vector<Visit> stack;
    const auto push = [&](const std::vector<std::size_t>& indices, const glm::dmat4& parent) {
      for (auto i = indices.rbegin(); i != indices.rend(); ++i) stack.push_back({*i, parent});
    };
    push(rootNodes(), glm::dmat4(1.0));
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const JsonValue& node = nodes[visit.node];
      if (visited[visit.node])
        node.fail("is reached twice: nodes must form a tree, each with one parent and no cycle");
      visited[visit.node] = true;
      job_.throwIfStopped();
      const glm::dmat4 world = visit.parent * localTransform(node);
      place(node, world);
      push(nodeList(node, "children"), world);
    }
    materials_.decodeTextures();
  }

 private:
  std::vector<std::size_t> nodeList(const JsonValue& object, std::string_view key) const {
    std::vector<std::size_t> list;
    const std::optional<JsonValue> member = object.find(key);
    if (!member) return list;
    const std::size_t count = document_.array("nodes").size();
    for (const JsonValue& element : member->elements()) {
      const double number = element.json().is_number() ? element.json().get<double>() : -1.0;
      if (!(number >= 0.0 && number < double(count) && number == std::floor(number)))
        element.fail("names no node; there are {}", count);
      list.push_back(std::size_t(number));
    }
    return list;
  }

  std::vector<std::size_t> rootNodes() const {
    const std::vector<JsonValue>& scenes = document_.array("scenes");
    const std::optional<std::size_t> chosen = findIndex(document_, document_.root(), "scene", "scenes");
    if (!scenes.empty()) return nodeList(scenes[chosen.value_or(0)], "nodes");
    std::vector<bool> isChild(document_.array("nodes").size(), false);
    for (const JsonValue& node : document_.array("nodes"))
      for (const std::size_t child : nodeList(node, "children")) isChild[child] = true;
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < isChild.size(); ++i)
      if (!isChild[i]) roots.push_back(i);
    return roots;
  }

  void place(const JsonValue& node, const glm::dmat4& world) {
    const std::string name = nameOf(node, node.place());
    if (const std::optional<std::size_t> mesh = findIndex(document_, node, "mesh", "meshes")) {
      const std::optional<JsonValue> instancing = findExtension(node, "EXT_mesh_gpu_instancing");
      const std::vector<glm::dmat4> copies =
          instancing ? copiesOf(*instancing) : std::vector{glm::dmat4(1.0)};
      for (const glm::dmat4& copy : copies)
        for (const std::uint32_t m : meshes_.use(*mesh)) addInstance(name, m, world * copy);
    }
    if (const std::optional<std::size_t> camera = findIndex(document_, node, "camera", "cameras"))
      addCamera(document_.array("cameras")[*camera], name, world);
    if (const std::optional<JsonValue> light = findExtension(node, "KHR_lights_punctual"))
      addLight(*light, world);
  }

  /// Nodes may share meshes and the attributes of copies, so that a small file can ask for much memory.
  void takeMemory(std::uint64_t bytes) {
    usedBytes_ += bytes;
    if (usedBytes_ > job_.memoryBudgetBytes)
      fail(ErrorKind::kResources, document_.file(),
           "its instances need more than the memory budget of {} MiB", job_.memoryBudgetBytes >> 20);
  }

  void addInstance(const std::string& name, std::uint32_t mesh, const glm::dmat4& world) {
    takeMemory(sizeof(Instance) + name.size());
    Instance instance;
    instance.name = name;
    instance.mesh = mesh;
    instance.worldFromObject = mat4x3(world);
    scene_.instances.push_back(std::move(instance));
  }

  /// EXT_mesh_gpu_instancing: one transform for each copy, relative to the node.
  std::vector<glm::dmat4> copiesOf(const JsonValue& instancing) {
    const JsonValue attributes = instancing.at("attributes");
    std::optional<std::size_t> count;
    const auto open = [&](std::string_view key, int components) -> std::optional<GltfAccessor> {
      const std::optional<std::size_t> index = findIndex(document_, attributes, key, "accessors");
      if (!index) return std::nullopt;
      GltfAccessor accessor(document_, *index, attributes.at(key), components);
      if (count.value_or(accessor.size()) != accessor.size())
        attributes.at(key).fail("has {} elements, but another attribute has {}", accessor.size(), *count);
      count = accessor.size();
      return accessor;
    };
    const std::optional<GltfAccessor> translation = open("TRANSLATION", 3);
    const std::optional<GltfAccessor> rotation = open("ROTATION", 4);
    const std::optional<GltfAccessor> scale = open("SCALE", 3);
    takeMemory(count.value_or(1) * sizeof(glm::dmat4));
    std::vector<glm::dmat4> copies;
    for (std::size_t i = 0; i < count.value_or(1); ++i) {
      const auto element = [i](const std::optional<GltfAccessor>& accessor, std::vector<float> fallback) {
        for (std::size_t k = 0; accessor && k < fallback.size(); ++k)
          fallback[k] = accessor->number(i, int(k));
        return fallback;
      };
      copies.push_back(transformOf(element(translation, {0, 0, 0}), element(rotation, {0, 0, 0, 1}),
                                   element(scale, {1, 1, 1}), attributes));
    }
    return copies;
  }

  void addCamera(const JsonValue& json, const std::string& nodeName, const glm::dmat4& world) {
    Camera camera;
    camera.name = nameOf(json, nodeName);
    const auto isTaken = [&](const std::string& name) {
      return std::any_of(scene_.cameras.begin(), scene_.cameras.end(),
                         [&](const Camera& other) { return other.name == name; });
    };
    if (isTaken(camera.name)) camera.name = nodeName;
    camera.eye = vec3(world[3]);
    // The target only gives the direction; it lies far enough off to differ from the eye in floats.
    const glm::dvec3 forward = -glm::normalize(glm::dvec3(world[2]));
    camera.target =
        vec3(glm::dvec3(world[3]) + forward * std::max(1.0, 1e-3 * glm::length(glm::dvec3(world[3]))));
    camera.up = vec3(glm::normalize(glm::dvec3(world[1])));
    const std::string type = json.at("type").string();
    if (type == "perspective") {
      const JsonValue perspective = json.at("perspective");
      camera.verticalFovDegrees = perspective.at("yfov").positive() * (180.0f / kPi);
      if (!(camera.verticalFovDegrees < 180.0f)) perspective.at("yfov").fail("must be less than pi");
      if (const std::optional<JsonValue> aspect = perspective.find("aspectRatio"))
        camera.aspect = aspect->positive();
    } else if (type == "orthographic") {
      const JsonValue orthographic = json.at("orthographic");
      const float halfHeight = orthographic.at("ymag").positive();
      camera.orthographicHeight = 2.0f * halfHeight;
      camera.aspect = orthographic.at("xmag").positive() / halfHeight;
    } else {
      json.at("type").fail("\"{}\" is neither perspective nor orthographic", type);
    }
    scene_.cameras.push_back(std::move(camera));
  }

  void addLight(const JsonValue& reference, const glm::dmat4& world) {
    const std::uint64_t index = wholeNumber(reference, "light");
    if (index >= lights_.size())
      reference.at("light").fail("names light {}, but there are only {}", index, lights_.size());
    const JsonValue& json = lights_[index];

    Light light{};
    light.position = vec3(world[3]);
    const std::optional<JsonValue> colour = json.find("color");
    light.colour = (colour ? colour->colour() : vec3(1.0f)) * numberOr(json, "intensity", 1.0f, 0.0, 1e12);
    const std::string type = json.at("type").string();
    if (type == "point") {
      light.type = kLightPoint;
    } else if (type == "directional" || type == "spot") {
      light.type = type == "spot" ? kLightSpot : kLightDirectional;
      const glm::dvec3 along(world[2]);
      if (!(glm::length(along) > 0.0))
        reference.fail("is on a node scaled to nothing, which gives its light no direction");
      light.direction = vec3(-glm::normalize(along));
    } else {
      json.at("type").fail("\"{}\" is none of point, spot and directional", type);
    }
    if (light.type == kLightSpot) readCone(json, light);
    scene_.lights.push_back(light);
  }

  static void readCone(const JsonValue& json, Light& light) {
    const std::optional<JsonValue> spot = json.find("spot");
    const double halfPi = 1.5707964;  // as a float rounds it, upwards
    const float inner = spot ? numberOr(*spot, "innerConeAngle", 0.0f, 0.0, halfPi) : 0.0f;
    const float outer = spot ? numberOr(*spot, "outerConeAngle", kPi / 4.0f, 0.0, halfPi) : kPi / 4.0f;
    if (inner > outer)
      spot->fail("has an inner cone angle of {}, larger than the outer one of {}", inner, outer);
    light.cosInner = std::cos(inner);
    light.cosOuter = std::cos(outer);
  }

  GltfDocument& document_;
  Scene& scene_;
  const Job& job_;
  GltfMaterials materials_;
  GltfMeshes meshes_;
  std::vector<JsonValue> lights_;
  std::uint64_t usedBytes_ = 0;  ///< By instances.
};

}  // namespace

Scene loadGltf(const std::filesystem::path& file, const Job& job) {
  GltfDocument document(file, job.memoryBudgetBytes);
  checkExtensions(document, job);
  Scene scene;
  scene.name = file.stem().string();
  SceneBuilder(document, scene, job).build();
  return scene;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "api/content.h"
#include "isophote/world.h"
#include "scene/light_power.h"

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

constexpr const char* kSubject = "world";

vec3 finite(Float3 v, const char* what) {
  if (!(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2])))
    failInput(kSubject, "{} must be three finite numbers, but is ({}, {}, {})", what, v[0], v[1], v[2]);
  return api::vectorOf(v);
}

vec3 colour(Float3 v, const char* what) {
  const vec3 c = finite(v, what);
  if (min(c.x, min(c.y, c.z)) < 0.0f)
    failInput(kSubject, "{} must not be negative, but is ({}, {}, {})", what, c.x, c.y, c.z);
  return c;
}

vec3 unit(Float3 v, const char* what) {
  const vec3 d = finite(v, what);
  const float size = length(d);
  if (!(size > 1e-12f)) failInput(kSubject, "{} must not be zero", what);
  return d / size;
}

float within(float value, float low, float high, const char* what) {
  if (!(value >= low && value <= high))
    failInput(kSubject, "{} must be {} to {}, but is {}", what, low, high, value);
  return value;
}

void setTextures(Material& m, const MaterialData& data, std::size_t count) {
  const auto set = [&](int& texture, std::uint32_t index, const char* what) {
    if (index != kNoTexture && index >= count)
      failInput(kSubject, "{} is texture {}, but {} were added", what, index, count);
    texture = index == kNoTexture ? -1 : int(index);
  };
  set(m.baseColourTexture, data.baseColourTexture, "baseColourTexture");
  set(m.metallicRoughnessTexture, data.metallicRoughnessTexture, "metallicRoughnessTexture");
  set(m.normalTexture, data.normalTexture, "normalTexture");
  set(m.emissionTexture, data.emissionTexture, "emissionTexture");
  set(m.transmissionTexture, data.transmissionTexture, "transmissionTexture");
  set(m.specularTexture, data.specularTexture, "specularTexture");
  set(m.specularColourTexture, data.specularColourTexture, "specularColourTexture");
}

/// Numbers of a vertex attribute, `width` a vertex; as many as there are vertices, or none.
template <class Vector>
std::vector<Vector> attribute(std::span<const float> numbers, std::size_t vertices, const MeshData& mesh,
                              const char* what) {
  constexpr std::size_t width = sizeof(Vector) / sizeof(float);
  if (numbers.empty()) return {};
  if (numbers.size() != vertices * width)
    failInput(kSubject, "mesh \"{}\" has {} numbers of {}; its {} vertices want {}", mesh.name,
              numbers.size(), what, vertices, vertices * width);
  std::vector<Vector> vectors(vertices);
  for (std::size_t i = 0; i < vertices; ++i)
    for (std::size_t k = 0; k < width; ++k) vectors[i][int(k)] = numbers[i * width + k];
  return vectors;
}

}  // namespace

Camera api::cameraOf(const View& view) {
  Camera camera;
  camera.name = view.name;
  camera.eye = finite(view.eye, "the view's eye");
  camera.target = finite(view.target, "the view's target");
  if (camera.eye == camera.target) failInput(kSubject, "the view's target must differ from its eye");
  camera.up = unit(view.up, "the view's up");
  if (length(cross(camera.up, normalize(camera.target - camera.eye))) < 1e-4f)
    failInput(kSubject, "the view's up must not be parallel to its direction");
  if (view.orthographicHeight != 0.0f)
    camera.orthographicHeight = within(view.orthographicHeight, 1e-6f, 1e9f, "the view's orthographicHeight");
  camera.verticalFovDegrees = within(view.verticalFovDegrees, 0.1f, 179.0f, "the view's verticalFovDegrees");
  camera.aspect = view.aspect != 0.0f ? within(view.aspect, 1e-3f, 1e3f, "the view's aspect") : 0.0f;
  return camera;
}

struct WorldBuilder::Parts {
  Scene scene;
};

WorldBuilder::WorldBuilder() : parts_(std::make_unique<Parts>()) {}
WorldBuilder::~WorldBuilder() = default;
WorldBuilder::WorldBuilder(WorldBuilder&&) noexcept = default;
WorldBuilder& WorldBuilder::operator=(WorldBuilder&&) noexcept = default;

std::uint32_t WorldBuilder::addTexture(const TextureData& data) {
  return api::guarded([&] {
    Scene& scene = parts_->scene;
    if (data.width < 1 || data.height < 1 || data.width > 65536 || data.height > 65536)
      failInput(kSubject, "texture \"{}\" must have 1 to 65536 pixels a side, but has {} x {}", data.name,
                data.width, data.height);
    const std::size_t bytes = std::size_t(data.width) * std::size_t(data.height) * 4;
    if (data.rgba.size() != bytes)
      failInput(kSubject, "texture \"{}\" has {} bytes; {} x {} pixels want {}", data.name, data.rgba.size(),
                data.width, data.height, bytes);
    Texture texture;
    texture.name = data.name;
    texture.width = data.width;
    texture.height = data.height;
    texture.rgba.assign(data.rgba.begin(), data.rgba.end());
    texture.srgb = data.srgb;
    texture.wrapU = texture.wrapV = data.repeat ? Wrap::kRepeat : Wrap::kClamp;
    texture.nearest = data.nearest;
    scene.textures.push_back(std::move(texture));
    return std::uint32_t(scene.textures.size() - 1);
  });
}

std::uint32_t WorldBuilder::addMaterial(const MaterialData& data) {
  return api::guarded([&] {
    Scene& scene = parts_->scene;
    NamedMaterial m;
    static_cast<Material&>(m) = makeMaterial();
    m.name = data.name;
    m.baseColour = colour(data.baseColour, "baseColour");
    within(maxOf(m.baseColour), 0.0f, 1.0f, "the largest component of baseColour");
    m.metallic = within(data.metallic, 0.0f, 1.0f, "metallic");
    m.roughness = within(data.roughness, 0.0f, 1.0f, "roughness");
    m.specular = within(data.specular, 0.0f, 1.0f, "specular");
    m.transmission = within(data.transmission, 0.0f, 1.0f, "transmission");
    m.ior = within(data.ior, 1.0f, 10.0f, "ior");
    m.specularColour = colour(data.specularColour, "specularColour");
    m.absorption = colour(data.absorption, "absorption");
    m.emission = colour(data.emission, "emission");
    m.alpha = within(data.alpha, 0.0f, 1.0f, "alpha");
    m.alphaCutoff = within(data.alphaCutoff, 0.0f, 1.0f, "alphaCutoff");
    m.normalScale = within(data.normalScale, -100.0f, 100.0f, "normalScale");
    if (data.coverage == Coverage::kMask) m.flags |= kMaterialAlphaMask;
    if (data.coverage == Coverage::kBlend) m.flags |= kMaterialAlphaBlend;
    if (data.thinWalled) m.flags |= kMaterialThinWalled;
    if (data.unlit) m.flags |= kMaterialUnlit;
    if (data.emitsFromBothSides) m.flags |= kMaterialDoubleSided;
    setTextures(m, data, scene.textures.size());
    scene.materials.push_back(std::move(m));
    return std::uint32_t(scene.materials.size() - 1);
  });
}

std::uint32_t WorldBuilder::addMesh(const MeshData& data) {
  return api::guarded([&] {
    Scene& scene = parts_->scene;
    if (data.positions.empty() || data.positions.size() % 3 != 0 || data.triangles.size() % 3 != 0)
      failInput(kSubject,
                "mesh \"{}\" has {} numbers of positions and {} indices; both must be multiples of 3, and "
                "positions not empty",
                data.name, data.positions.size(), data.triangles.size());
    if (data.material >= scene.materials.size())
      failInput(kSubject, "mesh \"{}\" names material {}, but {} were added", data.name, data.material,
                scene.materials.size());
    const std::size_t vertices = data.positions.size() / 3;
    Mesh mesh;
    mesh.name = data.name;
    mesh.material = data.material;
    mesh.positions = attribute<vec3>(data.positions, vertices, data, "positions");
    mesh.normals = attribute<vec3>(data.normals, vertices, data, "normals");
    mesh.uvs = attribute<vec2>(data.uvs, vertices, data, "uvs");
    mesh.tangents = attribute<vec4>(data.tangents, vertices, data, "tangents");
    mesh.colours = attribute<vec4>(data.colours, vertices, data, "colours");
    mesh.triangles.resize(data.triangles.size() / 3);
    for (std::size_t i = 0; i < data.triangles.size(); ++i) {
      if (data.triangles[i] >= vertices)
        failInput(kSubject, "mesh \"{}\": index {} is vertex {}, but there are {}", data.name, i,
                  data.triangles[i], vertices);
      mesh.triangles[i / 3][int(i % 3)] = data.triangles[i];
    }
    scene.meshes.push_back(std::move(mesh));
    return std::uint32_t(scene.meshes.size() - 1);
  });
}

std::uint32_t WorldBuilder::addInstance(std::uint32_t mesh, const Transform& t, std::string name) {
  return api::guarded([&] {
    Scene& scene = parts_->scene;
    if (mesh >= scene.meshes.size())
      failInput(kSubject, "instance \"{}\" names mesh {}, but {} were added", name, mesh,
                scene.meshes.size());
    Instance instance;
    instance.name = std::move(name);
    instance.mesh = mesh;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        instance.worldFromObject[int(column)][int(row)] = t[row * 4 + column];
    scene.instances.push_back(std::move(instance));
    return std::uint32_t(scene.instances.size() - 1);
  });
}

void WorldBuilder::addPointLight(Float3 position, Float3 watts, float radius) {
  Light light{};
  light.type = kLightPoint;
  light.position = finite(position, "a point light's position");
  light.colour = colour(watts, "a point light's watts") / (4.0f * kPi);
  light.radius = within(radius, 0.0f, 1e6f, "a point light's radius");
  parts_->scene.lights.push_back(light);
}

void WorldBuilder::addSpotLight(Float3 position, Float3 direction, Float3 watts, float innerDegrees,
                                float outerDegrees) {
  within(outerDegrees, 0.1f, 90.0f, "a spot light's outerDegrees");
  within(innerDegrees, 0.0f, outerDegrees, "a spot light's innerDegrees");
  Light light = spotLight(innerDegrees, outerDegrees, colour(watts, "a spot light's watts"));
  light.position = finite(position, "a spot light's position");
  light.direction = unit(direction, "a spot light's direction");
  parts_->scene.lights.push_back(light);
}

void WorldBuilder::addDirectionalLight(Float3 direction, Float3 irradiance) {
  Light light{};
  light.type = kLightDirectional;
  light.direction = unit(direction, "a directional light's direction");
  light.colour = colour(irradiance, "a directional light's irradiance");
  parts_->scene.lights.push_back(light);
}

void WorldBuilder::addRectangleLight(Float3 centre, Float3 edgeU, Float3 edgeV, Float3 radiance) {
  Light light{};
  light.type = kLightRectangle;
  light.edgeU = finite(edgeU, "a rectangle light's edgeU");
  light.edgeV = finite(edgeV, "a rectangle light's edgeV");
  const vec3 normal = cross(light.edgeU, light.edgeV);
  light.area = length(normal);
  if (!(light.area > 1e-12f)) failInput(kSubject, "a rectangle light's edges must span an area");
  if (abs(dot(light.edgeU, light.edgeV)) > 1e-3f * light.area)
    failInput(kSubject, "a rectangle light's edges must be perpendicular");
  light.direction = normal / light.area;
  light.position = finite(centre, "a rectangle light's centre") - 0.5f * (light.edgeU + light.edgeV);
  light.colour = colour(radiance, "a rectangle light's radiance");
  parts_->scene.lights.push_back(light);
}

namespace {

void addEnvironment(Scene& scene, const Light& light) {
  if (std::any_of(scene.lights.begin(), scene.lights.end(),
                  [](const Light& l) { return l.type == kLightEnvironment; }))
    failInput(kSubject, "there is an environment light already: one at most is possible");
  scene.lights.push_back(light);
}

}  // namespace

void WorldBuilder::addEnvironmentLight(Float3 radiance) {
  addEnvironment(parts_->scene,
                 environmentLight(colour(radiance, "an environment light's radiance"), false, 0.0));
}

void WorldBuilder::addEnvironmentLight(int width, int height, std::span<const float> radiance,
                                       float rotationDegrees) {
  api::guarded([&] {
    within(float(min(width, height)), 1.0f, 65536.0f, "an environment map's width and height");
    within(float(max(width, height)), 1.0f, 65536.0f, "an environment map's width and height");
    if (radiance.size() != std::size_t(width) * std::size_t(height) * 3)
      failInput(kSubject, "an environment map of {} x {} pixels wants 3 numbers each, but has {}", width,
                height, radiance.size());
    Image map(width, height);
    for (std::size_t i = 0; i < map.pixels.size(); ++i)
      map.pixels[i] =
          colour({radiance[3 * i], radiance[3 * i + 1], radiance[3 * i + 2]}, "an environment map's pixel");
    within(rotationDegrees, -360.0f, 360.0f, "an environment map's rotationDegrees");
    addEnvironment(parts_->scene, environmentLight(vec3(1.0f), true, double(rotationDegrees)));
    parts_->scene.environment.radiance = std::move(map);
  });
}

void WorldBuilder::addView(const View& view) { parts_->scene.cameras.push_back(api::cameraOf(view)); }

World WorldBuilder::build(const Job& job) {
  return api::guarded([&] {
    Scene scene = std::move(parts_->scene);
    parts_ = std::make_unique<Parts>();
    finishScene(scene, kSubject, job);
    return World(std::make_shared<const World::Content>(World::Content{std::move(scene)}));
  });
}

}  // namespace isophote

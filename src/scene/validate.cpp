// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/validate.h"

#include "base/error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace isophote {

namespace {

bool isFinite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// False for NaN too.
bool isCoordinate(vec3 v) {
  return abs(v.x) <= kLargestCoordinate && abs(v.y) <= kLargestCoordinate && abs(v.z) <= kLargestCoordinate;
}

std::string label(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {} \"{}\"", kind, index, name);
}

/// Gives vertices whose normal has no length the area-weighted normal of their triangles.
void replaceZeroNormals(Mesh& mesh) {
  std::vector<vec3> sums(mesh.positions.size(), vec3(0.0f));
  for (const uvec3& t : mesh.triangles) {
    const vec3 origin = mesh.positions[t.x];
    const vec3 n = cross(mesh.positions[t.y] - origin, mesh.positions[t.z] - origin);
    for (int k = 0; k < 3; ++k) sums[t[k]] += n;
  }
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (mesh.normals[i] != vec3(0.0f)) continue;
    const float size = length(sums[i]);
    mesh.normals[i] = size > 0.0f ? sums[i] / size : vec3(0.0f, 1.0f, 0.0f);
  }
}

void validateNormals(Mesh& mesh, const std::string& subject, const std::string& element) {
  if (mesh.normals.empty()) return;
  if (mesh.normals.size() != mesh.positions.size())
    failInput(subject, "{} has {} normals for {} positions; give one a position or none", element,
              mesh.normals.size(), mesh.positions.size());
  bool anyZero = false;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    vec3& n = mesh.normals[i];
    if (!isFinite(n)) failInput(subject, "{}, normal of vertex {} is not a finite number", element, i);
    // Scaled first, so that neither tiny nor huge normals leave the range of floats.
    const float largest = max(abs(n.x), max(abs(n.y), abs(n.z)));
    anyZero |= largest == 0.0f;
    if (largest > 0.0f) n = normalize(n / largest);
  }
  if (anyZero) replaceZeroNormals(mesh);
}

void validateTangents(Mesh& mesh, const std::string& subject, const std::string& element) {
  if (mesh.tangents.empty()) return;
  if (mesh.tangents.size() != mesh.positions.size())
    failInput(subject, "{} has {} tangents for {} positions; give one a position or none", element,
              mesh.tangents.size(), mesh.positions.size());
  bool complete = true;
  for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
    const vec3 t(mesh.tangents[i]);
    const float w = mesh.tangents[i].w;
    if (!isFinite(t) || !std::isfinite(w))
      failInput(subject, "{}, tangent of vertex {} is not a finite number", element, i);
    const float largest = max(abs(t.x), max(abs(t.y), abs(t.z)));
    complete &= largest > 0.0f;
    if (largest > 0.0f) mesh.tangents[i] = vec4(normalize(t / largest), w < 0.0f ? -1.0f : 1.0f);
  }
  // A tangent without length is an exporter's mistake; those that follow from the coordinates serve.
  if (!complete) mesh.tangents.clear();
}

void validateColours(Mesh& mesh, const std::string& subject, const std::string& element) {
  if (mesh.colours.empty()) return;
  if (mesh.colours.size() != mesh.positions.size())
    failInput(subject, "{} has {} vertex colours for {} positions; give one a position or none", element,
              mesh.colours.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.colours.size(); ++i) {
    vec4& c = mesh.colours[i];
    if (!isFinite(vec3(c)) || !std::isfinite(c.w))
      failInput(subject, "{}, colour of vertex {} is not a finite number", element, i);
    c = clamp(c, vec4(0.0f), vec4(1.0f));
  }
}

void validateMesh(const Scene& scene, Mesh& mesh, const std::string& subject, const std::string& element) {
  if (mesh.material >= scene.materials.size())
    failInput(subject, "{} names material {}, but there are only {}", element, mesh.material,
              scene.materials.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const vec3 p = mesh.positions[i];
    if (!isFinite(p)) failInput(subject, "{}, vertex {}: the position is not a finite number", element, i);
    if (!isCoordinate(p))
      failInput(subject, "{}, vertex {}: position {} is too far away; coordinates must stay below {:g} m",
                element, i, fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z), kLargestCoordinate);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const uvec3 t = mesh.triangles[i];
    const uint largest = max(t.x, max(t.y, t.z));
    if (largest >= mesh.positions.size())
      failInput(subject, "{}, triangle {} names vertex {}, but there are only {}", element, i, largest,
                mesh.positions.size());
  }
  if (!mesh.uvs.empty() && mesh.uvs.size() != mesh.positions.size())
    failInput(subject, "{} has {} texture coordinates for {} positions; give one a position or none", element,
              mesh.uvs.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
    if (!isCoordinate(vec3(mesh.uvs[i], 0.0f)))
      failInput(subject, "{}, vertex {}: the texture coordinate is not a usable number", element, i);
  validateNormals(mesh, subject, element);
  validateTangents(mesh, subject, element);
  validateColours(mesh, subject, element);
}

/// Clamps a factor into [0, 1]; returns whether it had to.
bool clampFactor(float& factor) {
  const float clamped = clamp(factor, 0.0f, 1.0f);
  const bool changed = clamped != factor;
  factor = clamped;
  return changed;
}

void validateMaterial(const Scene& scene, NamedMaterial& m, const std::string& subject,
                      const std::string& element, const Job& job) {
  const float numbers[] = {m.metallic, m.roughness,   m.transmission, m.specular,
                           m.alpha,    m.alphaCutoff, m.normalScale,  m.ior};
  for (const float number : numbers)
    if (!std::isfinite(number)) failInput(subject, "{} has a number that is not finite", element);
  if (!isFinite(m.baseColour) || !isFinite(m.emission) || !isFinite(m.specularColour))
    failInput(subject, "{} has a colour that is not finite", element);
  for (int k = 0; k < 3; ++k)
    if (m.emission[k] < 0.0f || m.emission[k] > kLargestCoordinate)
      failInput(subject, "{} emits {:g} W/(m^2 sr); radiance must be from 0 to {:g}", element, m.emission[k],
                kLargestCoordinate);
  for (int k = 0; k < 3; ++k) {
    if (!(m.absorption[k] >= 0.0f))
      failInput(subject, "{} absorbs {:g} of the light a metre; it must not be negative", element,
                m.absorption[k]);
    // What lets nothing through over a nanometre lets nothing through at all; floats stay in range.
    m.absorption[k] = min(m.absorption[k], 1e9f);
    m.specularColour[k] = clamp(m.specularColour[k], 0.0f, kLargestCoordinate);
  }
  if (m.ior < 0.1f || m.ior > 100.0f)
    failInput(subject, "{} has index of refraction {:g}; it must be from 0.1 to 100", element, m.ior);
  bool clamped = false;
  for (float* factor : {&m.metallic, &m.roughness, &m.transmission, &m.specular, &m.alpha, &m.baseColour.x,
                        &m.baseColour.y, &m.baseColour.z})
    clamped |= clampFactor(*factor);
  if (clamped) job.warn(fmt::format("{}: {} has factors outside 0 to 1; they are clamped", subject, element));
  const int count = int(scene.textures.size());
  for (const int texture :
       {m.baseColourTexture, m.metallicRoughnessTexture, m.emissionTexture, m.normalTexture,
        m.transmissionTexture, m.specularTexture, m.specularColourTexture})
    if (texture < -1 || texture >= count)
      failInput(subject, "{} names texture {}, but there are only {}", element, texture, count);
  for (const int texture :
       {m.baseColourTexture, m.metallicRoughnessTexture, m.normalTexture, m.transmissionTexture})
    if (texture >= 0 && !scene.textures[std::size_t(texture)].floats.empty())
      failInput(subject, "{} uses texture {} of floats for something else than emission", element, texture);
}

void validateTexture(const Texture& texture, const std::string& subject, const std::string& element) {
  constexpr int kLargest = 1 << 16;
  if (texture.width < 1 || texture.height < 1 || texture.width > kLargest || texture.height > kLargest)
    failInput(subject, "{} is {} x {} pixels; from 1 to {} each way are possible", element, texture.width,
              texture.height, kLargest);
  const std::size_t texels = std::size_t(texture.width) * std::size_t(texture.height);
  if (texture.floats.empty() ? texture.rgba.size() != texels * 4 : texture.floats.size() != texels)
    failInput(subject, "{} holds {} bytes, not width x height x 4", element, texture.rgba.size());
  for (const vec3 texel : texture.floats)
    if (!(texel.x >= 0.0f && texel.y >= 0.0f && texel.z >= 0.0f && isCoordinate(texel)))
      failInput(subject, "{} holds a texel that is negative or beyond {:g}", element, kLargestCoordinate);
}

void validateInstance(const Scene& scene, const Instance& instance, const std::string& subject,
                      const std::string& element) {
  if (instance.mesh >= scene.meshes.size())
    failInput(subject, "{} names mesh {}, but there are only {}", element, instance.mesh,
              scene.meshes.size());
  for (int column = 0; column < 4; ++column)
    if (!isCoordinate(instance.worldFromObject[column]))
      failInput(subject, "{} has a transform that is not finite or reaches beyond {:g} m", element,
                kLargestCoordinate);
}

void makeUnit(vec3& direction, const std::string& subject, const std::string& element) {
  const float size = isFinite(direction) ? length(direction) : 0.0f;
  if (!(size > 1e-18f && size < 1e18f))
    failInput(subject, "{} has direction ({:g}, {:g}, {:g}); it must be finite and not zero", element,
              direction.x, direction.y, direction.z);
  direction /= size;
}

void validateRectangle(Light& light, const std::string& subject, const std::string& element) {
  if (!isCoordinate(light.edgeU) || !isCoordinate(light.edgeV))
    failInput(subject, "{} has an edge that is not finite or too long", element);
  const vec3 normal = cross(light.edgeU, light.edgeV);
  const float area = length(normal);
  if (!(area > 0.0f && area <= std::numeric_limits<float>::max()))
    failInput(subject, "{} has no area; its edges must not be parallel or zero", element);
  light.direction = normal / area;
  light.area = area;
}

void validateEnvironment(const Scene& scene, const std::string& subject) {
  const auto isMapped = [](const Light& l) { return l.type == kLightEnvironment && l.mapped != 0u; };
  const auto mapped = std::count_if(scene.lights.begin(), scene.lights.end(), isMapped);
  if (mapped == 0) return;
  if (mapped > 1) failInput(subject, "{} environment lights have a map; one at most is possible", mapped);
  const Image& map = scene.environment.radiance;
  if (map.width < 1 || map.height < 1 ||
      map.pixels.size() != std::size_t(map.width) * std::size_t(map.height))
    failInput(subject, "the environment map is {} x {} pixels but holds {}", map.width, map.height,
              map.pixels.size());
  for (const vec3 texel : map.pixels)
    if (!(texel.x >= 0.0f && texel.y >= 0.0f && texel.z >= 0.0f && isCoordinate(texel)))
      failInput(subject, "the environment map holds a texel that is negative or beyond {:g}",
                kLargestCoordinate);
  const Light& light = *std::find_if(scene.lights.begin(), scene.lights.end(), isMapped);
  const vec3 products(dot(light.edgeU, light.edgeU) - 1.0f, dot(light.edgeV, light.edgeV) - 1.0f,
                      dot(light.edgeU, light.edgeV));
  if (!(length(products) < 1e-3f))
    failInput(subject,
              "the environment map's directions to its right and top must be perpendicular and unit");
}

void validateLight(Light& light, const std::string& subject, const std::string& element) {
  if (light.type > kLightEnvironment || light.type == kLightMesh)
    failInput(subject, "{} has unknown type {}; mesh lights come from emissive materials", element,
              light.type);
  if (!isCoordinate(light.position))
    failInput(subject, "{} has a position that is not finite or too far", element);
  for (int k = 0; k < 3; ++k)
    if (!(light.colour[k] >= 0.0f && light.colour[k] <= kLargestCoordinate))
      failInput(subject, "{} has strength {:g}; it must be from 0 to {:g}", element, light.colour[k],
                kLargestCoordinate);
  if (!(light.radius >= 0.0f && light.radius <= kLargestCoordinate))
    failInput(subject, "{} has radius {:g}; it must be zero or positive", element, light.radius);
  if (light.type == kLightSpot || light.type == kLightDirectional)
    makeUnit(light.direction, subject, element);
  if (light.type == kLightRectangle) validateRectangle(light, subject, element);
  if (light.type == kLightSpot && !(light.cosOuter >= -1.0f && light.cosOuter < 1.0f &&
                                    light.cosInner >= light.cosOuter && light.cosInner <= 1.0f))
    failInput(subject,
              "{} has cone angles out of order; 0 <= inner <= outer and 0 < outer <= 180 degrees must hold",
              element);
}

}  // namespace

void validateCamera(const Camera& c, const std::string& subject) {
  const std::string element = c.name.empty() ? "the camera" : fmt::format("camera \"{}\"", c.name);
  if (!isCoordinate(c.eye) || !isCoordinate(c.target) || !isFinite(c.up))
    failInput(subject, "{} has an eye, target or up vector that is not finite or too far away", element);
  if (c.eye == c.target) failInput(subject, "{} has eye and target at the same point; move one", element);
  if (!(c.aspect >= 0.0f && c.aspect <= 1e6f)) failInput(subject, "{} has aspect {:g}", element, c.aspect);
  if (!(c.orthographicHeight >= 0.0f && c.orthographicHeight <= kLargestCoordinate))
    failInput(subject, "{} has orthographic height {:g}; it must be positive", element, c.orthographicHeight);
  if (c.orthographicHeight == 0.0f && !(c.verticalFovDegrees > 0.0f && c.verticalFovDegrees < 180.0f))
    failInput(subject, "{} has a vertical field of view of {:g} degrees; it must lie between 0 and 180",
              element, c.verticalFovDegrees);
}

void validateScene(Scene& scene, const std::string& subject, const Job& job) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i)
    validateTexture(scene.textures[i], subject, label("texture", i, scene.textures[i].name));
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    validateMaterial(scene, scene.materials[i], subject, label("material", i, scene.materials[i].name), job);
  // The first mesh at fault is named whatever the number of threads: each keeps its own error.
  std::vector<std::exception_ptr> errors(scene.meshes.size());
  tbb::parallel_for(std::size_t(0), scene.meshes.size(), [&](std::size_t i) {
    try {
      job.throwIfStopped();
      validateMesh(scene, scene.meshes[i], subject, label("mesh", i, scene.meshes[i].name));
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  for (std::size_t i = 0; i < scene.instances.size(); ++i)
    validateInstance(scene, scene.instances[i], subject, label("instance", i, scene.instances[i].name));
  validateEnvironment(scene, subject);
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    validateLight(scene.lights[i], subject, fmt::format("light {}", i));
  for (const Camera& camera : scene.cameras) validateCamera(camera, subject);
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/large_pages.h"
#include "math/bounds.h"
#include "physics/camera.shared.h"
#include "physics/light.shared.h"
#include "physics/material.shared.h"
#include "scene/environment.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace isophote {

enum class Wrap : std::uint8_t { kRepeat, kClamp, kMirror };

/// An image, rows from the top: 8-bit RGBA, colours sRGB-encoded where `srgb` is set, or linear floats (only
/// for emission).
struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  LargeVector<std::uint8_t> rgba;  ///< width * height * 4; empty where there are floats.
  LargeVector<vec3> floats{};      ///< width * height, or none.
  bool srgb = true;
  Wrap wrapU = Wrap::kRepeat;
  Wrap wrapV = Wrap::kRepeat;
  bool nearest = false;  ///< Otherwise bilinear.
};

/// Triangles of one material in object space.
struct Mesh {
  std::string name;
  std::vector<vec3> positions;  ///< [m]
  std::vector<vec3> normals;    ///< Unit; empty: geometric normals. Otherwise one a position.
  std::vector<vec2> uvs;        ///< glTF convention: v grows downwards in the image. Empty or one a position.
  /// Unit along growing u; w = 1 or -1: the bitangent is cross(normal, tangent) * w. Empty: normal maps
  /// follow the texture coordinates. Otherwise one a position.
  std::vector<vec4> tangents{};
  std::vector<vec4> colours{};   ///< Linear, multiply base colour and alpha. Empty: white, or one a position.
  std::vector<uvec3> triangles;  ///< Indices into positions; counter-clockwise seen from the front.
  std::uint32_t material = 0;    ///< Index into Scene::materials.
};

struct Instance {
  std::string name;
  std::uint32_t mesh = 0;
  mat4x3 worldFromObject{1.0f};
};

struct NamedMaterial : Material {
  std::string name;
};

struct Camera {
  std::string name;
  vec3 eye{0, 0, 1};
  vec3 target{0};
  vec3 up{0, 1, 0};
  float verticalFovDegrees = 45;
  float aspect = 0;              ///< Width / height; 0: that of the picture.
  float orthographicHeight = 0;  ///< Height of the view [m]; 0: pinhole.
};

/// Everything that is rendered, in metres, Y up, right-handed, linear Rec.709.
struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<NamedMaterial> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;  ///< With power filled in by finishScene().
  std::vector<EmissiveTriangle> emissiveTriangles;
  std::vector<AliasSlot> emissiveAliases;  ///< One a triangle: chooses among those of a light.
  EnvironmentMap environment;              ///< Of the environment light that is `mapped`; else empty.
  std::vector<Camera> cameras;
  Bounds bounds;  ///< Of all instances, world space.
  /// Settings that the scene description asks for, as written ("stage.name" -> value as JSON text).
  std::vector<std::pair<std::string, std::string>> settings;
};

struct SceneOptions {
  std::vector<std::filesystem::path> assetFolders;  ///< Searched in order after the description's own folder.
};

/// Loads a .gltf, .glb, .obj or .json file, or builds the built-in scene of that name, and finishes it.
/// Throws Error(kBadInput) naming file and element; warnings go to job.log.
Scene loadScene(const std::string& nameOrPath, const SceneOptions& options = {}, const Job& job = {});

/// Computes what loaders leave open: bounds; mesh lights from emissive materials; a framing camera where
/// there is none; a default light with a warning where nothing emits; each light's power. Checks every index
/// and number (throws Error(kBadInput, subject, ...)).
void finishScene(Scene& scene, const std::string& subject, const Job& job = {});

/// Camera by name; empty: the first. Throws Error(kBadUsage) that lists the names.
const Camera& findCamera(const Scene& scene, const std::string& name);

/// Rays of `camera` for a picture of that size [pixels]. A camera's aspect never stretches the picture: the
/// vertical field of view holds.
CameraRays cameraRays(const Camera& camera, int width, int height);

/// Bytes of geometry and textures as stored here.
std::uint64_t sceneBytes(const Scene& scene);

}  // namespace isophote

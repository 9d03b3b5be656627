// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isophote/job.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// x, y, z in metres (Y up, right-handed), or red, green, blue in linear Rec.709.
using Float3 = std::array<float, 3>;

/// From where and how a world is seen.
struct View {
  std::string name = {};
  Float3 eye{0, 0, 1};  ///< [m]
  Float3 target{0, 0, 0};
  Float3 up{0, 1, 0};
  float verticalFovDegrees = 45;
  float aspect = 0;              ///< Width / height that it was made for; never stretches. 0: none.
  float orthographicHeight = 0;  ///< Height of the view [m]; 0: perspective.

  bool operator==(const View&) const = default;
};

/// A scene that is ready to be lit. Immutable and cheap to copy (copies share it); may be used by several
/// renderers and threads at once.
class World {
 public:
  /// Loads a .gltf, .glb, .obj or scene description (.json), or builds the built-in scene of that name
  /// ("cornell-box", ...). Files that a description names are searched beside it, then in `assetFolders`.
  /// Throws Error(kBadInput) naming file and element, Error(kResources), Error(kStopped).
  static World load(const std::string& nameOrPath,
                    const std::vector<std::filesystem::path>& assetFolders = {}, const Job& job = {});

  /// Its cameras, at least one: where the file has none, one that shows everything.
  std::vector<View> views() const;
  /// Corners of the box that holds everything [m].
  Float3 lowerCorner() const;
  Float3 upperCorner() const;
  std::uint64_t triangleCount() const;  ///< Each instance counted.
  std::size_t lightCount() const;
  std::uint64_t bytes() const;  ///< Of geometry and textures as kept.

  struct Content;  ///< The library's own.
  explicit World(std::shared_ptr<const Content> content) : content_(std::move(content)) {}
  const Content& content() const { return *content_; }
  const std::shared_ptr<const Content>& shared() const { return content_; }

 private:
  std::shared_ptr<const Content> content_;
};

/// Instead of what addTexture() returns: none.
inline constexpr std::uint32_t kNoTexture = 0xffffffffu;

/// 8-bit picture, rows from the top, 4 bytes (RGBA) a pixel; copied.
struct TextureData {
  std::string name = {};
  int width = 0;
  int height = 0;
  std::span<const std::uint8_t> rgba;  ///< width * height * 4
  bool srgb = true;                    ///< Colours are; roughness and the like are linear.
  bool repeat = true;                  ///< Outside of [0, 1]; otherwise its edge goes on.
  bool nearest = false;                ///< Otherwise bilinear.
};

enum class Coverage {
  kOpaque,
  kMask,  ///< Where alpha is below alphaCutoff, nothing is there.
  kBlend  ///< The part 1 - alpha of all light passes.
};

/// glTF's metallic-roughness material with its extensions; a texture multiplies its factor. Defaults reflect
/// 80 % diffusely.
struct MaterialData {
  std::string name = {};
  Float3 baseColour{0.8f, 0.8f, 0.8f};  ///< Reflectance [0, 1].
  float metallic = 0;                   ///< [0, 1]
  float roughness = 1;                  ///< [0, 1]; up to 0.03 a perfect mirror.
  float specular = 0;                   ///< Weight of a dielectric's reflection [0, 1]; 0: Lambertian.
  float transmission = 0;               ///< Part of the light that passes through [0, 1].
  float ior = 1.5f;                     ///< Index of refraction, at least 1.
  Float3 specularColour{1, 1, 1};       ///< Multiplies the dielectric's reflectance at normal incidence.
  Float3 absorption{0, 0, 0};           ///< What a solid that transmits takes by length [1/m].
  bool thinWalled = false;              ///< Transmits without refraction: a pane, not the skin of a solid.
  Float3 emission{0, 0, 0};             ///< Radiance [W/(m^2 sr)]; the surface becomes a light.
  bool emitsFromBothSides = false;
  bool unlit = false;  ///< Shows its base colour as it is and scatters nothing.
  Coverage coverage = Coverage::kOpaque;
  float alpha = 1;           ///< [0, 1], times the alpha of base colour texture and vertices.
  float alphaCutoff = 0.5f;  ///< [0, 1]
  float normalScale = 1;     ///< Of the normal texture's x and y.
  // What addTexture() returned; linear unless said otherwise.
  std::uint32_t baseColourTexture = kNoTexture;         ///< sRGB, and alpha.
  std::uint32_t metallicRoughnessTexture = kNoTexture;  ///< Roughness in G, metallic in B.
  std::uint32_t normalTexture = kNoTexture;             ///< glTF's: x along growing u, y along -v.
  std::uint32_t emissionTexture = kNoTexture;           ///< sRGB.
  std::uint32_t transmissionTexture = kNoTexture;       ///< In R.
  std::uint32_t specularTexture = kNoTexture;           ///< In A.
  std::uint32_t specularColourTexture = kNoTexture;     ///< sRGB.
};

/// Triangles of one material in object space; everything is copied.
struct MeshData {
  std::string name = {};
  std::span<const float> positions;     ///< 3 a vertex [m].
  std::span<const float> normals = {};  ///< 3 a vertex, unit; empty: flat.
  std::span<const float> uvs = {};      ///< 2 a vertex, v downwards in the picture; empty: none.
  /// 4 a vertex: unit along growing u, and 1 or -1 where the bitangent is plus or minus cross(normal,
  /// tangent). Empty: normal textures follow the uvs.
  std::span<const float> tangents = {};
  std::span<const float> colours = {};  ///< 4 a vertex, linear, times base colour and alpha; empty: white.
  std::span<const std::uint32_t> triangles;  ///< 3 vertices a triangle, counter-clockwise from the front.
  std::uint32_t material = 0;                ///< What addMaterial() returned.
};

/// Rows of the upper 3 x 4 of the matrix that takes column vectors of object space to world space.
using Transform = std::array<float, 12>;
inline constexpr Transform kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// Makes a world of what a program has in memory. A call that is given something out of range throws
/// Error(kBadInput) that names it.
class WorldBuilder {
 public:
  WorldBuilder();
  ~WorldBuilder();
  WorldBuilder(WorldBuilder&&) noexcept;
  WorldBuilder& operator=(WorldBuilder&&) noexcept;

  // Each returns the index by which others name what was added.
  std::uint32_t addTexture(const TextureData& texture);
  std::uint32_t addMaterial(const MaterialData& material);
  std::uint32_t addMesh(const MeshData& mesh);
  std::uint32_t addInstance(std::uint32_t mesh, const Transform& worldFromObject = kIdentity,
                            std::string name = {});

  /// Total flux `watts` the same in all directions; a sphere of `radius` [m] where that is not 0.
  void addPointLight(Float3 position, Float3 watts, float radius = 0);
  /// Total flux `watts` in a cone along `direction` (of travel); full up to `innerDegrees` from its axis,
  /// none from `outerDegrees` (at most 90) on.
  void addSpotLight(Float3 position, Float3 direction, Float3 watts, float innerDegrees, float outerDegrees);
  /// Parallel light along `direction`; `irradiance` [W/m^2] on a surface that faces it.
  void addDirectionalLight(Float3 direction, Float3 irradiance);
  /// One-sided diffuse emitter around `centre`; `direction` is its normal, edges [m] are perpendicular to it.
  void addRectangleLight(Float3 centre, Float3 edgeU, Float3 edgeV, Float3 radiance);
  /// The same `radiance` [W/(m^2 sr)] from everywhere outside.
  void addEnvironmentLight(Float3 radiance);
  /// A lat-long picture of what comes from outside: 3 numbers a pixel [W/(m^2 sr)], rows from straight up,
  /// its centre column towards -Z turned by `rotationDegrees` about Y. Copied.
  void addEnvironmentLight(int width, int height, std::span<const float> radiance, float rotationDegrees = 0);
  void addView(const View& view);

  /// The world of all that was added; the builder is empty afterwards. Without a view one is found that shows
  /// everything; without a light there is a default one and a warning. Throws Error(kBadInput).
  World build(const Job& job = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "scene/scene.h"
#include "scene/texture_sample.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace isophote {

inline constexpr std::uint32_t kNoHit = 0xffffffffu;

struct Ray {
  vec3 origin;
  float tMin = 0;
  vec3 direction;  ///< Unit.
  float tMax = 1e30f;
  std::uint32_t salt = 0;  ///< Keeps apart the chances of rays that are otherwise the same (Blended).
};

/// How a ray meets surfaces that are blended by their alpha.
enum class Blended : std::uint8_t {
  /// With the probability alpha, as a number decides that is hashed from the ray and the triangle: the mean
  /// is
  /// right, and a hit is one on an opaque surface.
  kByChance,
  /// Always, unless alpha is 0: the caller goes on through it with the part 1 - alpha.
  kAlways,
};

/// Unbounded rays side by side: where the first of them begins in each of six arrays, which hold 16 numbers
/// from there on at least, whether used or not.
struct RayColumns {
  const float* origin[3];
  const float* direction[3];
};

/// Where a ray met a triangle; `instance` is kNoHit where it met none.
struct Hit {
  float t = 1e30f;
  float u = 0;                      ///< Barycentric weight of the triangle's second vertex.
  float v = 0;                      ///< Of its third.
  std::uint32_t instance = kNoHit;  ///< Index into Scene::instances.
  std::uint32_t triangle = 0;       ///< Index into its mesh.

  bool valid() const { return instance != kNoHit; }
};

/// A triangle's vertices side by side: two cache lines on one page, where indices and vertex arrays are up to
/// ten lines on four pages, which cost a photon more than its shading. Directions and colours are packed so
/// that it stays two.
struct alignas(32) ShadedTriangle {
  vec3 position[3];
  uint normal[3];   ///< packDirection; kNoDirection where the mesh has none.
  uint tangent[3];  ///< packTangent; kNoDirection where normal maps have nothing to follow.
  uint colour[3];   ///< Linear, 8 bits a channel, red lowest, alpha highest; white where the mesh has none.
  vec2 uv[3];       ///< 0 where the mesh has none.
};

/// What it takes to scatter light at a hit.
enum class Scattering : std::uint8_t {
  kLambert,  ///< Nothing but diffuse reflection.
  kOpaque,   ///< Diffuse, glossy and mirror reflection.
  kAny,      ///< Anything else that a material has: hits are shaded one by one.
};

/// The part of a material that scatters light, gathered for loops over many hits. Textures that it does not
/// have are one white texel.
struct ShadedMaterial {
  vec3 baseColour;
  float metallic;
  float roughness;
  float specular;
  float ior;
  Scattering scattering;
  bool textured;        ///< Any of the three.
  bool textureOfMetal;  ///< The second.
  bool normalMapped;    ///< The third.
  bool blended;         ///< By its alpha.
  float normalScale;    ///< 0 without a normal map.
  TextureView colourTexture;
  TextureView metallicRoughnessTexture;
  TextureView normalTexture;
};

/// What shading at a hit reads of one instance, gathered so that a hit touches as little memory as possible.
struct ShadedInstance {
  const ShadedTriangle* triangles;  ///< In object space unless said otherwise.
  const Material* material;
  const ShadedMaterial* shadedMaterial;
  mat4x3 worldFromObject;
  mat3 normalFromObject;  ///< Cofactors of the linear part: the inverse transpose up to a positive factor.
  bool inWorldSpace;      ///< The triangles are, and want no transformation.
  bool coloured;          ///< The mesh has vertex colours.
};

class RasterScene;

/// The scene as a ray tracer sees it: a two-level hierarchy over instances (meshes used once are baked into
/// the top level, which saves their rays the transformation). Alpha-masked texels let rays pass. Immutable
/// but for where its lights stand: any number of threads may query it. Keeps a reference to `scene`, which
/// must outlive it. The only file that knows Embree is trace_scene.cpp.
class TraceScene {
 public:
  /// Builds the hierarchy on the calling thread's TBB arena; throws Error(kResources) when memory does not
  /// suffice.
  explicit TraceScene(const Scene& scene, const Job& job = {});
  ~TraceScene();
  TraceScene(const TraceScene&) = delete;
  TraceScene& operator=(const TraceScene&) = delete;

  Hit closestHit(const Ray& ray, Blended blended = Blended::kByChance) const;
  bool occluded(const Ray& ray) const;
  /// Up to 16 rays at once, faster when they are coherent. hits.size() == rays.size() <= 16.
  void closestHits(std::span<const Ray> rays, std::span<Hit> hits, bool coherent,
                   Blended blended = Blended::kByChance) const;
  /// As many rays as there are hits, at most 16.
  void closestHits(const RayColumns& rays, std::span<Hit> hits, bool coherent) const;
  /// occluded[i] becomes 1 where something lies on ray i, else 0. At most 16.
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> occluded) const;
  /// visible[i] becomes the part of the light that passes along ray i: 0 where something opaque lies on it,
  /// else the product of 1 - alpha over what is blended there. At most 16.
  void visibility(std::span<const Ray> rays, std::span<float> visible) const;
  /// Likewise of the rays whose bits are set in `wanted`, ray i up to distances[i]; there are 16 of
  /// `visible`, and those of the other rays become 0.
  void visibility(const RayColumns& rays, const float* distances, std::uint32_t wanted, float* visible) const;
  /// Alpha of a blended surface at a hit; 1 where it is none.
  float coverageAt(const Hit& hit) const;

  const Scene& scene() const { return scene_; }
  /// The scene's lights, in its order, as they stand now: what every stage lights with.
  std::span<const Light> lights() const { return lights_; }
  /// Puts a light elsewhere (scene/light_place.h) while nobody queries; the next frame sees it there. Nothing
  /// else of the scene depends on it.
  void setLight(std::size_t index, const Light& light) { lights_[index] = light; }
  /// Of all instances; ShadedInstance::triangles points into them.
  const ShadedTriangle* triangles() const { return triangles_.data(); }
  const ShadedInstance& instance(std::uint32_t index) const { return instances_[index]; }
  /// True where any solid absorbs light inside it.
  bool absorbs() const { return absorbs_; }
  /// True where any surface is blended.
  bool blends() const { return blends_; }

  /// The same triangles arranged for rasterising; built when first asked for.
  const RasterScene& raster() const;

 private:
  struct Embree;
  struct Sixteen;
  const Scene& scene_;
  std::vector<Light> lights_;
  LargeVector<ShadedTriangle> triangles_;  ///< Of all meshes that are placed.
  std::vector<ShadedMaterial> materials_;  ///< By material.
  std::vector<ShadedInstance> instances_;
  bool absorbs_ = false;
  bool blends_ = false;
  std::unique_ptr<Embree> embree_;
  mutable std::once_flag rasterOnce_;
  mutable std::unique_ptr<const RasterScene> raster_;
};

}  // namespace isophote

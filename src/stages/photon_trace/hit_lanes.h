// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Hits side by side, and the loops over them that scatter their photons. Each loop calls the shared
// functions once a lane and is compiled for every instruction set (math/simd.h); no lane depends on another,
// so that the sets differ in speed alone.
#pragma once

#include "physics/photon.shared.h"
#include "stages/photon_trace/path_columns.h"
#include "stages/photon_trace/path_random.h"
#include "stages/photon_trace/prefetch_queue.h"
#include "trace/shading_lanes.h"
#include "trace/trace_scene.h"

#include <cstdint>

namespace isophote {

/// Two vectors of the widest set: while the processor waits for the result of one, it works on the other.
inline constexpr std::uint32_t kHitLanes = 32;

template <class T>
using HitColumn = Lanes<T, kHitLanes>;
using HitVectors = Vec3Lanes<kHitLanes>;

/// Hits of one segment on their way through shading: add(), place(), arrive(), scatter(). Tracing
/// other rays between add() and place(), and between place() and arrive(), gives the memory that was
/// asked for time to arrive.
class HitLanes {
 public:
  /// Empties it for up to kHitLanes hits.
  void clear();
  /// Takes over the hit of the ray in slot `slot`, and asks for its triangle.
  void add(const TraceScene& trace, const Hit& hit, std::uint32_t slot, PrefetchQueue& queue);
  /// Finds where on its surface each hit lies, and asks for the texels there.
  void place(const TraceScene& trace, const PathColumns& paths, PrefetchQueue& queue);
  /// What is stored of the hits. Reads the texels.
  void arrive(const TraceScene& trace, PrefetchQueue& queue);
  /// After arrive(): scatters the photons with the random numbers of that event.
  void scatter(const PathRandom& random, std::uint32_t event);

  std::uint32_t count = 0;  ///< Hits. The lanes from here on hold some former ones.
  HitColumn<std::uint32_t> path, light;
  HitVectors power;          ///< [W] as the photon arrives; after scatter() as it leaves.
  HitColumn<float> density;  ///< Photon::pathDensity, likewise.
  HitColumn<float> mean;     ///< Of the channels of the power that arrived, before any absorption on the way.
  HitColumn<std::uint32_t> medium;  ///< PathColumns::medium, likewise; only where the scene absorbs.

  PointLanes<kHitLanes> points;  ///< From place().

  // From arrive().
  HitColumn<std::uint32_t> stores;  ///< 1 where the hit is kept as a photon.
  HitColumn<std::uint32_t> packedDirection, packedNormal;
  /// Times the power is stored: what a blended surface meets by chance counts for what it lets pass.
  HitColumn<float> storedShare;

  // From scatter().
  HitColumn<std::uint32_t> survives;  ///< 1 where the photon goes on, along this ray:
  HitVectors origin, direction;
  HitColumn<float> absorbed;  ///< What of `mean` the surface took, before roulette.

  /// Adds what the lanes of each hit hold to the lanes of `sum`.
  void addTo(HitColumn<float>& sum, const HitColumn<float>& lanes) const;

 private:
  friend struct HitLoops;
  friend struct DifferentialLoops;
  friend class DifferentialLanes;

  /// Of a lane that is not odd.
  SHARED_FN Bsdf opaqueBsdf(std::uint32_t i) const {
    Material m = makeMaterial();
    m.specular = specular_[i];
    m.ior = ior_[i];
    Bsdf b = bsdfFromMaterial(m, baseColour_[i], metallic_[i], roughness_[i], 0.0f);
    // As it is, but so the compiler knows it and drops all that is about transmission.
    b.through = 0.0f;
    b.transmission = vec3(0.0f);
    return b;
  }
  void transformTriangles(const TraceScene& trace);
  void loadTextures();
  void loadMaterials();
  void applyTextures(PrefetchQueue& queue);
  void shadeOdd(const TraceScene& trace, std::uint32_t lane);
  void scatterOdd(std::uint32_t lane);
  void absorb(const TraceScene& trace);
  void thinOut(const PathRandom& random, std::uint32_t event, std::uint32_t lane);

  bool textured_ = false;          ///< Any of the hits.
  bool textureOfMetal_ = false;    ///< Any has a metallic-roughness texture.
  bool normalMapped_ = false;      ///< Any has a normal map.
  bool coloured_ = false;          ///< Any has vertex colours.
  bool lambert_ = true;            ///< All of the hits.
  std::uint32_t transformed_ = 0;  ///< Bits of the lanes whose triangles are not in world space.
  std::uint32_t odd_ = 0;          ///< Bits of the lanes that are shaded one by one (Scattering::kAny).
  const ShadedMaterial* material_[kHitLanes];
  Hit hit_[kHitLanes];
  Bsdf bsdf_[kHitLanes];             ///< Of the odd lanes.
  HitColumn<float> solid_;           ///< Surface::solid of the odd lanes.
  HitColumn<std::uint32_t> inside_;  ///< What `medium` becomes inside them.
  HitColumn<int> slot_;
  HitColumn<int> firstWord_;  ///< Of the triangle, in TraceScene::triangles().
  TriangleLanes<kHitLanes> triangles_;
  HitVectors rayDirection_;
  HitVectors baseColour_;
  HitColumn<float> metallic_, roughness_, specular_, ior_;
  HitColumn<int> isLambert_;
  TextureLanes<kHitLanes> colourTexture_, metallicRoughnessTexture_, normalTexture_;
  HitColumn<float> normalScale_;
  HitColumn<float> random_[3];
  std::uint32_t attenuated_ = 0;  ///< Bits of the lanes that lost power on their way through a solid.
  HitColumn<float> left_;         ///< The part of the mean that they kept.
};

}  // namespace isophote

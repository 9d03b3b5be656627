// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Sixteen hits side by side, and the loops over them that scatter their photons. Each loop calls the shared
// functions once a lane and is compiled for every instruction set (math/simd.h); no lane depends on another,
// so that the sets differ in speed alone.
#pragma once

#include "physics/photon.shared.h"
#include "stages/photon_trace/path_random.h"
#include "trace/surface.h"
#include "trace/trace_scene.h"

#include <cstdint>

namespace isophote {

inline constexpr std::uint32_t kLanes = 16;

template <class T>
struct alignas(64) Lanes {
  T values[kLanes];
  SHARED_FN T& operator[](std::uint32_t i) { return values[i]; }
  SHARED_FN const T& operator[](std::uint32_t i) const { return values[i]; }
};

struct VectorLanes {
  Lanes<float> x, y, z;
  SHARED_FN vec3 operator[](std::uint32_t i) const { return vec3(x[i], y[i], z[i]); }
  SHARED_FN void set(std::uint32_t i, vec3 v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// A texture at each hit.
struct TextureLanes {
  const std::uint8_t* rgba[kLanes];
  Lanes<int> width, height;
  Lanes<int> repeatsU, repeatsV, mirrorsU, mirrorsV;
  Lanes<float> blends;
  Lanes<std::uint32_t> curve;
  Lanes<std::uint32_t> index[4];  ///< As TexelSquare.
  Lanes<float> weightX, weightY;
  Lanes<std::uint32_t> texel[4];
};

/// Hits of one segment on their way through shading: load(), place(), then finish() or scatter(). Tracing
/// other rays between load() and place(), and between place() and the last step, gives the memory that was
/// asked for time to arrive.
class HitLanes {
 public:
  void clear();
  /// Takes over a hit; its triangle should have been asked for (prefetchTriangle).
  void load(const TraceScene& trace, const Hit& hit, const vec3& rayDirection, std::uint32_t pathOfHit,
            const vec3& powerOfHit, float densityOfHit);
  /// Finds where on its surface each hit lies, and asks for the texels there.
  void place();
  /// What is stored of the hits. Reads the texels.
  void arrive(const TraceScene& trace);
  /// After arrive(): scatters the photons with the random numbers of that event.
  void scatter(const BlockRandom& random, std::uint32_t event);

  std::uint32_t count = 0;  ///< Hits. The lanes from here on hold some former ones.
  Lanes<std::uint32_t> path;
  VectorLanes power;     ///< [W] as the photon arrives; after scatter() as it leaves.
  Lanes<float> density;  ///< Photon::pathDensity, likewise.
  Lanes<float> mean;     ///< Of the channels of the power that arrived.

  // From arrive().
  VectorLanes position;
  Lanes<std::uint32_t> stores;  ///< 1 where the hit is kept as a photon.
  Lanes<std::uint32_t> packedDirection, packedNormal;

  // From scatter().
  Lanes<std::uint32_t> survives;  ///< 1 where the photon goes on, along this ray:
  VectorLanes origin, direction;
  Lanes<float> absorbed;  ///< What of `mean` the surface took, before roulette.

  /// The sum over the hits, in an order that every instruction set keeps.
  float sumOf(const Lanes<float>& lanes) const;

 private:
  friend struct HitLoops;

  void loadTextures();
  void loadMaterials();

  bool textured_ = false;           ///< Any of the hits.
  bool textureOfMetal_ = false;     ///< Any has a metallic-roughness texture.
  bool lambert_ = true;             ///< All of the hits.
  std::uint32_t transmitting_ = 0;  ///< Bits of the lanes that hold such materials.
  const ShadedMaterial* material_[kLanes];
  Hit hit_[kLanes];
  Bsdf bsdf_[kLanes];          ///< Of transmitting lanes.
  Lanes<float> triangle_[24];  ///< The floats of a ShadedTriangle in world space.
  Lanes<float> u_, v_;
  VectorLanes rayDirection_;
  VectorLanes baseColour_;
  Lanes<float> metallic_, roughness_, specular_, ior_;
  Lanes<int> isLambert_;
  TextureLanes colourTexture_, metallicRoughnessTexture_;
  Lanes<float> uvX_, uvY_;
  VectorLanes ng_, ns_;
  Lanes<float> entering_;
  Lanes<float> random_[3];
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What shades many hits side by side, of eye paths (surface_lanes.h) and of photons: triangles, points on
// them, textures. The members marked SHARED_FN are for the bodies of loops that ISOPHOTE_SIMD compiles.
#pragma once

#include "math/lanes.h"
#include "trace/surface.h"

#include <bit>
#include <cstring>

namespace isophote {

inline constexpr std::uint32_t kTriangleWords = sizeof(ShadedTriangle) / sizeof(std::uint32_t);
static_assert(kTriangleWords == 24);
/// Of them, the first: vertices and their normals.
inline constexpr std::uint32_t kTriangleDirections = 12;

/// A ShadedTriangle at each lane, in world space.
template <std::uint32_t kCount>
struct TriangleLanes {
  Lanes<std::uint32_t, kCount> words[kTriangleWords];

  void set(std::uint32_t i, const ShadedTriangle& triangle) {
    std::uint32_t row[kTriangleWords];
    std::memcpy(row, &triangle, sizeof(row));
    for (std::uint32_t k = 0; k < kTriangleWords; ++k) words[k][i] = row[k];
  }

  void copy(std::uint32_t to, std::uint32_t from) {
    for (Lanes<std::uint32_t, kCount>& word : words) word[to] = word[from];
  }

  SHARED_FN ShadedTriangle operator[](std::uint32_t i) const {
    const auto number = [&](int word) __attribute__((always_inline)) {
      return std::bit_cast<float>(words[word][i]);
    };
    ShadedTriangle t;
    for (int k = 0; k < 3; ++k) {
      t.position[k] = vec3(number(3 * k), number(3 * k + 1), number(3 * k + 2));
      t.normal[k] = words[9 + k][i];
      t.tangent[k] = words[12 + k][i];
      t.colour[k] = words[15 + k][i];
      t.uv[k] = vec2(number(18 + 2 * k), number(19 + 2 * k));
    }
    return t;
  }
};

/// A SurfacePoint at each lane, and where its textures are looked up.
template <std::uint32_t kCount>
struct PointLanes {
  Lanes<float, kCount> u, v;  ///< Barycentric weights, to be set first.
  Vec3Lanes<kCount> position, ng, ns;
  Lanes<float, kCount> entering, side;
  Lanes<float, kCount> uvX, uvY;  ///< boundedUv.

  SHARED_FN void place(std::uint32_t i, const ShadedTriangle& t, vec3 rayDirection) {
    const SurfacePoint p = surfacePoint(t, u[i], v[i], rayDirection);
    const vec2 uv = boundedUv(uvAt(t, u[i], v[i]));
    position.set(i, p.position);
    ng.set(i, p.ng);
    ns.set(i, p.ns);
    entering[i] = p.entering;
    side[i] = p.side;
    uvX[i] = uv.x;
    uvY[i] = uv.y;
  }
};

/// A texture at each lane: set(), then find() where it is looked up, fetch() the texels, and blend them.
template <std::uint32_t kCount>
struct TextureLanes {
  const std::uint8_t* rgba[kCount]{};
  Lanes<int, kCount> width, height;
  Lanes<int, kCount> repeatsU, repeatsV, mirrorsU, mirrorsV;
  Lanes<float, kCount> blends;
  Lanes<int, kCount> curve;
  Lanes<std::uint32_t, kCount> index[4];  ///< As TexelSquare.
  Lanes<float, kCount> weightX, weightY;
  Lanes<std::uint32_t, kCount> texel[4];

  void set(std::uint32_t i, const TextureView& t) {
    rgba[i] = t.rgba;
    width[i] = t.width;
    height[i] = t.height;
    repeatsU[i] = t.repeatsU;
    repeatsV[i] = t.repeatsV;
    mirrorsU[i] = t.mirrorsU;
    mirrorsV[i] = t.mirrorsV;
    blends[i] = t.blends;
    curve[i] = t.curve;
  }

  SHARED_FN void find(const Lanes<float, kCount>& uvX, const Lanes<float, kCount>& uvY) {
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const TextureView view{nullptr,     width[i],    height[i], repeatsU[i], repeatsV[i],
                             mirrorsU[i], mirrorsV[i], blends[i], curve[i]};
      const TexelSquare square = texelSquare(view, vec2(uvX[i], uvY[i]));
      for (int k = 0; k < 4; ++k) index[k][i] = square.index[k];
      weightX[i] = square.weightX;
      weightY[i] = square.weightY;
    }
  }

  void fetch(std::uint32_t i) {
    for (int k = 0; k < 4; ++k) texel[k][i] = loadTexel(rgba[i], index[k][i]);
  }

  SHARED_FN vec4 blended(std::uint32_t i) const {
    return blendTexels(squareAt(i), texel[0][i], texel[1][i], texel[2][i], texel[3][i], curve[i]);
  }
  /// Of a normal map.
  SHARED_FN vec3 blendedNormal(std::uint32_t i) const {
    return blendNormals(squareAt(i), texel[0][i], texel[1][i], texel[2][i], texel[3][i]);
  }

 private:
  SHARED_FN TexelSquare squareAt(std::uint32_t i) const { return {{0, 0, 0, 0}, weightX[i], weightY[i]}; }
};

}  // namespace isophote

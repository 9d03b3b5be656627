// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/surface_lanes.h"

#include "trace/surface.h"

#include <bit>
#include <cstring>

namespace isophote {

namespace {

/// One texture at every lane.
struct Texels {
  int width[kSurfaceLanes]{}, height[kSurfaceLanes]{};
  int repeatsU[kSurfaceLanes]{}, repeatsV[kSurfaceLanes]{};
  int mirrorsU[kSurfaceLanes]{}, mirrorsV[kSurfaceLanes]{};
  float blends[kSurfaceLanes]{};
  int curve[kSurfaceLanes]{};
  const std::uint8_t* rgba[kSurfaceLanes]{};
  std::uint32_t index[4][kSurfaceLanes];
  float weightX[kSurfaceLanes], weightY[kSurfaceLanes];
  std::uint32_t texel[4][kSurfaceLanes]{};

  void set(int i, const TextureView& t) {
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

  void fetch(std::uint64_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const int i = std::countr_zero(lanes);
      for (int k = 0; k < 4; ++k) texel[k][i] = loadTexel(rgba[i], index[k][i]);
    }
  }
};

}  // namespace

constexpr int kTriangleWords = sizeof(ShadedTriangle) / sizeof(std::uint32_t);
static_assert(sizeof(ShadedTriangle) == 24 * sizeof(std::uint32_t));

struct SurfaceLanes::Scratch {
  alignas(64) std::uint32_t triangle[kTriangleWords][kSurfaceLanes]{};  ///< The words of a ShadedTriangle.
  FloatLanes u{}, v{}, uvX{}, uvY{}, side{};
  FloatLanes metallic{}, roughness{}, specular{}, ior{};
  Texels colour, metallicRoughness;
};

/// The loops over lanes, compiled for each instruction set.
struct SurfaceLoops {
  static SHARED_FN ShadedTriangle triangle(const SurfaceLanes::Scratch& m, int i) {
    const auto number = [&](int word) __attribute__((always_inline)) {
      return std::bit_cast<float>(m.triangle[word][i]);
    };
    ShadedTriangle t;
    for (int k = 0; k < 3; ++k) {
      t.position[k] = vec3(number(3 * k), number(3 * k + 1), number(3 * k + 2));
      t.normal[k] = m.triangle[9 + k][i];
      t.tangent[k] = m.triangle[12 + k][i];
      t.colour[k] = m.triangle[15 + k][i];
      t.uv[k] = vec2(number(18 + 2 * k), number(19 + 2 * k));
    }
    return t;
  }

  // Unless it knows that the two lie apart, the compiler does not vectorise this.
  static SHARED_FN void place(SurfaceLanes& __restrict s, SurfaceLanes::Scratch& __restrict m,
                              const Vec3Lanes& rayDirection) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      const ShadedTriangle t = triangle(m, i);
      const SurfacePoint p = surfacePoint(t, m.u[i], m.v[i], rayDirection[i]);
      const vec2 uv = boundedUv(uvAt(t, m.u[i], m.v[i]));
      s.position.set(i, p.position);
      s.ng.set(i, p.ng);
      s.ns.set(i, p.ns);
      m.side[i] = p.side;
      m.uvX[i] = uv.x;
      m.uvY[i] = uv.y;
    }
  }

  static SHARED_FN void find(Texels& t, const FloatLanes& uvX, const FloatLanes& uvY) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      const TextureView view{nullptr,       t.width[i],    t.height[i], t.repeatsU[i], t.repeatsV[i],
                             t.mirrorsU[i], t.mirrorsV[i], t.blends[i], t.curve[i]};
      const TexelSquare square = texelSquare(view, vec2(uvX[i], uvY[i]));
      t.index[0][i] = square.index[0];
      t.index[1][i] = square.index[1];
      t.index[2][i] = square.index[2];
      t.index[3][i] = square.index[3];
      t.weightX[i] = square.weightX;
      t.weightY[i] = square.weightY;
    }
  }

  static SHARED_FN vec4 blend(const Texels& t, int i) {
    const TexelSquare square{{0, 0, 0, 0}, t.weightX[i], t.weightY[i]};
    return blendTexels(square, t.texel[0][i], t.texel[1][i], t.texel[2][i], t.texel[3][i], t.curve[i]);
  }

  static SHARED_FN void colour(SurfaceLanes& s, const Texels& t) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      const vec4 texel = blend(t, i);
      s.baseColour.set(i, s.baseColour[i] * vec3(texel.x, texel.y, texel.z));
    }
  }

  static SHARED_FN void metal(SurfaceLanes::Scratch& m) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      const vec4 texel = blend(m.metallicRoughness, i);
      m.roughness[i] *= texel.y;
      m.metallic[i] *= texel.z;
    }
  }

  static SHARED_FN void reflect(SurfaceLanes& s, const SurfaceLanes::Scratch& m) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      Material material = makeMaterial();
      material.specular = m.specular[i];
      material.ior = m.ior[i];
      const Bsdf b = bsdfFromMaterial(material, s.baseColour[i], m.metallic[i], m.roughness[i], 0.0f);
      s.diffuse.set(i, b.diffuse);
      s.f0.set(i, b.f0);
      s.f90[i] = b.f90;
      s.alpha[i] = b.alpha;
      s.coupling0[i] = b.coupling0;
      s.coupling90[i] = b.coupling90;
    }
  }
};

namespace {

ISOPHOTE_SIMD(placeLanes, SurfaceLoops::place,
              (SurfaceLanes & s, SurfaceLanes::Scratch& m, const Vec3Lanes& rayDirection),
              (s, m, rayDirection))
ISOPHOTE_SIMD(findTexels, SurfaceLoops::find, (Texels & t, const FloatLanes& uvX, const FloatLanes& uvY),
              (t, uvX, uvY))
ISOPHOTE_SIMD(colourLanes, SurfaceLoops::colour, (SurfaceLanes & s, const Texels& t), (s, t))
ISOPHOTE_SIMD(metalLanes, SurfaceLoops::metal, (SurfaceLanes::Scratch & m), (m))
ISOPHOTE_SIMD(reflectLanes, SurfaceLoops::reflect, (SurfaceLanes & s, const SurfaceLanes::Scratch& m), (s, m))

}  // namespace

SurfaceLanes::SurfaceLanes() : scratch_(std::make_unique<Scratch>()) {}
SurfaceLanes::~SurfaceLanes() = default;
SurfaceLanes::SurfaceLanes(SurfaceLanes&&) noexcept = default;
SurfaceLanes& SurfaceLanes::operator=(SurfaceLanes&&) noexcept = default;

bool SurfaceLanes::isPlain(const ShadedInstance& instance) {
  return instance.shadedMaterial->scattering != Scattering::kAny && !instance.coloured &&
         instance.material->emission == vec3(0.0f);
}

/// Triangles are many pixels wide, mostly: the lane to the left or above has moved it to world space already.
void SurfaceLanes::loadTriangle(const TraceScene& trace, std::span<const Hit, kSurfaceLanes> hits, int lane) {
  auto& words = scratch_->triangle;
  const Hit& hit = hits[std::size_t(lane)];
  for (const int before : {lane - 1, lane - 8}) {
    if (before < 0 || (shaded_ >> before & 1u) == 0u) continue;
    const Hit& other = hits[std::size_t(before)];
    if (other.instance != hit.instance || other.triangle != hit.triangle) continue;
    for (int k = 0; k < kTriangleWords; ++k) words[k][lane] = words[k][before];
    return;
  }
  const ShadedTriangle triangle = worldTriangle(trace.instance(hit.instance), hit.triangle);
  std::uint32_t row[kTriangleWords];
  std::memcpy(row, &triangle, sizeof(row));
  for (int k = 0; k < kTriangleWords; ++k) words[k][lane] = row[k];
}

void SurfaceLanes::shade(const TraceScene& trace, std::span<const Hit, kSurfaceLanes> hits,
                         const Vec3Lanes& rayDirection, std::uint64_t lanes, SimdLevel level) {
  Scratch& m = *scratch_;
  shaded_ = lanes;
  bool textured = false, textureOfMetal = false;
  std::uint64_t normalMapped = 0;
  lambertian = 0;
  for (std::uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    const Hit& hit = hits[std::size_t(i)];
    const ShadedInstance& instance = trace.instance(hit.instance);
    const ShadedMaterial& material = *instance.shadedMaterial;
    loadTriangle(trace, hits, i);
    m.u[i] = hit.u;
    m.v[i] = hit.v;
    baseColour.set(i, material.baseColour);
    textured |= material.textured;
    textureOfMetal |= material.textureOfMetal;
    normalMapped |= std::uint64_t(material.normalMapped ? 1 : 0) << i;
    lambertian |= std::uint64_t(material.scattering == Scattering::kLambert ? 1 : 0) << i;
  }
  placeLanesFor(level)(*this, m, rayDirection);
  for (; normalMapped != 0; normalMapped &= normalMapped - 1) {
    const int i = std::countr_zero(normalMapped);
    const ShadedMaterial& material = *trace.instance(hits[std::size_t(i)].instance).shadedMaterial;
    const vec3 texel = sampleNormal(material.normalTexture, vec2(m.uvX[i], m.uvY[i]));
    ns.set(i, bentNormal(SurfaceLoops::triangle(m, i), m.u[i], m.v[i], ns[i], ng[i], m.side[i], texel,
                         material.normalScale));
  }
  if (textured) {
    for (std::uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
      const int i = std::countr_zero(rest);
      m.colour.set(i, trace.instance(hits[std::size_t(i)].instance).shadedMaterial->colourTexture);
    }
    findTexelsFor(level)(m.colour, m.uvX, m.uvY);
    m.colour.fetch(lanes);
    colourLanesFor(level)(*this, m.colour);
  }
  if (lambertian == lanes) {
    diffuse = baseColour;
    return;
  }
  for (std::uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    const ShadedMaterial& material = *trace.instance(hits[std::size_t(i)].instance).shadedMaterial;
    m.metallic[i] = material.metallic;
    m.roughness[i] = material.roughness;
    m.specular[i] = material.specular;
    m.ior[i] = material.ior;
    if (textureOfMetal) m.metallicRoughness.set(i, material.metallicRoughnessTexture);
  }
  if (textureOfMetal) {
    findTexelsFor(level)(m.metallicRoughness, m.uvX, m.uvY);
    m.metallicRoughness.fetch(lanes);
    metalLanesFor(level)(m);
  }
  reflectLanesFor(level)(*this, m);
}

}  // namespace isophote

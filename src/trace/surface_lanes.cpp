// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/surface_lanes.h"

#include "trace/raster_hit.h"
#include "trace/raster_scene.h"

#include <array>
#include <bit>
#include <cstring>

namespace isophote {

namespace {

using SurfacePoints = PointLanes<kSurfaceLanes>;
using SurfaceTriangles = TriangleLanes<kSurfaceLanes>;
using SurfaceTextures = TextureLanes<kSurfaceLanes>;

constexpr int kHalf = kSurfaceLanes / 2;  ///< More than the compiler unrolls before it vectorises.

/// One material, and the lanes that have it.
struct MaterialLanes {
  const ShadedMaterial* material;
  std::uint64_t lanes;
};

template <class Visit>
void forEachLane(std::uint64_t lanes, Visit&& visit) {
  for (; lanes != 0; lanes &= lanes - 1) visit(std::countr_zero(lanes));
}

}  // namespace

struct SurfaceLanes::Scratch {
  SurfaceTriangles triangles;
  SurfaceWords instance, triangle;  ///< Of each hit.
  SurfaceColumn t;
  std::array<MaterialLanes, kSurfaceLanes> materials;  ///< Of the plain lanes.
  std::size_t materialCount = 0;
  SurfaceColumn metallic, roughness, specular, ior;
  SurfaceTextures colour, metallicRoughness;
};

/// The loops over lanes, compiled for each instruction set.
struct SurfaceLoops {
  /// Calls half(first, take) for every 32 lanes with any in `lanes`: take[i] is 1 where lane first + i is.
  template <class Half>
  static SHARED_FN void forHalves(std::uint64_t lanes, Half&& half) {
    for (int first = 0; first < kSurfaceLanes; first += kHalf) {
      const auto bits = std::uint32_t(lanes >> first);
      if (bits == 0u) continue;
      alignas(64) std::uint32_t take[kHalf];
      for (int i = 0; i < kHalf; ++i) take[i] = bits >> i & 1u;
      half(first, take);
    }
  }

  static SHARED_FN void findId(const SurfaceWords& ids, std::uint32_t id, std::uint64_t& lanes) {
    lanes = bitsWhere([&](int i) __attribute__((always_inline)) { return ids[i] == id; });
  }

  static SHARED_FN void spread(SurfaceWords* __restrict rows, const std::uint32_t* __restrict words,
                               int count, std::uint64_t lanes) {
    forHalves(
        lanes, [&](int first, const std::uint32_t* take) __attribute__((always_inline)) {
          for (int k = 0; k < count; ++k) {
            std::uint32_t* const row = rows[k].values + first;
            const std::uint32_t word = words[k];
            for (int i = 0; i < kHalf; ++i) row[i] = take[i] != 0u ? word : +row[i];
          }
        });
  }

  static SHARED_FN void spreadColour(SurfaceVectors& __restrict rows, vec3 colour, std::uint64_t lanes) {
    forHalves(
        lanes, [&](int first, const std::uint32_t* take) __attribute__((always_inline)) {
          for (int i = 0; i < kHalf; ++i) {
            const int lane = first + i;
            rows.x[lane] = take[i] != 0u ? colour.x : +rows.x[lane];
            rows.y[lane] = take[i] != 0u ? colour.y : +rows.y[lane];
            rows.z[lane] = take[i] != 0u ? colour.z : +rows.z[lane];
          }
        });
  }

  // Unless it knows that they lie apart, the compiler does not vectorise these.
  static SHARED_FN void meet(SurfacePoints& __restrict points, SurfaceColumn& __restrict t,
                             const SurfaceTriangles& __restrict triangles, const SurfaceVectors& origin,
                             const SurfaceVectors& direction) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      const ShadedTriangle triangle = triangles[i];
      const PlaneHit hit = planeHit(triangle.position, {origin[i], 0.0f, direction[i]});
      t[i] = hit.t;
      points.u[i] = hit.u;
      points.v[i] = hit.v;
    }
  }

  static SHARED_FN void place(SurfacePoints& __restrict points, const SurfaceTriangles& __restrict triangles,
                              const SurfaceVectors& rayDirection) {
    for (int i = 0; i < kSurfaceLanes; ++i) points.place(i, triangles[i], rayDirection[i]);
  }

  static SHARED_FN void colour(SurfaceLanes& s, const SurfaceTextures& t) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      const vec4 texel = t.blended(i);
      s.baseColour.set(i, s.baseColour[i] * vec3(texel.x, texel.y, texel.z));
    }
  }

  static SHARED_FN void metal(SurfaceLanes::Scratch& m) {
    for (int i = 0; i < kSurfaceLanes; ++i) {
      const vec4 texel = m.metallicRoughness.blended(i);
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

  /// Where a plain surface is not to be lit: perfect mirrors are followed; black ones cannot be lit.
  static SHARED_FN void findUnlit(const SurfaceLanes& s, std::uint64_t& unlit) {
    if (s.lambertian == s.plain) {
      unlit = bitsWhere([&](int i) __attribute__((always_inline)) { return !(maxOf(s.diffuse[i]) > 0.0f); });
      return;
    }
    const std::uint64_t black =
        bitsWhere([&](int i) __attribute__((always_inline)) { return !(maxOf(s.diffuse[i]) > 0.0f); });
    const std::uint64_t sharp =
        bitsWhere([&](int i) __attribute__((always_inline)) { return s.alpha[i] == 0.0f; });
    const std::uint64_t reflecting =
        bitsWhere([&](int i) __attribute__((always_inline)) { return s.f90[i] > 0.0f; });
    const std::uint64_t dull = s.lambertian | ~sharp;
    unlit = (black & (s.lambertian | sharp)) | (~dull & reflecting);
  }
};

namespace {

ISOPHOTE_SIMD(findId, SurfaceLoops::findId, (const SurfaceWords& ids, std::uint32_t id, std::uint64_t& lanes),
              (ids, id, lanes))
ISOPHOTE_SIMD(spreadWords, SurfaceLoops::spread,
              (SurfaceWords * rows, const std::uint32_t* words, int count, std::uint64_t lanes),
              (rows, words, count, lanes))
ISOPHOTE_SIMD(spreadColour, SurfaceLoops::spreadColour,
              (SurfaceVectors & rows, vec3 colour, std::uint64_t lanes), (rows, colour, lanes))
ISOPHOTE_SIMD(meetPlanes, SurfaceLoops::meet,
              (SurfacePoints & points, SurfaceColumn& t, const SurfaceTriangles& triangles,
               const SurfaceVectors& origin, const SurfaceVectors& direction),
              (points, t, triangles, origin, direction))
ISOPHOTE_SIMD(placeLanes, SurfaceLoops::place,
              (SurfacePoints & points, const SurfaceTriangles& triangles, const SurfaceVectors& rayDirection),
              (points, triangles, rayDirection))
ISOPHOTE_SIMD(findTexels, t.find, (SurfaceTextures & t, const SurfaceColumn& uvX, const SurfaceColumn& uvY),
              (uvX, uvY))
ISOPHOTE_SIMD(colourLanes, SurfaceLoops::colour, (SurfaceLanes & s, const SurfaceTextures& t), (s, t))
ISOPHOTE_SIMD(metalLanes, SurfaceLoops::metal, (SurfaceLanes::Scratch & m), (m))
ISOPHOTE_SIMD(reflectLanes, SurfaceLoops::reflect, (SurfaceLanes & s, const SurfaceLanes::Scratch& m), (s, m))

ISOPHOTE_SIMD(findUnlit, SurfaceLoops::findUnlit, (const SurfaceLanes& s, std::uint64_t& unlit), (s, unlit))

void fetchTexels(SurfaceTextures& t, std::uint64_t lanes) {
  forEachLane(lanes, [&](int i) { t.fetch(std::uint32_t(i)); });
}

}  // namespace

SurfaceLanes::SurfaceLanes() : scratch_(std::make_unique<Scratch>()) {}
SurfaceLanes::~SurfaceLanes() = default;
SurfaceLanes::SurfaceLanes(SurfaceLanes&&) noexcept = default;
SurfaceLanes& SurfaceLanes::operator=(SurfaceLanes&&) noexcept = default;

bool SurfaceLanes::isPlain(const ShadedInstance& instance) {
  return instance.shadedMaterial->scattering != Scattering::kAny && !instance.coloured &&
         instance.material->emission == vec3(0.0f);
}

Hit SurfaceLanes::hit(int lane) const {
  if ((met >> lane & 1u) == 0u) return {};
  const Scratch& m = *scratch_;
  return {m.t[lane], points.u[lane], points.v[lane], m.instance[lane], m.triangle[lane]};
}

void SurfaceLanes::begin() {
  met = plain = lambertian = 0;
  scratch_->materialCount = 0;
}

void SurfaceLanes::addTriangle(const TraceScene& trace, std::uint32_t instance, std::uint32_t triangle,
                               std::uint64_t lanes, SimdLevel level) {
  Scratch& m = *scratch_;
  const ShadedInstance& shaded = trace.instance(instance);
  const auto spread = spreadWordsFor(level);
  // The first also serves the lanes that met nothing: with it their numbers are finite.
  const std::uint64_t served = met == 0 ? ~std::uint64_t(0) : lanes;
  met |= lanes;
  spread(&m.instance, &instance, 1, lanes);
  spread(&m.triangle, &triangle, 1, lanes);
  const ShadedTriangle placed = worldTriangle(shaded, triangle);
  std::uint32_t words[kTriangleWords];
  std::memcpy(words, &placed, sizeof(words));
  const bool isPlainOne = isPlain(shaded);
  if (!isPlainOne || (!shaded.shadedMaterial->textured && !shaded.shadedMaterial->normalMapped)) {
    spread(m.triangles.words, words, kTriangleDirections, served);
  } else {
    spread(m.triangles.words, words, kTriangleWords, served);
  }
  if (!isPlainOne) return;
  plain |= lanes;
  addMaterial(*shaded.shadedMaterial, lanes);
}

void SurfaceLanes::addMaterial(const ShadedMaterial& material, std::uint64_t lanes) {
  Scratch& m = *scratch_;
  for (std::size_t i = 0; i < m.materialCount; ++i)
    if (m.materials[i].material == &material) {
      m.materials[i].lanes |= lanes;
      return;
    }
  m.materials[m.materialCount++] = {&material, lanes};
}

void SurfaceLanes::take(const TraceScene& trace, std::span<const Hit, kSurfaceLanes> hits, SimdLevel level) {
  begin();
  Scratch& m = *scratch_;
  std::uint64_t rest = 0;
  for (int i = 0; i < kSurfaceLanes; ++i) {
    const Hit& hit = hits[std::size_t(i)];
    m.t[i] = hit.t;
    points.u[i] = hit.u;
    points.v[i] = hit.v;
    rest |= std::uint64_t(hit.valid() ? 1 : 0) << i;
  }
  while (rest != 0) {
    const Hit& first = hits[std::size_t(std::countr_zero(rest))];
    std::uint64_t lanes = 0;
    forEachLane(rest, [&](int i) {
      const Hit& hit = hits[std::size_t(i)];
      const bool same = hit.instance == first.instance && hit.triangle == first.triangle;
      lanes |= std::uint64_t(same ? 1 : 0) << i;
    });
    addTriangle(trace, first.instance, first.triangle, lanes, level);
    rest &= ~lanes;
  }
}

void SurfaceLanes::meet(const RasterScene& raster, const SurfaceWords& ids, const SurfaceVectors& origin,
                        const SurfaceVectors& direction, SimdLevel level) {
  begin();
  Scratch& m = *scratch_;
  const auto find = findIdFor(level);
  std::uint64_t lanes = 0;
  find(ids, kNoTriangle, lanes);
  std::uint32_t instance = 0;
  for (std::uint64_t rest = ~lanes; rest != 0; rest &= ~lanes) {
    const std::uint32_t id = ids[std::uint32_t(std::countr_zero(rest))];
    find(ids, id, lanes);
    instance = raster.instanceOf(id, instance);
    addTriangle(raster.trace(), instance, id - raster.instances()[instance].firstTriangle, lanes, level);
  }
  if (met != 0) meetPlanesFor(level)(points, m.t, m.triangles, origin, direction);
}

void SurfaceLanes::bendNormals() {
  const Scratch& m = *scratch_;
  for (const MaterialLanes& part : std::span(m.materials).first(m.materialCount)) {
    if (!part.material->normalMapped) continue;
    forEachLane(part.lanes, [&](int i) {
      const vec3 texel = sampleNormal(part.material->normalTexture, vec2(points.uvX[i], points.uvY[i]));
      points.ns.set(i, bentNormal(m.triangles[i], points.u[i], points.v[i], points.ns[i], points.ng[i],
                                  points.side[i], texel, part.material->normalScale));
    });
  }
}

void SurfaceLanes::shade(const SurfaceVectors& rayDirection, SimdLevel level) {
  if (plain == 0) return;
  Scratch& m = *scratch_;
  const std::span<const MaterialLanes> materials = std::span(m.materials).first(m.materialCount);
  bool textured = false, textureOfMetal = false, normalMapped = false;
  for (const MaterialLanes& part : materials) {
    spreadColourFor(level)(baseColour, part.material->baseColour, part.lanes);
    textured |= part.material->textured;
    textureOfMetal |= part.material->textureOfMetal;
    normalMapped |= part.material->normalMapped;
    if (part.material->scattering == Scattering::kLambert) lambertian |= part.lanes;
  }
  placeLanesFor(level)(points, m.triangles, rayDirection);
  if (normalMapped) bendNormals();
  if (textured) {
    for (const MaterialLanes& part : materials)
      forEachLane(part.lanes, [&](int i) { m.colour.set(std::uint32_t(i), part.material->colourTexture); });
    findTexelsFor(level)(m.colour, points.uvX, points.uvY);
    fetchTexels(m.colour, plain);
    colourLanesFor(level)(*this, m.colour);
  }
  if (lambertian == plain)
    diffuse = baseColour;
  else
    shadeGlossy(textureOfMetal, level);
  std::uint64_t unlit = 0;
  findUnlitFor(level)(*this, unlit);
  plain &= ~unlit;
  lambertian &= ~unlit;
}

void SurfaceLanes::shadeGlossy(bool textureOfMetal, SimdLevel level) {
  Scratch& m = *scratch_;
  for (const MaterialLanes& part : std::span(m.materials).first(m.materialCount))
    forEachLane(part.lanes, [&](int i) {
      m.metallic[i] = part.material->metallic;
      m.roughness[i] = part.material->roughness;
      m.specular[i] = part.material->specular;
      m.ior[i] = part.material->ior;
      if (textureOfMetal) m.metallicRoughness.set(std::uint32_t(i), part.material->metallicRoughnessTexture);
    });
  if (textureOfMetal) {
    findTexelsFor(level)(m.metallicRoughness, points.uvX, points.uvY);
    fetchTexels(m.metallicRoughness, plain);
    metalLanesFor(level)(m);
  }
  reflectLanesFor(level)(*this, m);
}

}  // namespace isophote

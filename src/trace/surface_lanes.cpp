// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/surface_lanes.h"

#include <bit>

namespace isophote {

namespace {

using SurfacePoints = PointLanes<kSurfaceLanes>;
using SurfaceTriangles = TriangleLanes<kSurfaceLanes>;
using SurfaceTextures = TextureLanes<kSurfaceLanes>;

void fetchTexels(SurfaceTextures& t, std::uint64_t lanes) {
  for (; lanes != 0; lanes &= lanes - 1) t.fetch(std::uint32_t(std::countr_zero(lanes)));
}

}  // namespace

struct SurfaceLanes::Scratch {
  SurfaceTriangles triangles;
  SurfaceColumn metallic, roughness, specular, ior;
  SurfaceTextures colour, metallicRoughness;
};

/// The loops over lanes, compiled for each instruction set.
struct SurfaceLoops {
  // Unless it knows that the two lie apart, the compiler does not vectorise this.
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
};

namespace {

ISOPHOTE_SIMD(placeLanes, SurfaceLoops::place,
              (SurfacePoints & points, const SurfaceTriangles& triangles, const SurfaceVectors& rayDirection),
              (points, triangles, rayDirection))
ISOPHOTE_SIMD(findTexels, t.find, (SurfaceTextures & t, const SurfaceColumn& uvX, const SurfaceColumn& uvY),
              (uvX, uvY))
ISOPHOTE_SIMD(colourLanes, SurfaceLoops::colour, (SurfaceLanes & s, const SurfaceTextures& t), (s, t))
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
  SurfaceTriangles& triangles = scratch_->triangles;
  const Hit& hit = hits[std::size_t(lane)];
  for (const int before : {lane - 1, lane - 8}) {
    if (before < 0 || (shaded_ >> before & 1u) == 0u) continue;
    const Hit& other = hits[std::size_t(before)];
    if (other.instance != hit.instance || other.triangle != hit.triangle) continue;
    triangles.copy(lane, before);
    return;
  }
  triangles.set(lane, worldTriangle(trace.instance(hit.instance), hit.triangle));
}

void SurfaceLanes::shade(const TraceScene& trace, std::span<const Hit, kSurfaceLanes> hits,
                         const SurfaceVectors& rayDirection, std::uint64_t lanes, SimdLevel level) {
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
    points.u[i] = hit.u;
    points.v[i] = hit.v;
    baseColour.set(i, material.baseColour);
    textured |= material.textured;
    textureOfMetal |= material.textureOfMetal;
    normalMapped |= std::uint64_t(material.normalMapped ? 1 : 0) << i;
    lambertian |= std::uint64_t(material.scattering == Scattering::kLambert ? 1 : 0) << i;
  }
  placeLanesFor(level)(points, m.triangles, rayDirection);
  for (; normalMapped != 0; normalMapped &= normalMapped - 1) {
    const int i = std::countr_zero(normalMapped);
    const ShadedMaterial& material = *trace.instance(hits[std::size_t(i)].instance).shadedMaterial;
    const vec3 texel = sampleNormal(material.normalTexture, vec2(points.uvX[i], points.uvY[i]));
    points.ns.set(i, bentNormal(m.triangles[i], points.u[i], points.v[i], points.ns[i], points.ng[i],
                                points.side[i], texel, material.normalScale));
  }
  if (textured) {
    for (std::uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
      const int i = std::countr_zero(rest);
      m.colour.set(i, trace.instance(hits[std::size_t(i)].instance).shadedMaterial->colourTexture);
    }
    findTexelsFor(level)(m.colour, points.uvX, points.uvY);
    fetchTexels(m.colour, lanes);
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
    findTexelsFor(level)(m.metallicRoughness, points.uvX, points.uvY);
    fetchTexels(m.metallicRoughness, lanes);
    metalLanesFor(level)(m);
  }
  reflectLanesFor(level)(*this, m);
}

}  // namespace isophote

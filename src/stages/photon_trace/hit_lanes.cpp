// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/hit_lanes.h"

#include "math/simd.h"

#include <cstring>

namespace isophote {

namespace {

static_assert(sizeof(ShadedTriangle) == 24 * sizeof(float));

void loadTexture(TextureLanes& lanes, std::uint32_t lane, const TextureView& t) {
  lanes.rgba[lane] = t.rgba;
  lanes.width[lane] = t.width;
  lanes.height[lane] = t.height;
  lanes.repeatsU[lane] = t.repeatsU;
  lanes.repeatsV[lane] = t.repeatsV;
  lanes.mirrorsU[lane] = t.mirrorsU;
  lanes.mirrorsV[lane] = t.mirrorsV;
  lanes.blends[lane] = t.blends;
  lanes.curve[lane] = t.curve;
}

/// Texels on one row lie on one line of memory, mostly.
void prefetchSquares(const TextureLanes& t, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    __builtin_prefetch(t.rgba[i] + std::size_t(t.index[0][i]) * 4);
    __builtin_prefetch(t.rgba[i] + std::size_t(t.index[2][i]) * 4);
  }
}

void fetchTexels(TextureLanes& t, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t k = 0; k < 4; ++k) t.texel[k][i] = loadTexel(t.rgba[i], t.index[k][i]);
}

/// What a scattering event did to one photon.
struct Event {
  vec3 wi;
  vec3 weight;
  std::uint32_t lobe;
  float roulette;  ///< A number in [0, 1) that the choice of the lobe has left over.
};

/// Lambert alone: what sampleBsdf would do.
SHARED_FN Event scatterDiffuse(vec3 diffuse, vec3 ng, vec3 ns, vec3 u) {
  const vec3 wi = basisAround(ns) * sampleCosineHemisphere(vec2(u.y, u.z));
  return {wi * (dot(wi, ng) < 0.0f ? -1.0f : 1.0f), diffuse, kLobeDiffuse, u.x};
}

SHARED_FN Event scatterAny(const Bsdf& bsdf, vec3 wo, vec3 ng, vec3 ns, float entering, vec3 u) {
  const BsdfSample sample = sampleBsdf(bsdf, wo, ng, ns, entering, u);
  const vec4 p = lobeProbabilities(bsdf, abs(dot(wo, ns)), entering);
  const float low = u.x < p.x               ? 0.0f
                    : u.x < p.x + p.y       ? p.x
                    : u.x < p.x + p.y + p.z ? p.x + p.y
                                            : p.x + p.y + p.z;
  const float width = u.x < p.x ? p.x : u.x < p.x + p.y ? p.y : u.x < p.x + p.y + p.z ? p.z : p.w;
  const float rest = clamp((u.x - low) / max(width, 1e-7f), 0.0f, 1.0f);
  return {sample.wi, sample.weight, sample.lobe, rest};
}

}  // namespace

/// The loops over lanes, compiled for each instruction set.
struct HitLoops {
  static SHARED_FN ShadedTriangle triangle(const HitLanes& h, std::uint32_t i) {
    ShadedTriangle t;
    for (int k = 0; k < 3; ++k) {
      t.position[k] = vec3(h.triangle_[3 * k][i], h.triangle_[3 * k + 1][i], h.triangle_[3 * k + 2][i]);
      t.normal[k] = vec3(h.triangle_[9 + 3 * k][i], h.triangle_[10 + 3 * k][i], h.triangle_[11 + 3 * k][i]);
      t.uv[k] = vec2(h.triangle_[18 + 2 * k][i], h.triangle_[19 + 2 * k][i]);
    }
    return t;
  }

  static SHARED_FN void place(HitLanes& h) {
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const ShadedTriangle t = triangle(h, i);
      const SurfacePoint p = surfacePoint(t, h.u_[i], h.v_[i], h.rayDirection_[i]);
      const vec2 uv = boundedUv(uvAt(t, h.u_[i], h.v_[i]));
      h.position.set(i, p.position);
      h.ng_.set(i, p.ng);
      h.ns_.set(i, p.ns);
      h.entering_[i] = p.entering;
      h.uvX_[i] = uv.x;
      h.uvY_[i] = uv.y;
      h.mean[i] = meanOf(h.power[i]);
    }
  }

  static SHARED_FN void findTexels(TextureLanes& t, const Lanes<float>& uvX, const Lanes<float>& uvY) {
    for (std::uint32_t i = 0; i < kLanes; ++i) {
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

  static SHARED_FN vec4 texel(const TextureLanes& t, std::uint32_t i) {
    const TexelSquare square{{0, 0, 0, 0}, t.weightX[i], t.weightY[i]};
    return blendTexels(square, t.texel[0][i], t.texel[1][i], t.texel[2][i], t.texel[3][i], t.curve[i]);
  }

  static SHARED_FN void applyColour(HitLanes& h) {
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const vec4 colour = texel(h.colourTexture_, i);
      h.baseColour_.set(i, h.baseColour_[i] * vec3(colour.x, colour.y, colour.z));
    }
  }

  static SHARED_FN void applyMetallicRoughness(HitLanes& h) {
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const vec4 factors = texel(h.metallicRoughnessTexture_, i);
      h.roughness_[i] *= factors.y;
      h.metallic_[i] *= factors.z;
    }
  }

  static SHARED_FN Bsdf bsdf(const HitLanes& h, std::uint32_t i) {
    Material m = makeMaterial();
    m.specular = h.specular_[i];
    m.ior = h.ior_[i];
    Bsdf b = bsdfFromMaterial(m, h.baseColour_[i], h.metallic_[i], h.roughness_[i], 0.0f);
    // As it is, but so the compiler knows it and drops all that is about transmission.
    b.through = 0.0f;
    b.transmission = vec3(0.0f);
    return b;
  }

  static SHARED_FN void draw(HitLanes& h, const BlockRandom& random, std::uint32_t event) {
    if (event < kSobolEvents) {
      for (std::uint32_t d = 0; d < 3; ++d)
        sobolBody(random, kEventDimension + 3 * event + d, h.path.values, kLanes, h.random_[d].values);
    } else {
      hashedBody(random, event, h.path.values, kLanes, h.random_[0].values, h.random_[1].values,
                 h.random_[2].values);
    }
  }

  static SHARED_FN void book(HitLanes& h, std::uint32_t i, const Event& e) {
    const vec3 power = h.power[i];
    const vec3 weight = e.weight * photonShadingFactor(-h.rayDirection_[i], e.wi, h.ng_[i], h.ns_[i]);
    const float survival = photonSurvival(power, weight);
    h.absorbed[i] = h.mean[i] - meanOf(power * weight);
    h.survives[i] = e.roulette < survival ? 1u : 0u;
    h.direction.set(i, e.wi);
    h.origin.set(i, offsetFrom(h.position[i], h.ng_[i], e.wi));
    h.power.set(i, power * weight * (1.0f / max(survival, 1e-37f)));
    h.density[i] *= pathDensityFactor(e.lobe, min(meanOf(e.weight), 1.0f));
  }

  static SHARED_FN vec3 random(const HitLanes& h, std::uint32_t i) {
    return vec3(h.random_[0][i], h.random_[1][i], h.random_[2][i]);
  }

  static SHARED_FN void scatterLambert(HitLanes& h) {
    for (std::uint32_t i = 0; i < kLanes; ++i)
      book(h, i, scatterDiffuse(h.baseColour_[i], h.ng_[i], h.ns_[i], random(h, i)));
  }

  static SHARED_FN vec3 select(bool first, vec3 a, vec3 b) {
    return vec3(first ? +a.x : +b.x, first ? +a.y : +b.y, first ? +a.z : +b.z);
  }

  static SHARED_FN void scatterOpaque(HitLanes& h) {
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const Event d = scatterDiffuse(h.baseColour_[i], h.ng_[i], h.ns_[i], random(h, i));
      const Event e =
          scatterAny(bsdf(h, i), -h.rayDirection_[i], h.ng_[i], h.ns_[i], h.entering_[i], random(h, i));
      const bool lambert = h.isLambert_[i] != 0;
      const Event chosen{select(lambert, d.wi, e.wi), select(lambert, d.weight, e.weight),
                         lambert ? +d.lobe : +e.lobe, lambert ? +d.roulette : +e.roulette};
      book(h, i, chosen);
    }
  }

  static SHARED_FN void pack(HitLanes& h) {
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      h.packedDirection[i] = packDirection(-h.rayDirection_[i]);
      h.packedNormal[i] = packDirection(h.ng_[i]);
      h.stores[i] = hasNonDeltaLobe(bsdf(h, i)) > 0.5f ? 1u : 0u;
    }
  }
};

namespace {

ISOPHOTE_SIMD(placeHits, HitLoops::place, (HitLanes & h), (h))
ISOPHOTE_SIMD(findTexels, HitLoops::findTexels,
              (TextureLanes & t, const Lanes<float>& uvX, const Lanes<float>& uvY), (t, uvX, uvY))
ISOPHOTE_SIMD(applyColour, HitLoops::applyColour, (HitLanes & h), (h))
ISOPHOTE_SIMD(applyMetallicRoughness, HitLoops::applyMetallicRoughness, (HitLanes & h), (h))
ISOPHOTE_SIMD(packHits, HitLoops::pack, (HitLanes & h), (h))
ISOPHOTE_SIMD(drawEvents, HitLoops::draw, (HitLanes & h, const BlockRandom& random, std::uint32_t event),
              (h, random, event))
ISOPHOTE_SIMD(scatterLambert, HitLoops::scatterLambert, (HitLanes & h), (h))
ISOPHOTE_SIMD(scatterOpaque, HitLoops::scatterOpaque, (HitLanes & h), (h))

}  // namespace

void HitLanes::clear() {
  count = 0;
  textured_ = textureOfMetal_ = false;
  lambert_ = true;
  transmitting_ = 0;
}

void HitLanes::load(const TraceScene& trace, const Hit& hit, const vec3& rayDirection,
                    std::uint32_t pathOfHit, const vec3& powerOfHit, float densityOfHit) {
  const std::uint32_t lane = count++;
  const ShadedInstance& instance = trace.instance(hit.instance);
  float floats[24];
  if (instance.identity) {
    std::memcpy(floats, instance.triangles + hit.triangle, sizeof(floats));
  } else {
    const ShadedTriangle t = worldTriangle(instance, hit.triangle);
    std::memcpy(floats, &t, sizeof(floats));
  }
  for (std::uint32_t k = 0; k < 24; ++k) triangle_[k][lane] = floats[k];
  u_[lane] = hit.u;
  v_[lane] = hit.v;
  rayDirection_.set(lane, rayDirection);
  path[lane] = pathOfHit;
  power.set(lane, powerOfHit);
  density[lane] = densityOfHit;
  const ShadedMaterial& m = *instance.shadedMaterial;
  material_[lane] = &m;
  baseColour_.set(lane, m.baseColour);
  textured_ |= m.textured;
  textureOfMetal_ |= m.textureOfMetal;
  lambert_ &= m.scattering == Scattering::kLambert;
  if (m.scattering == Scattering::kAny) {
    transmitting_ |= 1u << lane;
    hit_[lane] = hit;
  }
}

void HitLanes::loadTextures() {
  for (std::uint32_t i = 0; i < count; ++i) loadTexture(colourTexture_, i, material_[i]->colourTexture);
  if (!textureOfMetal_) return;
  for (std::uint32_t i = 0; i < count; ++i)
    loadTexture(metallicRoughnessTexture_, i, material_[i]->metallicRoughnessTexture);
}

void HitLanes::loadMaterials() {
  for (std::uint32_t i = 0; i < count; ++i) {
    const ShadedMaterial& m = *material_[i];
    metallic_[i] = m.metallic;
    roughness_[i] = m.roughness;
    specular_[i] = m.specular;
    ior_[i] = m.ior;
    isLambert_[i] = m.scattering == Scattering::kLambert ? 1 : 0;
  }
}

void HitLanes::place() {
  const SimdLevel level = bestSimdLevel();
  placeHitsFor(level)(*this);
  if (!textured_) return;
  loadTextures();
  findTexelsFor(level)(colourTexture_, uvX_, uvY_);
  prefetchSquares(colourTexture_, count);
  if (!textureOfMetal_) return;
  findTexelsFor(level)(metallicRoughnessTexture_, uvX_, uvY_);
  prefetchSquares(metallicRoughnessTexture_, count);
}

void HitLanes::arrive(const TraceScene& trace) {
  const SimdLevel level = bestSimdLevel();
  loadMaterials();
  if (textured_) {
    fetchTexels(colourTexture_, count);
    applyColourFor(level)(*this);
  }
  if (textureOfMetal_) {
    fetchTexels(metallicRoughnessTexture_, count);
    applyMetallicRoughnessFor(level)(*this);
  }
  packHitsFor(level)(*this);
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((transmitting_ >> i & 1u) == 0u) continue;
    bsdf_[i] = surfaceAt(trace, {vec3(0.0f), 0.0f, rayDirection_[i]}, hit_[i]).bsdf;
    stores[i] = hasNonDeltaLobe(bsdf_[i]) > 0.5f ? 1u : 0u;
  }
}

void HitLanes::scatter(const BlockRandom& random, std::uint32_t event) {
  const SimdLevel level = bestSimdLevel();
  drawEventsFor(level)(*this, random, event);
  if (lambert_) {
    scatterLambertFor(level)(*this);
    return;
  }
  VectorLanes arrived;
  Lanes<float> arrivedDensity;
  if (transmitting_ != 0u) {
    arrived = power;
    arrivedDensity = density;
  }
  scatterOpaqueFor(level)(*this);
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((transmitting_ >> i & 1u) == 0u) continue;
    power.set(i, arrived[i]);
    density[i] = arrivedDensity[i];
    HitLoops::book(
        *this, i,
        scatterAny(bsdf_[i], -rayDirection_[i], ng_[i], ns_[i], entering_[i], HitLoops::random(*this, i)));
  }
}

float HitLanes::sumOf(const Lanes<float>& lanes) const {
  float sums[kLanes];
  for (std::uint32_t i = 0; i < kLanes; ++i) sums[i] = i < count ? lanes[i] : 0.0f;
  for (std::uint32_t half = kLanes / 2; half > 0; half /= 2)
    for (std::uint32_t i = 0; i < half; ++i) sums[i] += sums[i + half];
  return sums[0];
}

}  // namespace isophote

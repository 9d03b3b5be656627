// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/hit_lanes.h"

#include "math/simd.h"

#include <cstring>
#include <limits>

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
void wantSquares(const TextureLanes& t, std::uint32_t count, PrefetchQueue& queue) {
  for (std::uint32_t i = 0; i < count; ++i) {
    queue.want(t.rgba[i] + std::size_t(t.index[0][i]) * 4);
    queue.want(t.rgba[i] + std::size_t(t.index[2][i]) * 4);
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

  /// An index of type int is what processors gather by.
  template <class T>
  static SHARED_FN void gather(T* __restrict to, const T* __restrict from, const int* __restrict index) {
    for (std::uint32_t i = 0; i < kLanes; ++i) to[i] = from[index[i]];
  }

  static SHARED_FN void gather(VectorLanes& to, const VectorColumn& from, const Lanes<int>& index) {
    gather(to.x.values, from.x.values, index.values);
    gather(to.y.values, from.y.values, index.values);
    gather(to.z.values, from.z.values, index.values);
  }

  static SHARED_FN void gather(HitLanes& h, const float* triangles, const PathColumns& paths) {
    for (int k = 0; k < 24; ++k) gather(h.triangle_[k].values, triangles + k, h.firstFloat_.values);
    gather(h.path.values, paths.path.values, h.slot_.values);
    gather(h.light.values, paths.light.values, h.slot_.values);
    gather(h.density.values, paths.density.values, h.slot_.values);
    gather(h.power, paths.power, h.slot_);
    gather(h.rayDirection_, paths.direction, h.slot_);
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

  static SHARED_FN void draw(HitLanes& h, const PathRandom& random, std::uint32_t event) {
    if (event < kSobolEvents) {
      for (std::uint32_t d = 0; d < 3; ++d)
        sobolBody(random, kEventDimension + 3 * event + d, h.path.values, h.light.values, kLanes,
                  h.random_[d].values);
    } else {
      hashedBody(random, event, h.path.values, h.light.values, kLanes, h.random_[0].values,
                 h.random_[1].values, h.random_[2].values);
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

ISOPHOTE_SIMD(gatherHits, HitLoops::gather, (HitLanes & h, const float* triangles, const PathColumns& paths),
              (h, triangles, paths))
ISOPHOTE_SIMD(placeHits, HitLoops::place, (HitLanes & h), (h))
ISOPHOTE_SIMD(findTexels, HitLoops::findTexels,
              (TextureLanes & t, const Lanes<float>& uvX, const Lanes<float>& uvY), (t, uvX, uvY))
ISOPHOTE_SIMD(applyColour, HitLoops::applyColour, (HitLanes & h), (h))
ISOPHOTE_SIMD(applyMetallicRoughness, HitLoops::applyMetallicRoughness, (HitLanes & h), (h))
ISOPHOTE_SIMD(packHits, HitLoops::pack, (HitLanes & h), (h))
ISOPHOTE_SIMD(drawEvents, HitLoops::draw, (HitLanes & h, const PathRandom& random, std::uint32_t event),
              (h, random, event))
ISOPHOTE_SIMD(scatterLambert, HitLoops::scatterLambert, (HitLanes & h), (h))
ISOPHOTE_SIMD(scatterOpaque, HitLoops::scatterOpaque, (HitLanes & h), (h))

}  // namespace

void HitLanes::clear() {
  count = 0;
  textured_ = textureOfMetal_ = false;
  lambert_ = true;
  transformed_ = transmitting_ = 0;
}

void HitLanes::add(const TraceScene& trace, const Hit& hit, std::uint32_t slot, PrefetchQueue& queue) {
  const std::uint32_t lane = count++;
  const ShadedInstance& instance = trace.instance(hit.instance);
  const ShadedTriangle* triangle = instance.triangles + hit.triangle;
  queue.want(triangle);
  queue.want(&triangle->uv[2].y);
  const std::ptrdiff_t firstFloat = (triangle - trace.triangles()) * 24;
  // What is far beyond the reach of an index of 32 bits goes the way of triangles that want a transformation.
  const bool near = firstFloat <= std::numeric_limits<int>::max() - 24;
  firstFloat_[lane] = near ? int(firstFloat) : 0;
  slot_[lane] = int(slot);
  u_[lane] = hit.u;
  v_[lane] = hit.v;
  const ShadedMaterial& m = *instance.shadedMaterial;
  material_[lane] = &m;
  baseColour_.set(lane, m.baseColour);
  textured_ |= m.textured;
  textureOfMetal_ |= m.textureOfMetal;
  lambert_ &= m.scattering == Scattering::kLambert;
  const bool transformed = !near || !instance.inWorldSpace, transmits = m.scattering == Scattering::kAny;
  if (!transformed && !transmits) return;
  hit_[lane] = hit;
  transformed_ |= (transformed ? 1u : 0u) << lane;
  transmitting_ |= (transmits ? 1u : 0u) << lane;
}

void HitLanes::transformTriangles(const TraceScene& trace) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((transformed_ >> i & 1u) == 0u) continue;
    const ShadedTriangle t = worldTriangle(trace.instance(hit_[i].instance), hit_[i].triangle);
    float floats[24];
    std::memcpy(floats, &t, sizeof(floats));
    for (std::uint32_t k = 0; k < 24; ++k) triangle_[k][i] = floats[k];
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

void HitLanes::place(const TraceScene& trace, const PathColumns& paths, PrefetchQueue& queue) {
  const SimdLevel level = bestSimdLevel();
  gatherHitsFor(level)(*this, &trace.triangles()->position[0].x, paths);
  if (transformed_ != 0u) transformTriangles(trace);
  queue.ask(kAskedAtOnce);
  placeHitsFor(level)(*this);
  queue.ask(kAskedAtOnce);
  if (!textured_) return;
  loadTextures();
  findTexelsFor(level)(colourTexture_, uvX_, uvY_);
  queue.ask(kAskedAtOnce);
  wantSquares(colourTexture_, count, queue);
  if (!textureOfMetal_) return;
  findTexelsFor(level)(metallicRoughnessTexture_, uvX_, uvY_);
  wantSquares(metallicRoughnessTexture_, count, queue);
}

void HitLanes::arrive(const TraceScene& trace, PrefetchQueue& queue) {
  const SimdLevel level = bestSimdLevel();
  loadMaterials();
  if (textured_) {
    fetchTexels(colourTexture_, count);
    queue.ask(kAskedAtOnce);
    if (textureOfMetal_) {
      fetchTexels(metallicRoughnessTexture_, count);
      applyMetallicRoughnessFor(level)(*this);
      queue.ask(kAskedAtOnce);
    }
    applyColourFor(level)(*this);
    queue.ask(kAskedAtOnce);
  }
  packHitsFor(level)(*this);
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((transmitting_ >> i & 1u) == 0u) continue;
    bsdf_[i] = surfaceAt(trace, {vec3(0.0f), 0.0f, rayDirection_[i]}, hit_[i]).bsdf;
    stores[i] = hasNonDeltaLobe(bsdf_[i]) > 0.5f ? 1u : 0u;
  }
}

void HitLanes::scatter(const PathRandom& random, std::uint32_t event) {
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

void HitLanes::addTo(Lanes<float>& sum, const Lanes<float>& lanes) const {
  for (std::uint32_t i = 0; i < count; ++i) sum[i] += lanes[i];
}

}  // namespace isophote

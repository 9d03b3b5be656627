// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/hit_lanes.h"

#include "math/simd.h"
#include "physics/shading_normal.shared.h"

#include <algorithm>
#include <limits>

namespace isophote {

namespace {

using HitTextures = TextureLanes<kHitLanes>;

/// Texels on one row lie on one line of memory, mostly.
void wantSquares(const HitTextures& t, std::uint32_t count, PrefetchQueue& queue) {
  for (std::uint32_t i = 0; i < count; ++i) {
    queue.want(t.rgba[i] + std::size_t(t.index[0][i]) * 4);
    queue.want(t.rgba[i] + std::size_t(t.index[2][i]) * 4);
  }
}

void fetchTexels(HitTextures& t, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) t.fetch(i);
}

/// The words of triangles, whatever lies in them.
using TriangleWord [[gnu::may_alias]] = std::uint32_t;

/// Least alpha whose inverse stored photons are multiplied by: below, they count for less than they stand
/// for.
constexpr float kLeastStoredAlpha = 1.0f / 32.0f;

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
  return {sample.wi, sample.weight, sample.lobe, sample.rest};
}

}  // namespace

/// The loops over lanes, compiled for each instruction set.
struct HitLoops {
  /// An index of type int is what processors gather by.
  template <class To, class From>
  static SHARED_FN void gather(To* __restrict to, const From* __restrict from, const int* __restrict index) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) to[i] = from[index[i]];
  }

  static SHARED_FN void gather(HitVectors& to, const VectorColumn& from, const HitColumn<int>& index) {
    gather(to.x.values, from.x.values, index.values);
    gather(to.y.values, from.y.values, index.values);
    gather(to.z.values, from.z.values, index.values);
  }

  static SHARED_FN void gather(HitLanes& h, const TriangleWord* triangles, const PathColumns& paths) {
    for (std::uint32_t k = 0; k < kTriangleWords; ++k)
      gather(h.triangles_.words[k].values, triangles + k, h.firstWord_.values);
    gather(h.path.values, paths.path.values, h.slot_.values);
    gather(h.light.values, paths.light.values, h.slot_.values);
    gather(h.density.values, paths.density.values, h.slot_.values);
    gather(h.power, paths.power, h.slot_);
    gather(h.rayDirection_, paths.direction, h.slot_);
  }

  static SHARED_FN void place(HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      h.points.place(i, h.triangles_[i], h.rayDirection_[i]);
      h.mean[i] = meanOf(h.power[i]);
    }
  }

  static SHARED_FN void applyColour(HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      const vec4 colour = h.colourTexture_.blended(i);
      h.baseColour_.set(i, h.baseColour_[i] * vec3(colour.x, colour.y, colour.z));
    }
  }

  static SHARED_FN void applyVertexColour(HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      const vec4 colour = colourAt(h.triangles_[i], h.points.u[i], h.points.v[i]);
      h.baseColour_.set(i, h.baseColour_[i] * vec3(colour.x, colour.y, colour.z));
    }
  }

  static SHARED_FN void applyNormal(HitLanes& h) {
    PointLanes<kHitLanes>& p = h.points;
    for (std::uint32_t i = 0; i < kHitLanes; ++i)
      p.ns.set(i, bentNormal(h.triangles_[i], p.u[i], p.v[i], p.ns[i], p.ng[i], p.side[i],
                             h.normalTexture_.blendedNormal(i), h.normalScale_[i]));
  }

  static SHARED_FN void applyMetallicRoughness(HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      const vec4 factors = h.metallicRoughnessTexture_.blended(i);
      h.roughness_[i] *= factors.y;
      h.metallic_[i] *= factors.z;
    }
  }

  static SHARED_FN void draw(HitLanes& h, const PathRandom& random, std::uint32_t event) {
    if (event < kSobolEvents) {
      for (std::uint32_t d = 0; d < 3; ++d)
        sobolBody(random, kEventDimension + 3 * event + d, h.path.values, h.light.values, kHitLanes,
                  h.random_[d].values);
    } else {
      hashedBody(random, event, h.path.values, h.light.values, kHitLanes, h.random_[0].values,
                 h.random_[1].values, h.random_[2].values);
    }
  }

  static SHARED_FN void book(HitLanes& h, std::uint32_t i, const Event& e) {
    const vec3 power = h.power[i];
    const vec3 weight =
        e.weight * photonShadingFactor(-h.rayDirection_[i], e.wi, h.points.ng[i], h.points.ns[i]);
    const float survival = photonSurvival(power, weight);
    h.absorbed[i] = h.mean[i] - meanOf(power * weight);
    h.survives[i] = e.roulette < survival ? 1u : 0u;
    h.direction.set(i, e.wi);
    h.origin.set(i, offsetFrom(h.points.position[i], h.points.ng[i], e.wi));
    h.power.set(i, power * weight * (1.0f / max(survival, 1e-37f)));
    h.density[i] *= pathDensityFactor(e.lobe, min(meanOf(e.weight), 1.0f));
  }

  static SHARED_FN vec3 random(const HitLanes& h, std::uint32_t i) {
    return vec3(h.random_[0][i], h.random_[1][i], h.random_[2][i]);
  }

  static SHARED_FN void scatterLambert(HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i)
      book(h, i, scatterDiffuse(h.baseColour_[i], h.points.ng[i], h.points.ns[i], random(h, i)));
  }

  static SHARED_FN vec3 select(bool first, vec3 a, vec3 b) {
    return vec3(first ? +a.x : +b.x, first ? +a.y : +b.y, first ? +a.z : +b.z);
  }

  static SHARED_FN void scatterOpaque(HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      const Event d = scatterDiffuse(h.baseColour_[i], h.points.ng[i], h.points.ns[i], random(h, i));
      const Event e = scatterAny(h.opaqueBsdf(i), -h.rayDirection_[i], h.points.ng[i], h.points.ns[i],
                                 h.points.entering[i], random(h, i));
      const bool lambert = h.isLambert_[i] != 0;
      const Event chosen{select(lambert, d.wi, e.wi), select(lambert, d.weight, e.weight),
                         lambert ? +d.lobe : +e.lobe, lambert ? +d.roulette : +e.roulette};
      book(h, i, chosen);
    }
  }

  static SHARED_FN void pack(HitLanes& h) {
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      h.packedDirection[i] = packDirection(-h.rayDirection_[i]);
      h.packedNormal[i] = packDirection(h.points.ng[i]);
      h.stores[i] = hasNonDeltaLobe(h.opaqueBsdf(i)) > 0.5f ? 1u : 0u;
    }
  }
};

namespace {

ISOPHOTE_SIMD(gatherHits, HitLoops::gather,
              (HitLanes & h, const TriangleWord* triangles, const PathColumns& paths), (h, triangles, paths))
ISOPHOTE_SIMD(placeHits, HitLoops::place, (HitLanes & h), (h))
ISOPHOTE_SIMD(findTexels, t.find, (HitTextures & t, const HitColumn<float>& uvX, const HitColumn<float>& uvY),
              (uvX, uvY))
ISOPHOTE_SIMD(applyColour, HitLoops::applyColour, (HitLanes & h), (h))
ISOPHOTE_SIMD(applyVertexColour, HitLoops::applyVertexColour, (HitLanes & h), (h))
ISOPHOTE_SIMD(applyNormal, HitLoops::applyNormal, (HitLanes & h), (h))
ISOPHOTE_SIMD(applyMetallicRoughness, HitLoops::applyMetallicRoughness, (HitLanes & h), (h))
ISOPHOTE_SIMD(packHits, HitLoops::pack, (HitLanes & h), (h))
ISOPHOTE_SIMD(drawEvents, HitLoops::draw, (HitLanes & h, const PathRandom& random, std::uint32_t event),
              (h, random, event))
ISOPHOTE_SIMD(scatterLambert, HitLoops::scatterLambert, (HitLanes & h), (h))
ISOPHOTE_SIMD(scatterOpaque, HitLoops::scatterOpaque, (HitLanes & h), (h))

}  // namespace

void HitLanes::clear() {
  if (count == 0 || odd_ != 0u) std::fill_n(storedShare.values, kHitLanes, 1.0f);
  count = 0;
  textured_ = textureOfMetal_ = normalMapped_ = coloured_ = false;
  lambert_ = true;
  transformed_ = odd_ = attenuated_ = 0;
}

void HitLanes::add(const TraceScene& trace, const Hit& hit, std::uint32_t slot, PrefetchQueue& queue) {
  const std::uint32_t lane = count++;
  const ShadedInstance& instance = trace.instance(hit.instance);
  const ShadedTriangle* triangle = instance.triangles + hit.triangle;
  queue.want(triangle);
  queue.want(&triangle->uv[2].y);
  const std::ptrdiff_t firstWord = (triangle - trace.triangles()) * std::ptrdiff_t(kTriangleWords);
  // What is far beyond the reach of an index of 32 bits goes the way of triangles that want a transformation.
  const bool near = firstWord <= std::numeric_limits<int>::max() - int(kTriangleWords);
  firstWord_[lane] = near ? int(firstWord) : 0;
  slot_[lane] = int(slot);
  points.u[lane] = hit.u;
  points.v[lane] = hit.v;
  const ShadedMaterial& m = *instance.shadedMaterial;
  material_[lane] = &m;
  baseColour_.set(lane, m.baseColour);
  textured_ |= m.textured;
  textureOfMetal_ |= m.textureOfMetal;
  normalMapped_ |= m.normalMapped;
  coloured_ |= instance.coloured;
  lambert_ &= m.scattering == Scattering::kLambert;
  const bool transformed = !near || !instance.inWorldSpace, odd = m.scattering == Scattering::kAny;
  if (!transformed && !odd && !trace.absorbs()) return;
  hit_[lane] = hit;
  transformed_ |= (transformed ? 1u : 0u) << lane;
  odd_ |= (odd ? 1u : 0u) << lane;
}

void HitLanes::transformTriangles(const TraceScene& trace) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((transformed_ >> i & 1u) == 0u) continue;
    triangles_.set(i, worldTriangle(trace.instance(hit_[i].instance), hit_[i].triangle));
  }
}

void HitLanes::loadTextures() {
  for (std::uint32_t i = 0; i < count; ++i) colourTexture_.set(i, material_[i]->colourTexture);
  for (std::uint32_t i = 0; textureOfMetal_ && i < count; ++i)
    metallicRoughnessTexture_.set(i, material_[i]->metallicRoughnessTexture);
  for (std::uint32_t i = 0; normalMapped_ && i < count; ++i) {
    normalTexture_.set(i, material_[i]->normalTexture);
    normalScale_[i] = material_[i]->normalScale;
  }
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
  gatherHitsFor(level)(*this, reinterpret_cast<const TriangleWord*>(trace.triangles()), paths);
  if (transformed_ != 0u) transformTriangles(trace);
  queue.ask(kAskedAtOnce);
  placeHitsFor(level)(*this);
  queue.ask(kAskedAtOnce);
  if (trace.absorbs())
    for (std::uint32_t i = 0; i < count; ++i) medium[i] = paths.medium[std::uint32_t(slot_[i])];
  if (!textured_) return;
  loadTextures();
  findTexelsFor(level)(colourTexture_, points.uvX, points.uvY);
  queue.ask(kAskedAtOnce);
  wantSquares(colourTexture_, count, queue);
  if (normalMapped_) {
    findTexelsFor(level)(normalTexture_, points.uvX, points.uvY);
    wantSquares(normalTexture_, count, queue);
  }
  if (textureOfMetal_) {
    findTexelsFor(level)(metallicRoughnessTexture_, points.uvX, points.uvY);
    wantSquares(metallicRoughnessTexture_, count, queue);
  }
}

/// Reads the texels and applies what they say.
void HitLanes::applyTextures(PrefetchQueue& queue) {
  const SimdLevel level = bestSimdLevel();
  fetchTexels(colourTexture_, count);
  queue.ask(kAskedAtOnce);
  if (textureOfMetal_) {
    fetchTexels(metallicRoughnessTexture_, count);
    applyMetallicRoughnessFor(level)(*this);
    queue.ask(kAskedAtOnce);
  }
  if (normalMapped_) {
    fetchTexels(normalTexture_, count);
    applyNormalFor(level)(*this);
    queue.ask(kAskedAtOnce);
  }
  applyColourFor(level)(*this);
  queue.ask(kAskedAtOnce);
}

void HitLanes::arrive(const TraceScene& trace, PrefetchQueue& queue) {
  const SimdLevel level = bestSimdLevel();
  loadMaterials();
  if (textured_) applyTextures(queue);
  if (coloured_) applyVertexColourFor(level)(*this);
  packHitsFor(level)(*this);
  for (std::uint32_t i = 0; i < count; ++i)
    if ((odd_ >> i & 1u) != 0u) shadeOdd(trace, i);
  if (trace.absorbs()) absorb(trace);
}

void HitLanes::shadeOdd(const TraceScene& trace, std::uint32_t i) {
  const Surface s = surfaceAt(trace, {vec3(0.0f), 0.0f, rayDirection_[i]}, hit_[i]);
  bsdf_[i] = s.bsdf;
  stores[i] = hasNonDeltaLobe(s.bsdf) > 0.5f ? 1u : 0u;
  storedShare[i] = 1.0f / max(s.coverage, kLeastStoredAlpha);
  solid_[i] = s.solid;
  inside_[i] = s.absorption != vec3(0.0f) ? hit_[i].instance + 1 : 0u;
}

/// Takes from the photons what the solids that they came through absorb.
void HitLanes::absorb(const TraceScene& trace) {
  for (std::uint32_t i = 0; i < count; ++i) {
    // What is met from its inside is what was gone through, whatever the path has entered before.
    const bool inside = (odd_ >> i & 1u) != 0u && points.entering[i] < 0.5f && solid_[i] > 0.5f;
    if (inside) medium[i] = inside_[i];
    if (medium[i] == 0u) continue;
    const vec3 kept = transmittanceOver(trace.instance(medium[i] - 1).material->absorption, hit_[i].t);
    power.set(i, power[i] * kept);
    left_[i] = meanOf(power[i]) / max(mean[i], 1e-37f);
    attenuated_ |= 1u << i;
  }
}

void HitLanes::scatter(const PathRandom& random, std::uint32_t event) {
  const SimdLevel level = bestSimdLevel();
  drawEventsFor(level)(*this, random, event);
  if (lambert_) {
    scatterLambertFor(level)(*this);
  } else {
    HitVectors arrived;
    HitColumn<float> arrivedDensity;
    if (odd_ != 0u) {
      arrived = power;
      arrivedDensity = density;
    }
    scatterOpaqueFor(level)(*this);
    for (std::uint32_t i = 0; i < count; ++i) {
      if ((odd_ >> i & 1u) == 0u) continue;
      power.set(i, arrived[i]);
      density[i] = arrivedDensity[i];
      scatterOdd(i);
    }
  }
  for (std::uint32_t i = 0; i < count; ++i)
    if ((attenuated_ >> i & 1u) != 0u) thinOut(random, event, i);
}

void HitLanes::scatterOdd(std::uint32_t i) {
  const vec3 wo = -rayDirection_[i];
  const Event e =
      scatterAny(bsdf_[i], wo, points.ng[i], points.ns[i], points.entering[i], HitLoops::random(*this, i));
  HitLoops::book(*this, i, e);
  if (solid_[i] > 0.5f && dot(e.wi, points.ng[i]) < 0.0f)
    medium[i] = points.entering[i] > 0.5f ? inside_[i] : 0u;
}

/// Roulette for what was absorbed on the way, so that photons stay as few and as strong as they were.
void HitLanes::thinOut(const PathRandom& random, std::uint32_t event, std::uint32_t i) {
  const uint key = pathKey(random.seed, random.pass, light[i], path[i]);
  const float chance = random3(key, event, 1u).x;
  survives[i] &= chance < left_[i] ? 1u : 0u;
  power.set(i, power[i] * (1.0f / max(left_[i], 1e-37f)));
}

void HitLanes::addTo(HitColumn<float>& sum, const HitColumn<float>& lanes) const {
  for (std::uint32_t i = 0; i < count; ++i) sum[i] += lanes[i];
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// How a surface scatters light: Lambert under a Fresnel-weighted GGX reflection (glTF's metallic-roughness
// parameters), perfect mirrors, and dielectrics that refract, smooth or rough (GGX facets that refract:
// Walter et al. 2007).
//
// Directions: wo and wi are unit and point away from the surface; light arrives along -wi. ng is the
// geometric and ns the shading normal, both unit, with dot(wo, ng) >= 0 and dot(ng, ns) > 0. Surfaces are
// shaded alike from both sides. A direction that lies above the surface but below the shading normal's plane
// counts as its opposite, which lies below the surface but above that plane: each shading direction then has
// one real one, so that shading normals cost no energy, leave no gaps between samples and values, and keep
// reciprocity.
#ifndef ISOPHOTE_PHYSICS_BSDF_SHARED_H
#define ISOPHOTE_PHYSICS_BSDF_SHARED_H

#include "math/sampling.shared.h"
#include "math/shared.h"
#include "physics/material.shared.h"

SHARED_BEGIN

/// A material at one point, textures looked up. 64 bytes.
struct Bsdf {
  vec3 diffuse;       ///< Lambertian reflectance times the coupling's normalisation (see bsdfFromMaterial).
  float alpha;        ///< GGX width; 0: the reflection is a perfect mirror.
  vec3 f0;            ///< Reflectance at normal incidence; 0 with f90 = 0: no reflection.
  float f90;          ///< Reflectance at grazing incidence.
  vec3 transmission;  ///< Tint of the light that refracts through, 0 for none.
  float ior;          ///< Index of refraction of the inside against the outside.
  float coupling0;    ///< Dielectric reflectance at normal incidence, taken from the diffuse part.
  float coupling90;
  uint flags;     ///< kMaterial... bits.
  float through;  ///< Part of the surface that is clear: it reflects and refracts as a dielectric boundary
                  ///< does, seen from either side.
};

SHARED_CONST uint kLobeNone = 0u;
SHARED_CONST uint kLobeDiffuse = 1u;
SHARED_CONST uint kLobeGlossy = 2u;
SHARED_CONST uint kLobeMirror = 3u;        ///< A delta.
SHARED_CONST uint kLobeRefract = 4u;       ///< A delta; through thin walls straight on.
SHARED_CONST uint kLobeRoughRefract = 5u;  ///< To the other side by GGX facets; through thin walls unbent.
/// Indices of refraction closer to 1 bend nothing: however rough, such a boundary passes light straight on.
SHARED_CONST float kLeastBend = 1e-3f;

struct BsdfSample {
  vec3 wi;         ///< Sampled direction.
  uint lobe;       ///< kLobeNone: absorbed.
  vec3 weight;     ///< What power is multiplied by: f * |dot(wi, ns)| / (pdf * etaScale), everything
                   ///< multiplied in; deltas: their reflectance over the choice's probability.
  float pdf;       ///< Of all non-delta lobes together, per solid angle; 0 for deltas.
  float etaScale;  ///< (n of wo's side / n of wi's side)^2: what radiance (not power) is multiplied by as
                   ///< well; 1 unless refracted into or out of a solid.
  float rest;      ///< A number in [0, 1) that the choice of the lobe has left over.
};

SHARED_FN float pow5(float x) {
  float x2 = x * x;
  return x2 * x2 * x;
}

SHARED_FN float schlick(float f0, float f90, float cosTheta) {
  return f0 + (f90 - f0) * pow5(clamp(1.0f - cosTheta, 0.0f, 1.0f));
}

SHARED_FN float meanOf(vec3 v) { return (v.x + v.y + v.z) * (1.0f / 3.0f); }
SHARED_FN float maxOf(vec3 v) { return max(v.x, max(v.y, v.z)); }

/// Unpolarised reflectance of a smooth dielectric; eta = n of the other side / n of the incident side.
SHARED_FN float fresnelDielectric(float cosIncident, float eta) {
  float sin2 = (1.0f - cosIncident * cosIncident) / (eta * eta);
  float cosOther = sqrt(max(0.0f, 1.0f - sin2));
  float s = (cosIncident - eta * cosOther) / (cosIncident + eta * cosOther);
  float p = (eta * cosIncident - cosOther) / (eta * cosIncident + cosOther);
  return sin2 >= 1.0f ? 1.0f : 0.5f * (s * s + p * p);
}

/// Schlick's F is convex: its mean over rough facets exceeds that of their mean normal, by up to this much of
/// f90 (found by quadrature: 0.0025 at roughness 0.4 and 49 degrees). What lies below gives it up.
SHARED_CONST float kRoughFresnelExcess = 0.003f;

/// Material at a point where the textures gave these values.
/// The diffuse part is what the dielectric's reflection leaves, in a form that keeps reciprocity and energy:
/// (1 - F(wi)) (1 - F(wo)) / (1 - mean F), with Schlick's F, whose cosine-weighted mean is f0 + (f90 - f0)
/// / 21. The divisor is multiplied into `diffuse`.
SHARED_FN Bsdf bsdfFromMaterial(Material m, vec3 baseColour, float metallic, float roughness,
                                float transmission) {
  float dielectric = (m.ior - 1.0f) / (m.ior + 1.0f);
  float through = transmission * (1.0f - metallic);
  vec3 f0 = min(m.specularColour * (dielectric * dielectric), vec3(1.0f)) * m.specular;
  Bsdf b;
  // A coloured reflection takes from below what its strongest channel takes, so that colours stay what they
  // are.
  b.coupling0 = maxOf(f0);
  b.coupling90 = m.specular;
  float meanFresnel = b.coupling0 + (b.coupling90 - b.coupling0) * (1.0f / 21.0f);
  float normalisation = 1.0f / max(1.0f - meanFresnel, 1e-3f);
  b.alpha = roughness <= kMirrorRoughness ? 0.0f : roughness * roughness;
  float left = b.alpha > 0.0f ? 1.0f - kRoughFresnelExcess * m.specular : 1.0f;
  b.diffuse = baseColour * ((1.0f - metallic) * (1.0f - transmission) * normalisation * left);
  b.f0 = mix(f0, baseColour, metallic);
  b.f90 = mix(m.specular, 1.0f, metallic);
  b.transmission = baseColour * (through * left);
  b.ior = m.ior;
  b.flags = m.flags;
  b.through = through;
  return b;
}

SHARED_FN float couplingFactor(Bsdf b, float cosTheta) {
  return 1.0f - schlick(b.coupling0, b.coupling90, cosTheta);
}

/// 1 where light goes through by rough facets, 0 where it does so as a delta or not at all.
SHARED_FN float refractsRoughly(Bsdf b) {
  float bends = (b.flags & kMaterialThinWalled) != 0u || abs(b.ior - 1.0f) > kLeastBend ? 1.0f : 0.0f;
  return b.through > 0.0f && b.alpha > 0.0f ? bends : 0.0f;
}

/// 1 where the surface has a lobe that light can be estimated with: anything but perfect mirrors and clear
/// glass.
SHARED_FN float hasNonDeltaLobe(Bsdf b) {
  return maxOf(b.diffuse) > 0.0f || (b.alpha > 0.0f && b.f90 > 0.0f) || refractsRoughly(b) > 0.5f ? 1.0f
                                                                                                  : 0.0f;
}

SHARED_FN float hasDeltaLobe(Bsdf b) {
  return (b.alpha == 0.0f && b.f90 > 0.0f) || (maxOf(b.transmission) > 0.0f && refractsRoughly(b) < 0.5f)
             ? 1.0f
             : 0.0f;
}

/// Reflectance of the boundary of the clear part of a surface. `entering` is 1 when wo lies outside of a
/// solid. Exact for a smooth one; a rough one, whose reflection evalBsdf approximates, uses Schlick's F of
/// the angle outside (from both sides alike, which is what makes refraction reciprocal).
SHARED_FN float clearReflectance(Bsdf b, float cosTheta, float entering) {
  float thin = (b.flags & kMaterialThinWalled) != 0u ? 1.0f : 0.0f;
  float outside = max(entering, thin);
  float eta = outside > 0.5f ? b.ior : 1.0f / b.ior;
  float cos2Other = 1.0f - (1.0f - cosTheta * cosTheta) / (eta * eta);
  float cosOutside = outside > 0.5f ? cosTheta : sqrt(max(0.0f, cos2Other));
  float rough = cos2Other > 0.0f ? schlick(b.coupling0, b.coupling90, cosOutside) : 1.0f;
  float face = b.alpha > 0.0f ? rough : fresnelDielectric(cosTheta, eta);
  // A pane reflects from both of its faces, back and forth between them.
  return thin > 0.5f ? 2.0f * face / (1.0f + face) : face;
}

/// Part of the light from wo that refracts.
SHARED_FN vec3 refractedPart(Bsdf b, float cosTheta, float entering) {
  return b.transmission * (1.0f - clearReflectance(b, cosTheta, entering));
}

/// How much more of the light the boundary of the clear part reflects than Schlick's F says.
SHARED_FN float clearChange(Bsdf b, float cosTheta, float entering) {
  return b.through > 0.0f ? b.through * (clearReflectance(b, cosTheta, entering) -
                                         schlick(b.coupling0, b.coupling90, cosTheta))
                          : 0.0f;
}

/// Reflected part of the light from wo where the surface is a perfect mirror (and what a rough one reflects,
/// about): Schlick's, and that of the boundary where it is clear.
SHARED_FN vec3 mirrorReflectance(Bsdf b, float cosTheta, float entering) {
  float change = clearChange(b, cosTheta, entering);
  return vec3(max(schlick(b.f0.x, b.f90, cosTheta) + change, 0.0f),
              max(schlick(b.f0.y, b.f90, cosTheta) + change, 0.0f),
              max(schlick(b.f0.z, b.f90, cosTheta) + change, 0.0f));
}

/// GGX's density of half vectors: D. The clamp lies below its reach at the smallest alpha.
SHARED_FN float ggxDistribution(float alpha, float cosH) {
  float a2 = alpha * alpha;
  float d = cosH * cosH * (a2 - 1.0f) + 1.0f;
  return a2 * kInvPi / max(d * d, 1e-13f);
}

/// cosTheta times Smith's 1 + 2 Lambda, the inverse of the part of the facets that is seen.
SHARED_FN float ggxSmith(float alpha, float cosTheta) {
  float a2 = alpha * alpha;
  return sqrt(cosTheta * cosTheta * (1.0f - a2) + a2);
}

/// GGX with the height-correlated Smith term, both cosines of the denominator already divided out.
SHARED_FN float ggxOverCosines(float alpha, float cosH, float cosI, float cosO) {
  float visible = cosI * ggxSmith(alpha, cosO) + cosO * ggxSmith(alpha, cosI);
  return ggxDistribution(alpha, cosH) * 0.5f / max(visible, 1e-7f);
}

/// The sum of two directions, one turned to its opposite where they lie on different sides of the shading
/// normal's plane: along their half vector, up to its sign.
SHARED_FN vec3 halfSum(vec3 wi, vec3 wo, vec3 ns) {
  return wi + wo * (dot(wi, ns) * dot(wo, ns) < 0.0f ? -1.0f : 1.0f);
}

/// Where light from wo (n = 1 there) meets a facet that refracts it to wi: half vector, cosines, index.
struct FacetRefraction {
  vec3 h;         ///< On the side of the shading normal, unit.
  float cosI;     ///< |dot(wi, h)|
  float cosO;     ///< |dot(wo, h)|
  float eta;      ///< n of wi's side / n of wo's side; 1 for thin walls, whose facets mirror to the far side.
  float measure;  ///< eta^2 cosI / (cosO + eta dot(wi, h))^2: directions for each half vector.
  float valid;    ///< 1 where there is such a facet.
};

SHARED_FN FacetRefraction facetRefraction(Bsdf b, vec3 wi, vec3 wo, vec3 ns, float entering) {
  // In the frame of the shading normal: wo above, wi below.
  vec3 above = wo * (dot(wo, ns) < 0.0f ? -1.0f : 1.0f);
  vec3 below = wi * (dot(wi, ns) > 0.0f ? -1.0f : 1.0f);
  float thin = (b.flags & kMaterialThinWalled) != 0u ? 1.0f : 0.0f;
  FacetRefraction r;
  r.eta = thin > 0.5f ? 1.0f : entering > 0.5f ? b.ior : 1.0f / b.ior;
  // A pane's far side is the mirror image of its near side.
  vec3 far = thin > 0.5f ? below - ns * (2.0f * dot(below, ns)) : below * r.eta;
  vec3 sum = above + far;
  sum = sum * (dot(sum, ns) < 0.0f ? -1.0f : 1.0f);
  r.h = sum * inversesqrt(max(dot(sum, sum), 1e-12f));
  float o = dot(above, r.h);
  float i = dot(thin > 0.5f ? far : below, r.h);
  r.cosO = abs(o);
  r.cosI = abs(i);
  float bent = o + r.eta * i;
  float solid = r.eta * r.eta * r.cosI / max(bent * bent, 1e-9f);
  r.measure = thin > 0.5f ? 0.25f / max(r.cosO, 1e-6f) : solid;
  r.valid = o > 0.0f && (thin > 0.5f ? i > 0.0f : i < 0.0f) ? 1.0f : 0.0f;
  return r;
}

/// GGX's part of the facets with that cosine to the normal that are seen from a direction: Smith's G1.
SHARED_FN float ggxSeen(float alpha, float cosTheta) {
  return 2.0f * cosTheta / max(cosTheta + ggxSmith(alpha, cosTheta), 1e-7f);
}

/// (n of wo's side / n of wi's side)^2 for light that goes through.
SHARED_FN float radianceScale(Bsdf b, float entering) {
  float eta = entering > 0.5f ? b.ior : 1.0f / b.ior;
  return (b.flags & kMaterialThinWalled) != 0u ? 1.0f : 1.0f / (eta * eta);
}

/// Value of the rough refraction [1/sr], for wi and wo on different sides.
SHARED_FN vec3 evalRoughRefraction(Bsdf b, vec3 wi, vec3 wo, vec3 ns, float entering) {
  float cosI = max(abs(dot(wi, ns)), 1e-6f);
  float cosO = max(abs(dot(wo, ns)), 1e-6f);
  FacetRefraction r = facetRefraction(b, wi, wo, ns, entering);
  float d = ggxDistribution(b.alpha, min(dot(r.h, ns), 1.0f));
  float seen = ggxSeen(b.alpha, cosI) * ggxSeen(b.alpha, cosO);
  float value = d * seen * r.measure * r.cosO / (cosI * cosO) * radianceScale(b, entering) * r.valid;
  return refractedPart(b, min(r.cosO, 1.0f), entering) * value;
}

/// BSDF value of the non-delta lobes [1/sr], for radiance from wi that goes on along wo, which lies outside
/// of a solid where `entering` is 1; the cosine not multiplied in. Where wi and wo lie on different sides,
/// only rough refraction is left.
SHARED_FN vec3 evalBsdf(Bsdf b, vec3 wi, vec3 wo, vec3 ng, vec3 ns, float entering) {
  float cosI = abs(dot(wi, ns));
  float cosO = abs(dot(wo, ns));
  vec3 sum = halfSum(wi, wo, ns);
  float inverseLength = inversesqrt(max(dot(sum, sum), 1e-12f));
  float cosH = min(abs(dot(sum, ns)) * inverseLength, 1.0f);
  float cosD = min(abs(dot(sum, wo)) * inverseLength, 1.0f);
  float reflection = b.alpha > 0.0f ? ggxOverCosines(b.alpha, cosH, cosI, cosO) : 0.0f;
  float grazing = pow5(1.0f - cosD);
  vec3 fresnel = b.f0 + (vec3(b.f90) - b.f0) * grazing;
  fresnel = b.through > 0.0f ? max(fresnel + vec3(clearChange(b, cosD, entering)), vec3(0.0f)) : fresnel;
  float coupled = kInvPi * couplingFactor(b, cosI) * couplingFactor(b, cosO);
  float sameSide = dot(wi, ng) * dot(wo, ng) > 0.0f ? 1.0f : 0.0f;
  vec3 reflected = (b.diffuse * coupled + fresnel * reflection) * sameSide;
  return refractsRoughly(b) > 0.5f && sameSide < 0.5f ? evalRoughRefraction(b, wi, wo, ns, entering)
                                                      : reflected;
}

/// The value for a surface that does not transmit.
SHARED_FN vec3 evalBsdf(Bsdf b, vec3 wi, vec3 wo, vec3 ng, vec3 ns) {
  b.through = 0.0f;
  return evalBsdf(b, wi, wo, ng, ns, 1.0f);
}

/// Probabilities with which sampleBsdf chooses its lobes, in proportion to what they reflect towards wo:
/// diffuse, rough facets (which mirror or refract), mirror, smooth refraction.
SHARED_FN vec4 lobeProbabilities(Bsdf b, float cosO, float entering) {
  float reflection = meanOf(mirrorReflectance(b, cosO, entering));
  float diffuse = meanOf(b.diffuse) * couplingFactor(b, cosO);
  float through = b.through > 0.0f ? meanOf(refractedPart(b, cosO, entering)) : 0.0f;
  float rough = refractsRoughly(b);
  float glossy = b.alpha > 0.0f ? reflection + rough * through : 0.0f;
  float delta = b.alpha > 0.0f ? 0.0f : reflection;
  through = rough > 0.5f ? 0.0f : through;
  float sum = diffuse + glossy + delta + through;
  return vec4(diffuse, glossy, delta, through) * (sum > 0.0f ? 1.0f / sum : 0.0f);
}

/// Part of the light that a facet does not absorb that it refracts, at that angle to it.
SHARED_FN float facetShare(Bsdf b, float cosH, float entering) {
  if (refractsRoughly(b) < 0.5f) return 0.0f;
  float refracted = meanOf(refractedPart(b, cosH, entering));
  float reflected = meanOf(mirrorReflectance(b, cosH, entering));
  return refracted / max(refracted + reflected, 1e-7f);
}

/// Density of directions mirrored about a half vector of GGX's visible normals:
/// G1(wo) D(h) dot(wo, h) / cosO / (4 dot(wo, h)), finite at grazing angles too.
SHARED_FN float ggxVisibleNormalPdf(float alpha, float cosH, float cosO) {
  return ggxDistribution(alpha, cosH) * 0.5f / (cosO + ggxSmith(alpha, cosO));
}

/// Density of directions refracted at a half vector of GGX's visible normals.
SHARED_FN float roughRefractionPdf(Bsdf b, vec3 wi, vec3 wo, vec3 ns, float entering) {
  FacetRefraction r = facetRefraction(b, wi, wo, ns, entering);
  float visible = 4.0f * ggxVisibleNormalPdf(b.alpha, min(dot(r.h, ns), 1.0f), abs(dot(wo, ns)));
  return visible * r.cosO * r.measure * r.valid * facetShare(b, min(r.cosO, 1.0f), entering);
}

/// Density with which sampleBsdf returns wi from its non-delta lobes, per solid angle, given wo (which lies
/// outside where `entering` is 1). Includes the probability of choosing those lobes.
SHARED_FN float pdfBsdf(Bsdf b, vec3 wi, vec3 wo, vec3 ng, vec3 ns, float entering) {
  float cosO = abs(dot(wo, ns));
  vec4 p = lobeProbabilities(b, cosO, entering);
  vec3 sum = halfSum(wi, wo, ns);
  float inverseLength = inversesqrt(max(dot(sum, sum), 1e-12f));
  float cosH = min(abs(dot(sum, ns)) * inverseLength, 1.0f);
  float glossy = b.alpha > 0.0f ? ggxVisibleNormalPdf(b.alpha, cosH, cosO) : 0.0f;
  glossy = b.through > 0.0f
               ? glossy * (1.0f - facetShare(b, min(abs(dot(sum, wo)) * inverseLength, 1.0f), entering))
               : glossy;
  float pdf = p.x * abs(dot(wi, ns)) * kInvPi + p.y * glossy;
  float across = refractsRoughly(b) > 0.5f ? p.y * roughRefractionPdf(b, wi, wo, ns, entering) : 0.0f;
  return dot(wi, ng) * dot(wo, ng) > 0.0f ? pdf : across;
}

/// A half vector from GGX's visible normals around +z (Heitz 2018).
SHARED_FN vec3 sampleVisibleNormal(vec3 wo, float alpha, vec2 u) {
  vec3 stretched = normalize(vec3(alpha * wo.x, alpha * wo.y, wo.z));
  float lengthXy = stretched.x * stretched.x + stretched.y * stretched.y;
  vec3 t1 = lengthXy > 1e-12f ? vec3(-stretched.y, stretched.x, 0.0f) * inversesqrt(lengthXy)
                              : vec3(1.0f, 0.0f, 0.0f);
  vec3 t2 = cross(stretched, t1);
  vec2 d = sampleDisc(u);
  float s = 0.5f * (1.0f + stretched.z);
  float y = (1.0f - s) * sqrt(max(0.0f, 1.0f - d.x * d.x)) + s * d.y;
  vec3 n = t1 * d.x + t2 * y + stretched * sqrt(max(0.0f, 1.0f - d.x * d.x - y * y));
  return normalize(vec3(alpha * n.x, alpha * n.y, max(n.z, 1e-6f)));
}

/// Mirror direction of wo about ns; where that would go below the surface, about ng.
SHARED_FN vec3 mirrorDirection(vec3 wo, vec3 ng, vec3 ns) {
  vec3 r = 2.0f * dot(wo, ns) * ns - wo;
  return dot(r, ng) * dot(wo, ng) > 0.0f ? r : 2.0f * dot(wo, ng) * ng - wo;
}

/// Refracts wo through the surface; eta = n of the other side / n of wo's side. Call only without total
/// reflection.
SHARED_FN vec3 refractDirection(vec3 wo, vec3 n, float eta) {
  float cosO = dot(wo, n);
  float sin2 = max(0.0f, 1.0f - cosO * cosO) / (eta * eta);
  float cosT = sqrt(max(0.0f, 1.0f - sin2));
  return -wo / eta + n * (cosO / eta - cosT);
}

/// Direction in which light from wo is transmitted: bent at the surface of a solid, straight on through a
/// pane. etaScale becomes (n of wo's side / n of the other side)^2, what radiance is multiplied by. Not for
/// total reflection.
SHARED_FN vec3 refractionOf(Bsdf b, vec3 wo, vec3 ng, vec3 ns, float entering, OUT(float) etaScale) {
  float thin = (b.flags & kMaterialThinWalled) != 0u ? 1.0f : 0.0f;
  float eta = entering > 0.5f ? b.ior : 1.0f / b.ior;
  vec3 bent = refractDirection(wo, ns, eta);
  bent = dot(bent, ng) < 0.0f ? bent : refractDirection(wo, ng, eta);
  etaScale = thin > 0.5f ? 1.0f : 1.0f / (eta * eta);
  return thin > 0.5f ? -wo : normalize(bent);
}

/// The choice of a lobe, and what it leaves of the number that made it.
SHARED_FN uint chooseLobe(Bsdf b, vec4 p, float u, OUT(float) rest) {
  float low = u < p.x ? 0.0f : u < p.x + p.y ? p.x : u < p.x + p.y + p.z ? p.x + p.y : p.x + p.y + p.z;
  float width = u < p.x ? p.x : u < p.x + p.y ? p.y : u < p.x + p.y + p.z ? p.z : p.w;
  rest = clamp((u - low) / max(width, 1e-7f), 0.0f, 1.0f);
  return u < p.x                          ? kLobeDiffuse
         : u < p.x + p.y                  ? kLobeGlossy
         : u < p.x + p.y + p.z            ? kLobeMirror
         : b.through > 0.0f && p.w > 0.0f ? kLobeRefract
                                          : kLobeNone;
}

/// The direction below the shading normal into which a facet refracts light from `above`; wasRefracted is 0
/// where it reflects all. Thin walls pass what they would mirror to their far side.
SHARED_FN vec3 throughFacet(Bsdf b, vec3 above, vec3 h, vec3 ns, float entering, OUT(float) wasRefracted) {
  float thin = (b.flags & kMaterialThinWalled) != 0u ? 1.0f : 0.0f;
  float eta = entering > 0.5f ? b.ior : 1.0f / b.ior;
  float cosO = dot(above, h);
  vec3 mirrored = 2.0f * cosO * h - above;
  vec3 far = mirrored - ns * (2.0f * dot(mirrored, ns));
  float exists = 1.0f - (1.0f - cosO * cosO) / (eta * eta) > 0.0f ? 1.0f : 0.0f;
  vec3 wi = thin > 0.5f ? far : refractDirection(above, h, eta);
  wasRefracted = dot(wi, ns) < 0.0f ? max(exists, thin) : 0.0f;
  return normalize(wi);
}

/// Samples a direction in which light from wo goes on (photons: wo points to where the photon came from; eye
/// paths: to the eye). u in [0, 1)^3, the first picks the lobe. Roulette is the caller's: the weight's mean
/// is at most 1.
SHARED_FN BsdfSample sampleBsdf(Bsdf b, vec3 wo, vec3 ng, vec3 ns, float entering, vec3 u) {
  BsdfSample s;
  float cosO = abs(dot(wo, ns));
  vec4 p = lobeProbabilities(b, cosO, entering);
  vec2 u2 = vec2(u.y, u.z);
  s.etaScale = 1.0f;
  s.pdf = 0.0f;
  s.weight = vec3(0.0f);
  s.wi = ng;
  s.lobe = chooseLobe(b, p, u.x, s.rest);
  if (s.lobe == kLobeDiffuse || s.lobe == kLobeGlossy) {
    mat3 frame = basisAround(ns);
    vec3 wi = frame * sampleCosineHemisphere(u2);
    float kept = dot(wi, ns) > 0.0f ? 1.0f : 0.0f;
    if (s.lobe == kLobeGlossy) {
      vec3 above = wo * (dot(wo, ns) < 0.0f ? -1.0f : 1.0f);
      vec3 h =
          frame * sampleVisibleNormal(vec3(dot(above, frame[0]), dot(above, frame[1]), cosO), b.alpha, u2);
      float cosH = dot(above, h);
      wi = normalize(2.0f * cosH * h - above);
      // What the facets mirror downwards is lost: they shadow each other.
      kept = dot(wi, ns) > 0.0f ? 1.0f : 0.0f;
      float share = b.through > 0.0f ? facetShare(b, clamp(cosH, 0.0f, 1.0f), entering) : 0.0f;
      bool refracts = s.rest < share;
      s.rest = clamp((refracts ? s.rest : s.rest - share) / max(refracts ? share : 1.0f - share, 1e-7f), 0.0f,
                     1.0f);
      if (refracts) {
        wi = throughFacet(b, above, h, ns, entering, kept);
        s.lobe = kLobeRoughRefract;
        s.etaScale = radianceScale(b, entering);
      }
    }
    // Each shading direction has one real one, on the side of the surface that it is on in the normal's
    // frame.
    float wanted = s.lobe == kLobeRoughRefract ? -1.0f : 1.0f;
    wi = wi * (dot(wi, ng) * wanted < 0.0f ? -1.0f : 1.0f);
    s.wi = wi;
    s.pdf = kept * pdfBsdf(b, wi, wo, ng, ns, entering);
    s.weight = s.pdf > 0.0f
                   ? evalBsdf(b, wi, wo, ng, ns, entering) * (abs(dot(wi, ns)) / (s.pdf * s.etaScale))
                   : vec3(0.0f);
  } else if (s.lobe == kLobeMirror) {
    s.wi = mirrorDirection(wo, ng, ns);
    s.weight = mirrorReflectance(b, cosO, entering) / p.z;
  } else if (s.lobe == kLobeRefract) {
    s.wi = refractionOf(b, wo, ng, ns, entering, s.etaScale);
    s.weight = refractedPart(b, cosO, entering) / p.w;
  }
  s.lobe = maxOf(s.weight) > 0.0f ? s.lobe : kLobeNone;
  return s;
}

SHARED_END

#endif

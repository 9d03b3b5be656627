// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the BSDF's values must be; bsdf_sampling_test.cpp has its samples, dielectric_test.cpp refraction.
#include "physics/bsdf.shared.h"

#include "physics/test_materials.h"

#include <cmath>

namespace isophote {
namespace {

/// Mean over half vectors of what rough facets reflect and refract; each point of a square stands for the
/// same part of their density.
double facetAlbedo(Bsdf b, vec3 wo, float entering) {
  b.diffuse = vec3(0.0f);
  if (refractsRoughly(b) < 0.5f) b.transmission = vec3(0.0f);
  double sum = 0;
  constexpr int kSteps = 40;
  const auto add = [&](vec3 wi, double share, float scale) {
    const float pdf = pdfBsdf(b, wi, wo, kUp, kUp, entering) * scale;
    if (pdf <= 0.0f || share <= 0.0) return;
    sum += share * double(meanOf(evalBsdf(b, wi, wo, kUp, kUp, entering)) * std::abs(wi.z) / pdf) /
           (kSteps * kSteps);
  };
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const vec2 u((float(i) + 0.5f) / kSteps, (float(j) + 0.5f) / kSteps);
      const vec3 h = sampleVisibleNormal(wo, b.alpha, u);
      const vec3 mirrored = 2.0f * dot(wo, h) * h - wo;
      const double share = double(facetShare(b, dot(wo, h), entering));
      if (mirrored.z > 0.0f) add(mirrored, 1 - share, 1.0f);
      float refracted = 0;
      const vec3 below = throughFacet(b, wo, h, kUp, entering, refracted);
      if (share > 0 && refracted > 0.5f) add(below, share, radianceScale(b, entering));
    }
  return sum;
}

/// Part of the light from wo that the non-delta lobes reflect, by quadrature: over the cosine for the diffuse
/// part, which does not turn with the azimuth, over visible normals for the glossy one, which is flat there.
double nonDeltaAlbedo(const Bsdf& b, vec3 wo, float entering) {
  double sum = 0;
  Bsdf diffuse = b;
  diffuse.alpha = 0.0f;
  constexpr int kCosines = 256;
  for (int i = 0; i < kCosines; ++i) {
    const vec3 wi = directionAt((float(i) + 0.5f) / kCosines, 0.25f);
    sum += double(meanOf(evalBsdf(diffuse, wi, wo, kUp, kUp)) * wi.z) * 2 * M_PI / kCosines;
  }
  return b.alpha == 0.0f ? sum : sum + facetAlbedo(b, wo, entering);
}

double albedo(const Bsdf& b, vec3 wo, float entering) {
  const double mirror = b.alpha > 0.0f ? 0.0 : double(meanOf(mirrorReflectance(b, wo.z, entering)));
  const double through = refractsRoughly(b) > 0.5f ? 0.0 : double(meanOf(refractedPart(b, wo.z, entering)));
  return nonDeltaAlbedo(b, wo, entering) + mirror + through;
}

TEST(Bsdf, ValuesAreReciprocal) {
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const NamedBsdf m = randomMaterial(i);
    const vec3 ng = sampleSphere(vec2(randomTriple(1, i).x, randomTriple(1, i).y));
    const vec3 ns = normalize(ng + 0.9f * sampleSphere(vec2(randomTriple(2, i).x, randomTriple(2, i).y)));
    const vec3 wi = directionAbove(ng, randomTriple(3, i));
    const vec3 wo = directionAbove(ng, randomTriple(4, i));
    const vec3 there = evalBsdf(m.bsdf, wi, wo, ng, ns), back = evalBsdf(m.bsdf, wo, wi, ng, ns);
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(there[k], back[k], 2e-4f * std::max(1.0f, there[k])) << m.name;
    ASSERT_EQ(evalBsdf(m.bsdf, wi, -wo, ng, ns), vec3(0.0f));
  }
}

/// Radiance grows as n^2 where it enters a denser side: f / n^2 of the side that it goes to is the same both
/// ways.
TEST(Bsdf, RoughRefractionIsReciprocal) {
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const vec3 a = randomTriple(5, i);
    const NamedBsdf m = bsdfOf({.roughness = 0.1f + 0.9f * a.x,
                                .ior = i % 3 == 0 ? 0.7f : 1.05f + a.y,
                                .transmission = a.z,
                                .baseColour = randomTriple(6, i),
                                .flags = i % 4 == 0 ? kMaterialThinWalled : 0u});
    const vec3 ng = sampleSphere(vec2(randomTriple(1, i).x, randomTriple(1, i).y));
    const vec3 ns = normalize(ng + 0.5f * sampleSphere(vec2(randomTriple(2, i).x, randomTriple(2, i).y)));
    const vec3 inside = -directionAbove(ng, randomTriple(3, i));
    const vec3 outside = directionAbove(ng, randomTriple(4, i));
    const vec3 out = evalBsdf(m.bsdf, inside, outside, ng, ns, 1.0f);
    const vec3 in = evalBsdf(m.bsdf, outside, inside, -ng, -ns, 0.0f) * radianceScale(m.bsdf, 1.0f);
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(out[k], in[k], 2e-3f * std::max(0.1f, out[k])) << m.name;
  }
}

/// As roughness falls, as much goes through as through smooth glass, and to the same direction.
TEST(Bsdf, NearlySmoothRefractionTendsToSnells) {
  for (const uint flags : {0u, kMaterialThinWalled})
    for (const float entering : {1.0f, 0.0f}) {
      const vec3 wo = directionAt(0.9f, 0.6f);
      const Bsdf nearly = bsdfOf({.roughness = 0.06f, .transmission = 1, .flags = flags}).bsdf;
      const Bsdf smooth = bsdfOf({.roughness = 0, .transmission = 1, .flags = flags}).bsdf;
      EXPECT_NEAR(albedo(nearly, wo, entering), 1.0, 0.005);
      float scale = 0;
      const vec3 straight = refractionOf(smooth, wo, kUp, kUp, entering, scale);
      vec3 sum(0.0f);
      double through = 0;
      constexpr std::uint32_t kSamples = 20'000;
      for (std::uint32_t i = 0; i < kSamples; ++i) {
        const BsdfSample s = sampleBsdf(nearly, wo, kUp, kUp, entering, randomTriple(7, i));
        if (s.lobe != kLobeRoughRefract) continue;
        EXPECT_EQ(s.etaScale, scale);
        sum += s.wi * s.weight.x;
        through += double(s.weight.x) / kSamples;
      }
      EXPECT_GT(dot(normalize(sum), straight), 0.9999f);
      // Schlick's F stands for Fresnel's.
      EXPECT_NEAR(through, double(refractedPart(smooth, wo.z, entering).x), 0.02);
    }
}

TEST(Bsdf, NoMaterialGainsEnergy) {
  for (const NamedBsdf& m : whiteMaterials())
    for (const float cosine : {1.0f, 0.85f, 0.65f, 0.5f, 0.2f, 0.07f, 0.005f})
      for (const float entering : {1.0f, 0.0f}) {
        if (entering == 0.0f && m.bsdf.through == 0.0f) continue;  // Alike from both sides.
        const vec3 wo = directionAt(cosine, 0.1f);
        ASSERT_LE(albedo(m.bsdf, wo, entering), 1.0 + 1e-4)
            << m.name << " at cosine " << cosine << " entering " << entering;
      }
}

TEST(Bsdf, SmoothWhiteDielectricsLoseNothing) {
  for (const float ior : {1.0f, 1.3f, 1.5f, 2.4f})
    for (const float specular : {0.0f, 0.5f, 1.0f})
      for (const float transmission : {0.0f, 0.25f, 1.0f})
        for (const float cosine : {1.0f, 0.7f, 0.3f, 0.1f, 0.01f}) {
          const NamedBsdf m =
              bsdfOf({.roughness = 0, .specular = specular, .ior = ior, .transmission = transmission});
          EXPECT_NEAR(albedo(m.bsdf, directionAt(cosine, 0.3f), 1.0f), 1.0, 2e-5)
              << m.name << " at cosine " << cosine;
        }
}

TEST(Bsdf, NearlySmoothReflectionTendsToTheMirror) {
  for (const float metallic : {0.0f, 1.0f})
    for (const float cosine : {0.9f, 0.5f, 0.2f}) {
      const vec3 wo = directionAt(cosine, 0.6f);
      const Bsdf mirror = bsdfOf({.roughness = 0, .metallic = metallic}).bsdf;
      const Bsdf nearly = bsdfOf({.roughness = 0.08f, .metallic = metallic}).bsdf;
      // A rough dielectric gives up what Schlick's F may exceed itself by.
      EXPECT_NEAR(albedo(nearly, wo, 1.0f), albedo(mirror, wo, 1.0f), kRoughFresnelExcess) << cosine;
    }
}

TEST(Bsdf, LambertIsTheBaseColourOverPi) {
  const Bsdf b = bsdfOf({.specular = 0, .baseColour = vec3(0.2f, 0.5f, 0.8f)}).bsdf;
  const vec3 f = evalBsdf(b, directionAt(0.3f, 0.2f), directionAt(0.7f, 0.9f), kUp, kUp);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(f[k], vec3(0.2f, 0.5f, 0.8f)[k] * kInvPi, 1e-7f);
}

/// GGX worked out by hand: alpha 0.25, wi = wo = the normal: D / 4 = 1 / (4 pi alpha^2).
TEST(Bsdf, MetalAtNormalIncidenceIsTheDistributionsPeak) {
  const Bsdf b = bsdfOf({.roughness = 0.5f, .metallic = 1, .baseColour = vec3(0.6f)}).bsdf;
  EXPECT_NEAR(evalBsdf(b, kUp, kUp, kUp, kUp).x, 0.6f / (4.0f * kPi * 0.0625f), 1e-5f);
}

TEST(Bsdf, FacetsAddUpToTheProjectedArea) {
  for (const float alpha : {0.05f, 0.3f, 1.0f})
    EXPECT_NEAR(
        integrateOver(kHemisphereDomain, [&](vec3 h) { return double(ggxDistribution(alpha, h.z) * h.z); }),
        1.0, 1e-4)
        << alpha;
}

TEST(Bsdf, TintIsKeptPerChannel) {
  const Bsdf b = bsdfOf({.roughness = 0.5f, .metallic = 1, .baseColour = vec3(1.0f, 0.5f, 0.0f)}).bsdf;
  const vec3 f = evalBsdf(b, directionAt(0.8f, 0.0f), directionAt(0.8f, 0.5f), kUp, kUp);
  const float grazing = pow5(1.0f - 0.8f);
  EXPECT_NEAR(f.y / f.x, 0.5f + 0.5f * grazing, 1e-5f);
  EXPECT_NEAR(f.z / f.x, grazing, 1e-5f);
}

TEST(Bsdf, LobesAreNamedRight) {
  EXPECT_EQ(hasNonDeltaLobe(bsdfOf({.roughness = 0, .metallic = 1}).bsdf), 0.0f);
  EXPECT_EQ(hasDeltaLobe(bsdfOf({.roughness = 0, .metallic = 1}).bsdf), 1.0f);
  EXPECT_EQ(hasNonDeltaLobe(bsdfOf({.roughness = 0, .transmission = 1}).bsdf), 0.0f);
  EXPECT_EQ(hasNonDeltaLobe(bsdfOf({.roughness = 0}).bsdf), 1.0f);
  EXPECT_EQ(hasDeltaLobe(bsdfOf({.roughness = 0, .specular = 0}).bsdf), 0.0f);
  EXPECT_EQ(hasDeltaLobe(bsdfOf({.roughness = 0.5f}).bsdf), 0.0f);
  EXPECT_EQ(hasNonDeltaLobe(bsdfOf({.metallic = 1}).bsdf), 1.0f);
}

/// Grazing angles, the sharpest lobe, opposite directions: numbers stay numbers.
TEST(Bsdf, ExtremesStayFinite) {
  const float cosines[] = {1.0f, 0.5f, 1e-3f, 1e-6f, 1e-12f, 0.0f};
  for (const float roughness : {0.0301f, 0.05f, 1.0f})
    for (const float metallic : {0.0f, 1.0f}) {
      const NamedBsdf m = bsdfOf({.roughness = roughness, .metallic = metallic});
      for (const float ci : cosines)
        for (const float co : cosines)
          for (const float turns : {0.0f, 0.25f, 0.5f})
            for (const float tilt : {0.0f, 1.5f}) {
              const vec3 wi = directionAt(ci, 0.0f), wo = directionAt(co, turns);
              const vec3 ns = normalize(kUp + vec3(tilt, 0.0f, 0.0f));
              const vec3 f = evalBsdf(m.bsdf, wi, wo, kUp, ns);
              const float pdf = pdfBsdf(m.bsdf, wi, wo, kUp, ns, 1.0f);
              ASSERT_TRUE(std::isfinite(f.x) && f.x >= 0.0f) << m.name << ' ' << ci << ' ' << co;
              ASSERT_TRUE(std::isfinite(pdf) && pdf >= 0.0f) << m.name << ' ' << ci << ' ' << co;
            }
    }
}

}  // namespace
}  // namespace isophote

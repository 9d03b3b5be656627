// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/bsdf.shared.h"
#include "physics/test_materials.h"

#include <cmath>

namespace isophote {
namespace {

/// Normals and the direction that light comes from.
struct Setting {
  const char* name;
  vec3 ng;
  vec3 ns;
  vec3 wo;
};

/// The sphere of directions is laid around ng = +z.
const Setting kSettings[] = {
    {"normal", kUp, kUp, directionAt(0.999f, 0.1f)},
    {"oblique", kUp, kUp, directionAt(0.6f, 0.7f)},
    {"grazing", kUp, kUp, directionAt(0.05f, 0.4f)},
    {"bent shading normal", kUp, directionAt(0.8f, 0.3f), directionAt(0.5f, 0.1f)},
    {"light below the shading normal's plane", kUp, directionAt(0.7f, 0.0f), directionAt(0.2f, 0.5f)},
};

std::vector<NamedBsdf> sampledMaterials() {
  std::vector<NamedBsdf> list;
  for (const float roughness : {0.1f, 0.3f, 0.6f, 1.0f}) {
    list.push_back(bsdfOf({.roughness = roughness, .metallic = 1, .baseColour = vec3(0.9f, 0.5f, 0.2f)}));
    list.push_back(bsdfOf({.roughness = roughness, .baseColour = vec3(0.3f)}));
  }
  list.push_back(bsdfOf({.specular = 0}));
  list.push_back(bsdfOf({.roughness = 0, .baseColour = vec3(0.5f)}));
  list.push_back(bsdfOf({.roughness = 0.4f, .transmission = 0.5f}));
  return list;
}

/// The value for flux instead of radiance.
vec3 fluxValue(const Bsdf& b, vec3 wi, vec3 wo, vec3 ng, vec3 ns, float entering) {
  const bool through = dot(wi, ng) * dot(wo, ng) < 0.0f;
  return evalBsdf(b, wi, wo, ng, ns, entering) / (through ? radianceScale(b, entering) : 1.0f);
}

bool isDelta(const BsdfSample& s) { return s.lobe == kLobeMirror || s.lobe == kLobeRefract; }

TEST(BsdfSampling, DirectionsFollowTheDensity) {
  const std::vector<NamedBsdf> materials = sampledMaterials();
  const int tests = int(materials.size() * std::size(kSettings));
  std::uint32_t stream = 1000;
  for (const NamedBsdf& m : materials)
    for (const Setting& at : kSettings) {
      ++stream;
      const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
        const BsdfSample s = sampleBsdf(m.bsdf, at.wo, at.ng, at.ns, 1.0f, randomTriple(stream, i));
        if (s.pdf == 0.0f) return std::nullopt;
        return s.wi;
      };
      const auto pdf = [&](vec3 wi) { return double(pdfBsdf(m.bsdf, wi, at.wo, at.ng, at.ns, 1.0f)); };
      EXPECT_TRUE(
          samplesFollow(kSphereDomain, sample, pdf, {.samples = testSamples(100'000), .tests = tests}))
          << m.name << ", " << at.name;
    }
}

TEST(BsdfSampling, WeightIsTheValueOverTheDensity) {
  for (std::uint32_t i = 0; i < 50'000; ++i) {
    const NamedBsdf m = randomMaterial(i % 200);
    const vec3 ng = directionAbove(kUp, randomTriple(10, i));
    const vec3 ns = normalize(ng + (i % 2 == 0 ? 0.0f : 0.6f) * directionAbove(kUp, randomTriple(11, i)));
    const vec3 wo = directionAbove(ng, randomTriple(12, i));
    const BsdfSample s = sampleBsdf(m.bsdf, wo, ng, ns, 1.0f, randomTriple(13, i));
    if (isDelta(s) || s.lobe == kLobeNone) continue;
    ASSERT_NEAR(length(s.wi), 1.0f, 1e-5f);
    ASSERT_EQ(s.pdf, pdfBsdf(m.bsdf, s.wi, wo, ng, ns, 1.0f));
    const bool through = s.lobe == kLobeRoughRefract;
    ASSERT_EQ(dot(s.wi, ng) < 0.0f, through);
    ASSERT_EQ(s.etaScale, through ? 1.0f / (m.bsdf.ior * m.bsdf.ior) : 1.0f);
    ASSERT_EQ(s.weight,
              evalBsdf(m.bsdf, s.wi, wo, ng, ns, 1.0f) * (std::abs(dot(s.wi, ns)) / (s.pdf * s.etaScale)));
  }
}

/// The mean weight is what quadrature over the directions finds.
TEST(BsdfSampling, MeanWeightIsTheAlbedo) {
  const std::vector<NamedBsdf> materials = sampledMaterials();
  const int tests = int(materials.size() * std::size(kSettings));
  std::uint32_t stream = 2000;
  for (const NamedBsdf& m : materials)
    for (const Setting& at : kSettings) {
      ++stream;
      if (m.bsdf.alpha > 0.0f && m.bsdf.alpha < 0.05f)
        continue;  // Too sharp for a quadrature over the sphere.
      Moments mean;
      for (std::uint32_t i = 0; i < testSamples(50'000); ++i) {
        const BsdfSample s = sampleBsdf(m.bsdf, at.wo, at.ng, at.ns, 1.0f, randomTriple(stream, i));
        mean.add(isDelta(s) ? 0.0 : double(meanOf(s.weight)));
      }
      const double albedo = integrateOver(kSphereDomain, [&](vec3 wi) {
        return double(meanOf(fluxValue(m.bsdf, wi, at.wo, at.ng, at.ns, 1.0f)) * std::abs(dot(wi, at.ns)));
      });
      EXPECT_TRUE(hasMean(mean, albedo, tests, 1e-3)) << m.name << ", " << at.name;
    }
}

/// However the shading normal is bent and wherever the light comes from, no energy is gained, and a white
/// Lambertian surface loses none.
TEST(BsdfSampling, BentNormalsConserveEnergy) {
  const Bsdf lambert = bsdfOf({.specular = 0}).bsdf;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const vec3 ns = normalize(kUp + 0.95f * directionAbove(kUp, randomTriple(20, i)));
    const vec3 wo = directionAbove(kUp, randomTriple(21, i));
    const BsdfSample s = sampleBsdf(lambert, wo, kUp, ns, 1.0f, randomTriple(22, i));
    ASSERT_EQ(s.lobe, kLobeDiffuse);
    ASSERT_GT(s.wi.z, 0.0f);
    ASSERT_NEAR(s.weight.x, 1.0f, 1e-5f);
  }
}

TEST(BsdfSampling, DeltasAreChosenAsOftenAsTheyReflect) {
  const NamedBsdf materials[] = {bsdfOf({.roughness = 0, .baseColour = vec3(0.5f)}),
                                 bsdfOf({.roughness = 0, .metallic = 1}),
                                 bsdfOf({.roughness = 0, .transmission = 1}),
                                 bsdfOf({.roughness = 0, .transmission = 0.5f, .baseColour = vec3(0.7f)}),
                                 bsdfOf({.roughness = 0.5f, .ior = 1.0f, .transmission = 0.7f})};
  std::uint32_t stream = 3000;
  for (const NamedBsdf& m : materials)
    for (const float cosine : {0.9f, 0.3f})
      for (const float entering : {1.0f, 0.0f}) {
        ++stream;
        const vec3 wo = directionAt(cosine, 0.2f);
        const vec4 p = lobeProbabilities(m.bsdf, wo.z, entering);
        EXPECT_NEAR(p.x + p.y + p.z + p.w, 1.0f, 1e-6f);
        const std::uint32_t n = testSamples(50'000);
        std::vector<double> observed(5, 0.0);
        vec3 mirrored(0.0f), refracted(0.0f);
        for (std::uint32_t i = 0; i < n; ++i) {
          const BsdfSample s = sampleBsdf(m.bsdf, wo, kUp, kUp, entering, randomTriple(stream, i));
          // A glossy direction below the surface is absorbed: it was chosen all the same.
          ++observed[s.lobe == kLobeNone ? std::size_t(kLobeGlossy) : s.lobe];
          if (s.lobe == kLobeMirror) mirrored = s.weight * p.z;
          if (s.lobe == kLobeRefract) refracted = s.weight * p.w;
        }
        EXPECT_TRUE(countsMatch(observed, {0.0, p.x * n, p.y * n, p.z * n, p.w * n}, 20)) << m.name;
        // Not chosen is not reflected: a probability of 0 leaves 0.
        const float reflected = m.bsdf.alpha > 0.0f ? 0.0f : mirrorReflectance(m.bsdf, wo.z, entering).x;
        EXPECT_NEAR(mirrored.x, reflected, 1e-5f) << m.name;
        EXPECT_NEAR(refracted.x, refractedPart(m.bsdf, wo.z, entering).x, 1e-5f) << m.name;
      }
}

/// Rough glass of every kind, met from outside and from inside: directions follow their density, and the mean
/// weight is what quadrature finds.
TEST(BsdfSampling, RoughRefractionFollowsItsDensity) {
  const NamedBsdf materials[] = {
      bsdfOf({.roughness = 0.5f, .transmission = 1}),
      bsdfOf({.roughness = 0.7f, .ior = 2.4f, .transmission = 1, .baseColour = vec3(0.9f, 0.5f, 0.2f)}),
      bsdfOf({.roughness = 0.5f, .metallic = 0.3f, .ior = 0.7f, .transmission = 0.6f}),
      bsdfOf({.roughness = 0.6f, .specular = 0, .transmission = 1}),
      bsdfOf({.roughness = 0.5f, .transmission = 1, .flags = kMaterialThinWalled}),
      bsdfOf({.roughness = 0.4f, .ior = 1.0f, .transmission = 0.8f, .flags = kMaterialThinWalled})};
  constexpr int kTests = int(std::size(materials) * std::size(kSettings) * 4);
  std::uint32_t stream = 4000;
  for (const NamedBsdf& m : materials)
    for (const Setting& at : kSettings)
      for (const float entering : {1.0f, 0.0f}) {
        ++stream;
        Moments mean;
        const std::uint32_t n = testSamples(60'000);
        for (std::uint32_t i = 0; i < n; ++i) {
          const BsdfSample s = sampleBsdf(m.bsdf, at.wo, at.ng, at.ns, entering, randomTriple(stream, i));
          mean.add(double(meanOf(s.weight)));
          ASSERT_TRUE(s.rest >= 0.0f && s.rest <= 1.0f);
        }
        const auto sample = [&](std::uint32_t i) -> std::optional<vec3> {
          const BsdfSample s = sampleBsdf(m.bsdf, at.wo, at.ng, at.ns, entering, randomTriple(stream, i));
          return s.pdf > 0.0f ? std::optional(s.wi) : std::nullopt;
        };
        const auto pdf = [&](vec3 wi) { return double(pdfBsdf(m.bsdf, wi, at.wo, at.ng, at.ns, entering)); };
        EXPECT_TRUE(samplesFollow(kSphereDomain, sample, pdf, {.samples = n, .tests = kTests}))
            << m.name << ", " << at.name << ", entering " << entering;
        const double albedo = integrateOver(kSphereDomain, [&](vec3 wi) {
          return double(meanOf(fluxValue(m.bsdf, wi, at.wo, at.ng, at.ns, entering)) *
                        std::abs(dot(wi, at.ns)));
        });
        EXPECT_TRUE(hasMean(mean, albedo, kTests, 2e-3))
            << m.name << ", " << at.name << ", entering " << entering;
        EXPECT_LT(albedo, 1.001) << m.name << ", " << at.name << ", entering " << entering;
      }
}

TEST(BsdfSampling, ExtremesStayFinite) {
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const vec3 a = randomTriple(30, i);
    const NamedBsdf m = bsdfOf({.roughness = i % 2 == 0 ? 0.0301f : a.x,
                                .metallic = i % 3 == 0 ? 1.0f : 0.0f,
                                .ior = 1.0f + float(i % 5),
                                .transmission = i % 7 == 0 ? 1.0f : 0.0f});
    const vec3 wo = directionAt(pow(10.0f, -8.0f * a.y), a.z);
    const vec3 ns = i % 2 == 0 ? kUp : normalize(kUp + 0.99f * directionAbove(kUp, randomTriple(31, i)));
    vec3 u = randomTriple(32, i);
    if (i % 11 == 0) u.y = 0.0f;
    if (i % 13 == 0) u.z = 0.99999994f;
    const BsdfSample s = sampleBsdf(m.bsdf, wo, kUp, ns, i % 5 == 0 ? 0.0f : 1.0f, u);
    ASSERT_TRUE(std::isfinite(s.wi.x) && std::isfinite(s.pdf) && std::isfinite(s.weight.x)) << m.name;
    ASSERT_NEAR(length(s.wi), 1.0f, 1e-4f) << m.name;
    ASSERT_GE(s.pdf, 0.0f);
    ASSERT_GE(s.weight.x, 0.0f);
    // A single sample carries no more than a few times the light that came.
    ASSERT_LE(maxOf(s.weight), 4.0f) << m.name << " lobe " << s.lobe;
  }
}

}  // namespace
}  // namespace isophote

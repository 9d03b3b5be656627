// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Smooth dielectrics: how much they reflect and refract, and where to.
#include "physics/bsdf.shared.h"
#include "physics/test_materials.h"

#include <cmath>

namespace isophote {
namespace {

const float kCosines[] = {1.0f, 0.9f, 0.75f, 0.5f, 0.3f, 0.1f, 0.02f};

/// Fresnel's equations from the angles themselves, in double.
double fresnelByAngles(double cosIncident, double eta) {
  const double incident = std::acos(cosIncident), sine = std::sin(incident) / eta;
  if (sine >= 1) return 1;
  const double other = std::asin(sine);
  if (incident < 1e-6) return std::pow((eta - 1) / (eta + 1), 2);
  const double s = std::sin(incident - other) / std::sin(incident + other);
  const double p = std::tan(incident - other) / std::tan(incident + other);
  return 0.5 * (s * s + p * p);
}

TEST(Dielectric, ReflectanceIsFresnels) {
  for (const float eta : {1.0f / 2.4f, 1.0f / 1.5f, 1.001f, 1.33f, 1.5f, 2.4f})
    for (const float cosine : kCosines)
      EXPECT_NEAR(fresnelDielectric(cosine, eta), fresnelByAngles(double(cosine), double(eta)), 2e-5)
          << eta << ' ' << cosine;
  EXPECT_FLOAT_EQ(fresnelDielectric(1.0f, 1.5f), 0.04f);
}

TEST(Dielectric, ReflectsAsMuchFromEitherSideOfOneRay) {
  for (const float cosine : kCosines) {
    const float cosineInside = std::sqrt(1.0f - (1.0f - cosine * cosine) / 2.25f);
    EXPECT_NEAR(fresnelDielectric(cosine, 1.5f), fresnelDielectric(cosineInside, 1.0f / 1.5f), 1e-5f);
  }
}

TEST(Dielectric, WhatIsNotReflectedRefracts) {
  for (const uint flags : {0u, kMaterialThinWalled})
    for (const float entering : {1.0f, 0.0f})
      for (const float cosine : kCosines) {
        const Bsdf b = bsdfOf({.roughness = 0, .transmission = 1, .flags = flags}).bsdf;
        const float reflected = mirrorReflectance(b, cosine, entering).x;
        EXPECT_NEAR(reflected + refractedPart(b, cosine, entering).x, 1.0f, 1e-6f);
        const float face = fresnelDielectric(cosine, flags != 0u || entering > 0.5f ? 1.5f : 1.0f / 1.5f);
        const float expected = flags != 0u ? 2.0f * face / (1.0f + face) : face;
        EXPECT_NEAR(reflected, expected, 1e-6f);
        EXPECT_EQ(evalBsdf(b, kUp, directionAt(cosine, 0.1f), kUp, kUp), vec3(0.0f));
      }
}

TEST(Dielectric, RaysBendBySnellsLaw) {
  const Bsdf b = bsdfOf({.roughness = 0, .ior = 1.5f, .transmission = 1}).bsdf;
  for (const float cosine : kCosines)
    for (const float entering : {1.0f, 0.0f}) {
      const float eta = entering > 0.5f ? 1.5f : 1.0f / 1.5f;
      const vec3 wo = directionAt(cosine, 0.15f);
      const float sineOther = std::sqrt(1.0f - cosine * cosine) / eta;
      if (sineOther >= 1.0f) continue;
      float etaScale = 0.0f;
      const vec3 wi = refractionOf(b, wo, kUp, kUp, entering, etaScale);
      EXPECT_NEAR(length(wi), 1.0f, 1e-6f);
      EXPECT_NEAR(std::hypot(wi.x, wi.y), sineOther, 2e-6f);
      EXPECT_LT(wi.z, 0.0f);
      // In one plane with wo and the normal, on the other side of it.
      EXPECT_NEAR(wi.x * wo.y - wi.y * wo.x, 0.0f, 1e-6f);
      EXPECT_LE(wi.x * wo.x + wi.y * wo.y, 0.0f);
      EXPECT_NEAR(etaScale, 1.0f / (eta * eta), 1e-6f);
    }
}

TEST(Dielectric, TheWayBackIsTheWayThere) {
  const Bsdf b = bsdfOf({.roughness = 0, .ior = 1.5f, .transmission = 1}).bsdf;
  for (const float cosine : kCosines) {
    const vec3 outside = directionAt(cosine, 0.4f);
    float scaleIn = 0, scaleOut = 0;
    const vec3 inside = refractionOf(b, outside, kUp, kUp, 1.0f, scaleIn);
    const vec3 back = refractionOf(b, inside, -kUp, -kUp, 0.0f, scaleOut);
    EXPECT_NEAR(dot(back, outside), 1.0f, 1e-6f);
    EXPECT_NEAR(scaleIn * scaleOut, 1.0f, 1e-6f);
    // n^2 dw |cos| is the same on both sides (next test), so f / n^2 is reciprocal where as much refracts.
    EXPECT_NEAR(refractedPart(b, outside.z, 1.0f).x, refractedPart(b, -inside.z, 0.0f).x, 1e-5f);
  }
}

/// Conservation of etendue: n^2 dw cos is the same on both sides, which is what etaScale stands for.
TEST(Dielectric, EtaScaleIsTheRatioOfConcentration) {
  const Bsdf b = bsdfOf({.roughness = 0, .ior = 1.5f, .transmission = 1}).bsdf;
  const auto refracted = [&](float theta, float phi) {
    float scale = 0;
    return refractionOf(
        b, vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)), kUp, kUp,
        1.0f, scale);
  };
  for (const float theta : {0.3f, 0.8f, 1.2f}) {
    constexpr float kStep = 1e-2f;
    const vec3 alongTheta = refracted(theta + kStep, 0.0f) - refracted(theta - kStep, 0.0f);
    const vec3 alongPhi = refracted(theta, kStep) - refracted(theta, -kStep);
    const double inside = double(length(cross(alongTheta, alongPhi)));
    const double outside = 4.0 * double(kStep) * double(kStep) * std::sin(double(theta));
    float scale = 0;
    const vec3 wi = refractionOf(b, directionAt(std::cos(theta), 0.0f), kUp, kUp, 1.0f, scale);
    EXPECT_NEAR(inside * double(-wi.z) / (outside * std::cos(double(theta))), double(scale), 1e-3);
  }
}

TEST(Dielectric, BeyondTheCriticalAngleAllIsReflected) {
  const Bsdf b = bsdfOf({.roughness = 0, .ior = 1.5f, .transmission = 1}).bsdf;
  const float critical = std::sqrt(1.0f - 1.0f / 2.25f);
  for (const float cosine : {critical * 0.999f, 0.5f, 0.1f, 1e-4f}) {
    EXPECT_EQ(mirrorReflectance(b, cosine, 0.0f).x, 1.0f) << cosine;
    EXPECT_EQ(refractedPart(b, cosine, 0.0f).x, 0.0f) << cosine;
    for (std::uint32_t i = 0; i < 1000; ++i)
      ASSERT_EQ(sampleBsdf(b, directionAt(cosine, 0.2f), kUp, kUp, 0.0f, randomTriple(1, i)).lobe,
                kLobeMirror);
  }
  EXPECT_LT(mirrorReflectance(b, critical * 1.01f, 0.0f).x, 0.8f);
}

TEST(Dielectric, PanesPassLightStraightOn) {
  const Bsdf b = bsdfOf({.roughness = 0, .ior = 1.7f, .transmission = 1, .flags = kMaterialThinWalled}).bsdf;
  for (const float cosine : kCosines)
    for (const float entering : {1.0f, 0.0f}) {
      float etaScale = 0;
      const vec3 wo = directionAt(cosine, 0.8f);
      EXPECT_EQ(refractionOf(b, wo, kUp, kUp, entering, etaScale), -wo);
      EXPECT_EQ(etaScale, 1.0f);
    }
}

TEST(Dielectric, MirrorsObeyTheLawOfReflection) {
  const vec3 ns = directionAt(0.9f, 0.3f);
  const vec3 wo = directionAt(0.7f, 0.2f);
  const vec3 r = mirrorDirection(wo, kUp, ns);
  EXPECT_NEAR(dot(r, ns), dot(wo, ns), 1e-6f);
  EXPECT_NEAR(dot(cross(r, wo), ns), 0.0f, 1e-6f);
  // About the geometric normal where it would end below the surface.
  const vec3 low = mirrorDirection(directionAt(0.05f, 0.5f), kUp, directionAt(0.7f, 0.0f));
  EXPECT_NEAR(low.z, 0.05f, 1e-6f);
}

/// Refraction through a bent shading normal ends on the other side of the surface, whatever the angles.
TEST(Dielectric, RefractionCrossesTheSurface) {
  const Bsdf b = bsdfOf({.roughness = 0, .ior = 1.5f, .transmission = 1}).bsdf;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const vec3 wo = directionAbove(kUp, randomTriple(2, i));
    const vec3 ns = normalize(kUp + 0.8f * directionAbove(kUp, randomTriple(3, i)));
    const float entering = i % 2 == 0 ? 1.0f : 0.0f;
    const BsdfSample s = sampleBsdf(b, wo, kUp, ns, entering, randomTriple(4, i));
    ASSERT_TRUE(s.lobe == kLobeRefract ? s.wi.z <= 1e-6f : s.wi.z >= 0.0f) << s.lobe;
  }
}

}  // namespace
}  // namespace isophote

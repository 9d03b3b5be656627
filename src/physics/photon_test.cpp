// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/photon.shared.h"
#include "physics/shading_normal.shared.h"

#include "physics/test_materials.h"

#include <cmath>

namespace isophote {
namespace {

Photon photonAt(vec3 position, vec3 normal) {
  return {position, 1.0f, vec3(1.0f, 2.0f, 4.0f), packDirection(normal), packDirection(normal), 1};
}

TEST(PhotonKernel, IntegratesToOneOverTheTangentPlaneWhateverItsHeight) {
  for (const uint kernel : {kKernelConstant, kKernelEpanechnikov})
    for (const float radius : {0.01f, 0.5f, 3.0f})
      for (const float flatness : {0.01f, 0.3f, 1.0f}) {
        const vec3 normal(0.0f, 0.0f, -1.0f);  // Packed exactly.
        const vec3 centre(4.0f, 5.0f, 6.0f);
        const PhotonVolume v = photonVolume(photonAt(centre, normal), kernel, radius, flatness);
        const double integral = integrateOver(kDiscDomain, [&](vec3 p) {
          const float t2 = ellipsoidDistance2(v, centre + radius * p);
          return double(v.weightedPower.y * kernelValue(kernel, t2) * radius * radius);
        });
        EXPECT_NEAR(integral, 2.0, 2e-3) << kernel << ' ' << radius << ' ' << flatness;
      }
}

TEST(PhotonKernel, IsAnEllipsoid) {
  const PhotonVolume v = photonVolume(photonAt(vec3(0.0f), kUp), kKernelEpanechnikov, 2.0f, 0.25f);
  EXPECT_NEAR(ellipsoidDistance2(v, vec3(2.0f, 0.0f, 0.0f)), 1.0f, 1e-4f);
  EXPECT_NEAR(ellipsoidDistance2(v, vec3(0.0f, 0.0f, -0.5f)), 1.0f, 1e-4f);
  EXPECT_NEAR(ellipsoidDistance2(v, vec3(0.0f, 1.2f, 0.4f)), 0.36f + 0.64f, 1e-3f);
  EXPECT_EQ(kernelValue(kKernelEpanechnikov, 0.25f), 0.75f);
  EXPECT_EQ(kernelValue(kKernelEpanechnikov, 1.0f), 0.0f);
  EXPECT_EQ(kernelValue(kKernelConstant, 0.99f), 1.0f);
  EXPECT_EQ(kernelValue(kKernelConstant, 1.01f), 0.0f);
}

TEST(PhotonRadius, GrowsAsPathsThinOutBetweenItsLimits) {
  EXPECT_NEAR(photonRadius(0.25f, 0.1f, 1.0f, 0.01f, 10.0f), 0.2f, 1e-6f);
  EXPECT_EQ(photonRadius(1e-9f, 0.1f, 1.0f, 0.01f, 0.3f), 0.3f);
  EXPECT_EQ(photonRadius(0.0f, 0.1f, 1.0f, 0.01f, 0.3f), 0.3f);
  EXPECT_EQ(photonRadius(1e9f, 0.1f, 1.0f, 0.01f, 0.3f), 0.01f);
}

TEST(PathDensity, MultipliesTheEventsConstantWithItsAlbedo) {
  EXPECT_FLOAT_EQ(pathDensityFactor(kLobeDiffuse, 0.5f), 5e-4f);
  EXPECT_FLOAT_EQ(pathDensityFactor(kLobeGlossy, 0.5f), 5e-2f);
  EXPECT_FLOAT_EQ(pathDensityFactor(kLobeMirror, 0.5f), 0.5f);
  EXPECT_FLOAT_EQ(pathDensityFactor(kLobeRefract, 1.0f), 1.0f);
}

TEST(PhotonSurvival, KeepsTheMeanPower) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const vec3 power = randomTriple(1, i) * 7.0f;
    const vec3 weight = randomTriple(2, i);
    const float survival = photonSurvival(power, weight);
    ASSERT_GT(survival, 0.0f);
    ASSERT_LE(survival, 1.0f);
    ASSERT_NEAR(meanOf(power * weight / survival), meanOf(power), 1e-4f);
  }
  EXPECT_EQ(photonSurvival(vec3(0.0f), vec3(1.0f)), 0.0f);
  EXPECT_EQ(photonSurvival(vec3(1.0f), vec3(3.0f)), 1.0f);
}

/// Light that goes from wi to wo carries the same measure whichever end it is sampled from: from the eye's
/// side f |wi.ns| dwi over a beam of |wo.ng|, from the light's f |wo.ns| dwo, with the factor, over one of
/// |wi.ng|; both fade alike at grazing angles.
TEST(ShadingNormals, PhotonsAndEyePathsScatterAlike) {
  int compared = 0, faded = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const Bsdf b = randomMaterial(i % 100).bsdf;
    const vec3 ns = normalize(kUp + 0.5f * directionAbove(kUp, randomTriple(3, i)));
    // Every other direction grazes the surface.
    const float lift = i % 2 == 0 ? 1.0f : 0.02f;
    const vec3 wi = normalize(directionAbove(kUp, randomTriple(4, i)) * vec3(1.0f, 1.0f, lift));
    const vec3 wo = directionAbove(kUp, randomTriple(5, i));
    const float factor = photonShadingFactor(wi, wo, kUp, ns);
    const float fades = eyeShadingFactor(wi, wo, kUp, ns);
    ASSERT_GE(factor, 0.0f);
    ASSERT_LE(factor, kMaxCosineRatio * kMaxCosineRatio);
    ASSERT_LE(fades, 1.0f);
    if (std::abs(wi.z * dot(wo, ns)) < 1e-4f) continue;
    ++compared;
    faded += fades < 1.0f;
    const float fromEye = evalBsdf(b, wi, wo, kUp, ns).x * std::abs(dot(wi, ns)) * std::abs(wo.z) * fades;
    const float fromLight = evalBsdf(b, wo, wi, kUp, ns).x * std::abs(dot(wo, ns)) * factor * std::abs(wi.z);
    ASSERT_NEAR(fromLight, fromEye, 1e-3f * std::max(1.0f, fromEye));
  }
  EXPECT_GT(compared, 15'000);
  EXPECT_GT(faded, 1'000);
}

TEST(ShadingNormals, StoredPhotonsSwapTheirCosine) {
  const vec3 ns = directionAt(0.8f, 0.0f);
  const vec3 wi = directionAt(0.6f, 0.5f);
  EXPECT_NEAR(photonEstimateFactor(wi, kUp, ns), std::abs(dot(wi, ns)) / 0.6f, 1e-6f);
  EXPECT_NEAR(photonEstimateFactor(wi, kUp, kUp), 1.0f, 1e-6f);
  EXPECT_EQ(photonEstimateFactor(-wi, kUp, ns), 0.0f);
  EXPECT_EQ(photonEstimateFactor(directionAt(1e-3f, 0.0f), kUp, directionAt(0.5f, 0.0f)), kMaxCosineRatio);
  EXPECT_EQ(photonShadingFactor(kUp, wi, kUp, kUp), 1.0f);
}

}  // namespace
}  // namespace isophote

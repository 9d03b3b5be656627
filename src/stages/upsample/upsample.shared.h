// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// How far light estimated at one view sample may stand for the light at another (ISPM 5.2), and what of it
// does: reflected light with the surface's own reflectance taken out.
#ifndef ISOPHOTE_STAGES_UPSAMPLE_SHARED_H
#define ISOPHOTE_STAGES_UPSAMPLE_SHARED_H

#include "physics/bsdf.shared.h"

SHARED_BEGIN

SHARED_CONST uint kUpsampleNearest = 0u;   ///< The sample of the pixel's own cell.
SHARED_CONST uint kUpsampleBilinear = 1u;  ///< The four around the pixel, by their distance on the screen.
SHARED_CONST uint kUpsampleNormal = 2u;    ///< And by how alike the shading normals are.
SHARED_CONST uint kUpsampleDepth = 3u;     ///< And by the distance from the pixel's tangent plane.

/// Distance from the tangent plane at which a sample counts no more, in widths of a cell where the pixel is.
SHARED_CONST float kUpsampleDepthReach = 0.5f;
/// Samples that count less than this by their surface are those of another one.
SHARED_CONST float kUpsampleLeast = 0.05f;
/// What a sample that lies a whole cell away counts on the screen: something, in case the nearer ones lie on
/// other surfaces.
SHARED_CONST float kUpsampleFarthest = 0.01f;

/// Weight along one axis of the screen at a distance [pixels]: falls by `slope` a pixel, to nothing beyond
/// `reach`.
SHARED_FN float upsampleScreenWeight(float distance, float reach, float slope) {
  float weight = max(1.0f - abs(distance) * slope, kUpsampleFarthest);
  return abs(distance) <= reach ? weight : 0.0f;
}

/// Weight by the surfaces: those of the pixel (geometric and shading normal) and of the sample.
/// cellsPerMetre: 1 / width of a cell where the pixel is. The distance from the tangent plane stands for that
/// in depth, because it is none on a surface seen at a glancing angle, however steep.
SHARED_FN float upsampleSurfaceWeight(uint weights, vec3 position, vec3 ng, vec3 ns, float cellsPerMetre,
                                      vec3 samplePosition, vec3 sampleNs) {
  float alike = max(dot(ns, sampleNs), 0.0f);
  float alike2 = alike * alike;
  float alike4 = alike2 * alike2;
  float alike8 = alike4 * alike4;
  float alike16 = alike8 * alike8;
  float byNormal = weights >= kUpsampleNormal ? 1.0f : 0.0f;
  float byDepth = weights >= kUpsampleDepth ? 1.0f : 0.0f;
  float off = dot(samplePosition - position, ng) * cellsPerMetre * (1.0f / kUpsampleDepthReach);
  float normal = 1.0f + byNormal * (alike16 * alike16 - 1.0f);
  float weight = normal * max(1.0f - byDepth * off * off, 0.0f);
  return weight >= kUpsampleLeast ? weight : 0.0f;
}

/// What Lambertian light is divided by, up to pi, besides the albedo: what the reflection above it takes of
/// the light towards wo, and the mean of what it takes of that from everywhere. 1 without a reflection.
SHARED_FN float upsampleCoupling(Bsdf b, float cosO) {
  float meanFresnel = b.coupling0 + (b.coupling90 - b.coupling0) * (1.0f / 21.0f);
  return max(couplingFactor(b, cosO) * (1.0f - meanFresnel), 1e-3f);
}

/// The surface whose radiance is the light that upsampling interpolates: irradiance, each direction weighted
/// by what the reflection leaves of it over the mean of that.
SHARED_FN Bsdf upsampleDiffuse(Bsdf b, float cosO) {
  Bsdf white = b;
  white.diffuse = vec3(kPi / upsampleCoupling(b, cosO));
  white.alpha = 0.0f;
  white.f0 = vec3(0.0f);
  white.f90 = 0.0f;
  white.transmission = vec3(0.0f);
  white.through = 0.0f;
  return white;
}

/// Reflectance that is divided out of the glossy reflection: that of a mirror in its place.
SHARED_FN vec3 upsampleGlossy(Bsdf b, float cosO) {
  return vec3(max(schlick(b.f0.x, b.f90, cosO), 1e-3f), max(schlick(b.f0.y, b.f90, cosO), 1e-3f),
              max(schlick(b.f0.z, b.f90, cosO), 1e-3f));
}

/// Weight of a sample's glossy reflection by the roughness of the two.
SHARED_FN float upsampleRoughnessWeight(float alpha, float sampleAlpha) {
  float off = abs(alpha - sampleAlpha) * 4.0f / max(alpha + sampleAlpha, 1e-6f);
  return max(1.0f - off, 0.0f);
}

SHARED_END

#endif

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#ifndef ISOPHOTE_PHYSICS_PHOTON_SHARED_H
#define ISOPHOTE_PHYSICS_PHOTON_SHARED_H

#include "math/sampling.shared.h"
#include "math/shared.h"
#include "physics/bsdf.shared.h"

SHARED_BEGIN

/// One stored photon hit (ISPM table 1). 40 bytes.
struct Photon {
  vec3 position;      ///< World space [m].
  float pathDensity;  ///< rho: product of the path's event constants and albedos (pathDensityFactor); shapes
                      ///< the kernel.
  vec3 power;         ///< Flux carried, before the surface here scatters it [W].
  uint direction;     ///< packDirection: unit, towards where it came from.
  uint normal;        ///< packDirection: geometric normal of the surface hit, on the side of arrival.
  uint bounce;        ///< Scattering events before this hit; at least 1 (a first hit is direct light and not
                      ///< stored).
};

/// ISPM 4.3: constants that stand for the density of each kind of scattering event.
SHARED_FN float pathDensityFactor(uint lobe, float albedo) {
  float rough = lobe == kLobeGlossy || lobe == kLobeRoughRefract ? 1e-1f : 1.0f;
  return albedo * (lobe == kLobeDiffuse ? 1e-3f : rough);
}

/// Roulette: probability with which a photon of that power survives an event that would multiply it by
/// `weight`, one for all channels, whose power is then divided by it. In proportion to the power that is
/// left, so that the mean of RGB stays the same along a path; 1 at most.
SHARED_FN float photonSurvival(vec3 power, vec3 weight) {
  return min(meanOf(power * weight) / max(meanOf(power), 1e-37f), 1.0f);
}

/// The ellipsoid in which one photon is felt, unpacked for the inner loop. Disc of radius r in the photon's
/// tangent plane, height h = r * flatness along its normal. 64 bytes.
struct PhotonVolume {
  vec3 position;
  float inverseRadius2;  ///< 1 / r^2 [1/m^2]
  vec3 normal;           ///< Geometric normal of the surface hit.
  float normalTerm;      ///< 1 / h^2 - 1 / r^2 [1/m^2]
  vec3 direction;        ///< Towards where the photon came from.
  float radius;          ///< r [m]
  vec3 weightedPower;    ///< Power times the kernel's normalisation [W/m^2].
  float reserved;
};

SHARED_CONST uint kKernelConstant = 0u;      ///< 1 inside.
SHARED_CONST uint kKernelEpanechnikov = 1u;  ///< 1 - t^2.

/// Normalisation of a kernel over its disc of radius r: its integral over the tangent plane becomes 1
/// [1/m^2].
SHARED_FN float kernelNormalisation(uint kernel, float radius) {
  return (kernel == kKernelEpanechnikov ? 2.0f : 1.0f) * kInvPi / (radius * radius);
}

/// Kernel before its normalisation at squared distance t2, in units of the ellipsoid: 0 outside.
SHARED_FN float kernelValue(uint kernel, float t2) {
  float inside = kernel == kKernelEpanechnikov ? 1.0f - t2 : 1.0f;
  return t2 < 1.0f ? inside : 0.0f;
}

/// Squared distance from the photon in units of its ellipsoid: t^2 = |d|^2 / r^2 + (d.n)^2 (1 / h^2 - 1 /
/// r^2). The true ellipsoid instead of ISPM's eq. 2, which has a crease along the normal.
SHARED_FN float ellipsoidDistance2(PhotonVolume p, vec3 position) {
  vec3 d = position - p.position;
  float along = dot(d, p.normal);
  return dot(d, d) * p.inverseRadius2 + along * along * p.normalTerm;
}

/// Radius of the kernel in the tangent plane [m] from the photon's path density (ISPM 4.3 gives no formula):
/// r0 * sqrt(densityReference / rho), between rMin and rMax.
SHARED_FN float photonRadius(float pathDensity, float radius, float densityReference, float radiusMin,
                             float radiusMax) {
  return clamp(radius * sqrt(densityReference / max(pathDensity, 1e-30f)), radiusMin, radiusMax);
}

/// flatness = height / radius in (0, 1].
SHARED_FN PhotonVolume photonVolume(Photon p, uint kernel, float radius, float flatness) {
  PhotonVolume v;
  v.position = p.position;
  v.radius = radius;
  v.inverseRadius2 = 1.0f / (radius * radius);
  v.normalTerm = (1.0f / (flatness * flatness) - 1.0f) * v.inverseRadius2;
  v.normal = unpackDirection(p.normal);
  v.direction = unpackDirection(p.direction);
  v.weightedPower = p.power * kernelNormalisation(kernel, radius);
  v.reserved = 0.0f;
  return v;
}

SHARED_END

#endif

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Photon differentials: how far the nearest neighbours of a photon are apart from it, in place and direction,
// followed along its path (Igehy 1999 for rays; IGPM for photons). Two steps to neighbours are enough for all
// paths, because diffuse surfaces start them anew. Each is scaled by the expected spacing of photons, so that
// where a photon arrives the two steps of position are the axes of its footprint.
#ifndef ISOPHOTE_PHYSICS_PHOTON_DIFFERENTIAL_SHARED_H
#define ISOPHOTE_PHYSICS_PHOTON_DIFFERENTIAL_SHARED_H

#include "math/sampling.shared.h"
#include "math/shared.h"

SHARED_BEGIN

/// Steps from a photon to two neighbours. 48 bytes.
struct PhotonDifferential {
  vec3 positionX;  ///< World space [m].
  vec3 positionY;
  vec3 directionX;  ///< Of the unit direction of travel, perpendicular to it.
  vec3 directionY;
};

/// Footprint of a stored photon: the ellipse of all points position + a axisX + b axisY with a^2 + b^2 <= 1,
/// in the plane of the surface. Before compression and smoothing. 32 bytes.
struct PhotonFootprint {
  vec3 axisX;      ///< World space [m].
  float spacing;   ///< sqrt(4 pi / n) of the n photons of its light.
  vec3 axisY;      ///< Need be neither perpendicular to axisX nor as long.
  uint scattered;  ///< 1 where a diffuse surface has scattered the photon, 0 where it came by mirrors,
                   ///< refraction and glossy surfaces alone.
};

/// Cosines of arrival below this count as this: footprints at grazing angles stay finite.
SHARED_CONST float kLeastFootprintCosine = 0.01f;

/// Expected step between the directions of n photons that share a solid angle.
SHARED_FN float photonSpacing(float solidAngle, float photons) {
  return sqrt(solidAngle / max(photons, 1.0f));
}

/// A photon that leaves along `direction`, with those steps between directions and, perpendicular to it,
/// between positions [m]. Going back by the second over the first, all neighbours meet in one point: that is
/// the virtual origin.
SHARED_FN PhotonDifferential leavingDifferential(vec3 direction, float directionStep, float positionStep) {
  mat3 frame = basisAround(direction);
  PhotonDifferential d;
  d.positionX = frame[0] * positionStep;
  d.positionY = frame[1] * positionStep;
  d.directionX = frame[0] * directionStep;
  d.directionY = frame[1] * directionStep;
  return d;
}

/// Step of position on the surface with that normal, which a neighbour's ray meets a little before or after.
SHARED_FN vec3 stepOnSurface(vec3 step, vec3 direction, vec3 normal) {
  float cosine = dot(direction, normal);
  float bounded = cosine < 0.0f ? min(cosine, -kLeastFootprintCosine) : max(cosine, kLeastFootprintCosine);
  return step - direction * (dot(step, normal) / bounded);
}

/// After a way [m] through space, on the surface that it ends on; ng is its geometric normal.
SHARED_FN PhotonDifferential arrivingDifferential(PhotonDifferential d, vec3 direction, float way, vec3 ng) {
  d.positionX = stepOnSurface(d.positionX + d.directionX * way, direction, ng);
  d.positionY = stepOnSurface(d.positionY + d.directionY * way, direction, ng);
  return d;
}

/// Roulette left the part `survival` of the photons (here also the choice between lobes is roulette): each
/// stands for an area larger by its inverse.
SHARED_FN PhotonDifferential sparserDifferential(PhotonDifferential d, float survival) {
  float factor = inversesqrt(max(survival, 1e-12f));
  d.positionX = d.positionX * factor;
  d.positionY = d.positionY * factor;
  d.directionX = d.directionX * factor;
  d.directionY = d.directionY * factor;
  return d;
}

/// Step of the interpolated unit normal n = m / |m|, m = n0 (1 - u - v) + n1 u + n2 v, for a step of position
/// in the plane of a triangle with these edges from its first vertex.
SHARED_FN vec3 normalStep(vec3 edge1, vec3 edge2, vec3 n0, vec3 n1, vec3 n2, float u, float v, vec3 step) {
  vec3 across = cross(edge1, edge2);
  float inverse = 1.0f / max(dot(across, across), 1e-37f);
  float du = dot(cross(step, edge2), across) * inverse;
  float dv = dot(cross(edge1, step), across) * inverse;
  vec3 m = n0 * (1.0f - u - v) + n1 * u + n2 * v;
  vec3 dm = (n1 - n0) * du + (n2 - n0) * dv;
  float inverseLength = inversesqrt(max(dot(m, m), 1e-12f));
  vec3 n = m * inverseLength;
  return (dm - n * dot(n, dm)) * inverseLength;
}

/// Step of the direction that a mirror makes of `direction`, for steps of that and of the normal n.
SHARED_FN vec3 mirroredStep(vec3 direction, vec3 directionStep, vec3 n, vec3 nStep) {
  float turned = dot(directionStep, n) + dot(direction, nStep);
  return directionStep - 2.0f * (dot(direction, n) * nStep + turned * n);
}

/// The same of refraction into `refracted`; eta = n of the side of refraction / n of the side of arrival.
SHARED_FN vec3 refractedStep(vec3 direction, vec3 directionStep, vec3 refracted, vec3 n, vec3 nStep,
                             float eta) {
  float inverse = 1.0f / eta;
  float before = dot(direction, n);
  float after = dot(refracted, n);
  float bounded = after < 0.0f ? min(after, -1e-3f) : max(after, 1e-3f);
  float turned = dot(directionStep, n) + dot(direction, nStep);
  float mu = inverse * before - after;
  float muStep = (inverse - inverse * inverse * before / bounded) * turned;
  return directionStep * inverse - (nStep * mu + n * muStep);
}

/// A surface scatters the photon along `direction` by chance, with that spacing of its photons' directions:
/// it starts anew from a virtual origin behind the surface, from where its footprint has the area that it had
/// on arrival.
SHARED_FN PhotonDifferential scatteredDifferential(PhotonDifferential arrived, vec3 direction,
                                                   float spacing) {
  vec3 across = cross(arrived.positionX, arrived.positionY);
  return leavingDifferential(direction, spacing, sqrt(sqrt(dot(across, across))));
}

/// Spacing of directions that n photons take with that density per solid angle, at most that of n photons in
/// all directions.
SHARED_FN float lobeSpacing(float pdf, float photons) {
  return min(inversesqrt(max(pdf * photons, 1e-30f)), photonSpacing(4.0f * kPi, photons));
}

SHARED_FN PhotonFootprint photonFootprint(PhotonDifferential arrived, float spacing, uint scattered) {
  PhotonFootprint f;
  f.axisX = arrived.positionX;
  f.spacing = spacing;
  f.axisY = arrived.positionY;
  f.scattered = scattered;
  return f;
}

SHARED_END

#endif

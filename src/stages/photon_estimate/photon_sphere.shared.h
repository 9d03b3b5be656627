// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#ifndef ISOPHOTE_STAGES_PHOTON_ESTIMATE_PHOTON_SPHERE_SHARED_H
#define ISOPHOTE_STAGES_PHOTON_ESTIMATE_PHOTON_SPHERE_SHARED_H

#include "physics/photon.shared.h"

SHARED_BEGIN

/// The sphere in which one photon of a fixed radius is felt, unpacked for the inner loop. 48 bytes.
struct PhotonSphere {
  vec3 position;
  float inverseRadius2;  ///< 1 / r^2 [1/m^2]
  vec3 direction;        ///< Towards where the photon came from.
  float radius;          ///< r [m]
  vec3 weightedPower;    ///< Power times the constant kernel, 1 / (pi r^2) [W/m^2].
  float reserved;
};

/// Squared distance from the photon in units of its radius.
SHARED_FN float sphereDistance2(PhotonSphere p, vec3 position) {
  vec3 d = position - p.position;
  return dot(d, d) * p.inverseRadius2;
}

SHARED_FN PhotonSphere photonSphere(Photon p, float radius) {
  PhotonSphere s;
  s.position = p.position;
  s.inverseRadius2 = 1.0f / (radius * radius);
  s.direction = unpackDirection(p.direction);
  s.radius = radius;
  s.weightedPower = p.power * kernelNormalisation(kKernelConstant, radius);
  s.reserved = 0.0f;
  return s;
}

SHARED_END

#endif

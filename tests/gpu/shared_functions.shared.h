// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// A little of everything that the shared headers offer, computed by both engines and compared.
#ifndef ISOPHOTE_TESTS_SHARED_FUNCTIONS_SHARED_H
#define ISOPHOTE_TESTS_SHARED_FUNCTIONS_SHARED_H

#include "math/rng.shared.h"
#include "math/sampling.shared.h"
#include "math/sobol.shared.h"
#include "physics/bsdf.shared.h"
#include "physics/camera.shared.h"
#include "physics/emission.shared.h"
#include "physics/material.shared.h"
#include "physics/photon.shared.h"

SHARED_BEGIN

SHARED_CONST uint kBindMaterials = 0u;
SHARED_CONST uint kBindPhotons = 1u;
SHARED_CONST uint kBindResults = 2u;
SHARED_CONST uint kSpecKernel = 7u;

struct SharedFunctionsPush {
  CameraRays camera;
  uint seed;
  uint count;
};

struct SharedFunctionsResult {
  uint key;
  uint sobol;
  uint packed;
  uint lobe;
  vec3 hemisphere;
  float pdf;
  vec3 unpacked;
  float kernel;
  vec3 bsdf;
  float lightPdf;
  vec3 cameraDirection;
  float spread;  ///< Cosine between the sampled direction and the normal.
};

SHARED_FN SharedFunctionsResult sharedFunctions(Material material, Photon photon, CameraRays camera,
                                                uint seed, uint index, uint kernel) {
  SharedFunctionsResult r;
  r.key = pathKey(seed, 1u, 2u, index);
  r.sobol = owenScramble(sobolBits(index, index % kSobolDimensions), seed);
  vec3 u = random3(r.key, 0u, 0u);
  vec3 v = random3(r.key, 1u, 0u);
  r.hemisphere = sampleCosineHemisphere(vec2(u.x, u.y));
  r.packed = packDirection(normalize(2.0f * v - vec3(1.0f)));
  r.unpacked = unpackDirection(photon.direction);

  vec3 normal = unpackDirection(photon.normal);
  vec3 wo = basisAround(normal) * r.hemisphere;
  Bsdf bsdf = bsdfFromMaterial(material, material.baseColour, material.metallic, material.roughness,
                               material.transmission);
  BsdfSample scattered = sampleBsdf(bsdf, wo, normal, normal, 1.0f, v);
  r.lobe = scattered.lobe;
  r.spread = dot(scattered.wi, normal);
  r.bsdf = evalBsdf(bsdf, r.unpacked, wo, normal, normal);
  r.pdf = pdfBsdf(bsdf, r.unpacked, wo, normal, normal, 1.0f);

  PhotonVolume volume = photonVolume(photon, kernel, 0.5f, 0.4f);
  r.kernel = kernelValue(kernel, ellipsoidDistance2(volume, photon.position + 0.4f * r.hemisphere));
  r.lightPdf = areaSamplePdf(r.hemisphere, -normal, 2.0f);
  r.cameraDirection = cameraRayDirection(camera, vec2(2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f));
  return r;
}

SHARED_END

#endif

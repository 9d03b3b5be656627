// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

#include "physics/shading_normal.shared.h"
#include "stages/photon_volumes/photon_volumes.shared.h"

// A workgroup is a tile, an invocation one of its view samples: it adds the photons of the tile's list, in their
// order, to the radiance that is there. The CPU's loops (estimate_body.h) do the same.
layout(local_size_x = kTileLanes) in;
layout(push_constant, scalar) uniform Push { PhotonVolumesPush push; };
layout(binding = kBindViewTiles, scalar) readonly buffer ViewTiles { ViewTile viewTiles[]; };
layout(binding = kBindVolumes, scalar) readonly buffer Volumes { PhotonVolume volumes[]; };
layout(binding = kBindListBegin, scalar) readonly buffer ListBegin { uint listBegin[]; };
layout(binding = kBindList, scalar) readonly buffer List { uint list[]; };
layout(binding = kBindRadiance, scalar) buffer Radiance { RadianceTile radiance[]; };
layout(binding = kBindContributing, scalar) buffer Contributing { uint contributing[]; };

shared uint tileContributing;

void main() {
  const uint tile = gl_WorkGroupID.x;
  const uint lane = gl_LocalInvocationID.x;
  if (lane == 0u) tileContributing = 0u;
  barrier();

  const vec3 position = vec3(viewTiles[tile].positionX[lane], viewTiles[tile].positionY[lane],
                             viewTiles[tile].positionZ[lane]);
  const vec3 ng = vec3(viewTiles[tile].ngX[lane], viewTiles[tile].ngY[lane], viewTiles[tile].ngZ[lane]);
  const vec3 ns = vec3(viewTiles[tile].nsX[lane], viewTiles[tile].nsY[lane], viewTiles[tile].nsZ[lane]);
  const vec3 wo = vec3(viewTiles[tile].woX[lane], viewTiles[tile].woY[lane], viewTiles[tile].woZ[lane]);
  Bsdf bsdf;
  bsdf.diffuse =
      vec3(viewTiles[tile].diffuseR[lane], viewTiles[tile].diffuseG[lane], viewTiles[tile].diffuseB[lane]);
  bsdf.alpha = viewTiles[tile].alpha[lane];
  bsdf.f0 = vec3(viewTiles[tile].f0R[lane], viewTiles[tile].f0G[lane], viewTiles[tile].f0B[lane]);
  bsdf.f90 = viewTiles[tile].f90[lane];
  bsdf.transmission = vec3(0.0f);
  bsdf.ior = 1.0f;
  bsdf.coupling0 = viewTiles[tile].coupling0[lane];
  bsdf.coupling90 = viewTiles[tile].coupling90[lane];
  bsdf.flags = 0u;
  bsdf.through = 0.0f;
  float entering = 1.0f;
  if (viewTiles[tile].transmits != 0u) {
    bsdf.transmission = vec3(viewTiles[tile].transmissionR[lane], viewTiles[tile].transmissionG[lane],
                             viewTiles[tile].transmissionB[lane]);
    bsdf.through = viewTiles[tile].through[lane];
    bsdf.ior = viewTiles[tile].ior[lane];
    bsdf.flags = (viewTiles[tile].sides[lane] & kSideThin) != 0u ? kMaterialThinWalled : 0u;
    entering = (viewTiles[tile].sides[lane] & kSideOutside) != 0u ? 1.0f : 0.0f;
  }
  const bool transmits = refractsRoughly(bsdf) > 0.5f;
  const bool lambertian = viewTiles[tile].lambertian != 0u;

  vec3 sum = vec3(radiance[tile].r[lane], radiance[tile].g[lane], radiance[tile].b[lane]);
  uint hits = 0u;
  for (uint i = listBegin[tile]; i < listBegin[tile + 1u]; ++i) {
    const PhotonVolume p = volumes[list[i]];
    const float weight = kernelValue(push.kernel, ellipsoidDistance2(p, position)) *
                         (transmits ? photonEstimateFactorBothSides(p.direction, ng, ns)
                                    : photonEstimateFactor(p.direction, ng, ns));
    if (weight > 0.0f) {
      const vec3 f = lambertian ? vec3(1.0f) : evalBsdf(bsdf, p.direction, wo, ng, ns, entering);
      sum += weight * f * p.weightedPower;
      ++hits;
    }
  }
  if (lambertian && push.lastPart != 0u) sum *= bsdf.diffuse * kInvPi;
  radiance[tile].r[lane] = sum.x;
  radiance[tile].g[lane] = sum.y;
  radiance[tile].b[lane] = sum.z;

  atomicAdd(tileContributing, hits);
  barrier();
  if (lane == 0u) contributing[tile] += tileContributing;
}

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The bodies of photon_volumes' hot loops: the photons of one list against the 64 view samples of one tile.
// For estimate.cpp, which compiles them for each instruction set, and for the benchmark's unvectorised twins.
#pragma once

#include "physics/photon.shared.h"
#include "stages/gbuffer/view_samples.h"

#include <cstdint>

namespace isophote::photon_volumes {

/// Lanes whose constants and sums stay in registers while photons pass by: one AVX-512 vector.
inline constexpr int kGroupLanes = 16;

/// Tiles that reflect diffusely only (ViewTile::lambertian): sums irradiance; lambertianRadiance ends the
/// work.
SHARED_FN void estimateLambertianBody(const ViewTile& tile, const PhotonVolume* volumes,
                                      const std::uint32_t* list, std::uint32_t count, uint kernel,
                                      RadianceTile& sums, std::uint64_t& contributing) {
  for (int first = 0; first < kTileLanes; first += kGroupLanes) {
    float r[kGroupLanes], g[kGroupLanes], b[kGroupLanes];
    std::uint32_t hits[kGroupLanes];
    for (int i = 0; i < kGroupLanes; ++i) {
      r[i] = sums.r[first + i];
      g[i] = sums.g[first + i];
      b[i] = sums.b[first + i];
      hits[i] = 0;
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      const PhotonVolume& p = volumes[list[k]];
      for (int i = 0; i < kGroupLanes; ++i) {
        const int lane = first + i;
        const vec3 position = positionOf(tile, lane);
        const vec3 ng = ngOf(tile, lane);
        const vec3 ns = nsOf(tile, lane);
        const float weight =
            kernelValue(kernel, ellipsoidDistance2(p, position)) * photonEstimateFactor(p.direction, ng, ns);
        r[i] += weight * p.weightedPower.x;
        g[i] += weight * p.weightedPower.y;
        b[i] += weight * p.weightedPower.z;
        hits[i] += weight > 0.0f ? 1u : 0u;
      }
    }
    for (int i = 0; i < kGroupLanes; ++i) {
      sums.r[first + i] = r[i];
      sums.g[first + i] = g[i];
      sums.b[first + i] = b[i];
      contributing += hits[i];
    }
  }
}

/// Any tile: sums radiance, the full BSDF evaluated at every pair of a group that the photon reaches.
SHARED_FN void estimateGlossyBody(const ViewTile& tile, const PhotonVolume* volumes,
                                  const std::uint32_t* list, std::uint32_t count, uint kernel,
                                  RadianceTile& sums, std::uint64_t& contributing) {
  for (int first = 0; first < kTileLanes; first += kGroupLanes) {
    float r[kGroupLanes], g[kGroupLanes], b[kGroupLanes], weight[kGroupLanes];
    for (int i = 0; i < kGroupLanes; ++i) {
      r[i] = sums.r[first + i];
      g[i] = sums.g[first + i];
      b[i] = sums.b[first + i];
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      const PhotonVolume& p = volumes[list[k]];
      std::uint32_t hits = 0;
      for (int i = 0; i < kGroupLanes; ++i) {
        const int lane = first + i;
        const vec3 position = positionOf(tile, lane);
        const vec3 ng = ngOf(tile, lane);
        const vec3 ns = nsOf(tile, lane);
        weight[i] =
            kernelValue(kernel, ellipsoidDistance2(p, position)) * photonEstimateFactor(p.direction, ng, ns);
        hits += weight[i] > 0.0f ? 1u : 0u;
      }
      if (hits == 0) continue;
      contributing += hits;
      for (int i = 0; i < kGroupLanes; ++i) {
        const int lane = first + i;
        const Bsdf bsdf = reflectionOf(tile, lane);
        const vec3 wo = woOf(tile, lane);
        const vec3 ng = ngOf(tile, lane);
        const vec3 ns = nsOf(tile, lane);
        const vec3 f = evalBsdf(bsdf, p.direction, wo, ng, ns);
        r[i] += weight[i] * f.x * p.weightedPower.x;
        g[i] += weight[i] * f.y * p.weightedPower.y;
        b[i] += weight[i] * f.z * p.weightedPower.z;
      }
    }
    for (int i = 0; i < kGroupLanes; ++i) {
      sums.r[first + i] = r[i];
      sums.g[first + i] = g[i];
      sums.b[first + i] = b[i];
    }
  }
}

/// Tiles through which light goes (ViewTile::transmits): as estimateGlossyBody, and photons that arrived on
/// the other side of a sample that transmits count too.
SHARED_FN void estimateTransmittingBody(const ViewTile& tile, const PhotonVolume* volumes,
                                        const std::uint32_t* list, std::uint32_t count, uint kernel,
                                        RadianceTile& sums, std::uint64_t& contributing) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    if (tile.pixel[lane] == kNoPixel) continue;
    const ViewSample s = laneOf(tile, lane);
    const bool transmits = refractsRoughly(s.bsdf) > 0.5f;
    vec3 sum(sums.r[lane], sums.g[lane], sums.b[lane]);
    for (std::uint32_t k = 0; k < count; ++k) {
      const PhotonVolume& p = volumes[list[k]];
      const float felt = kernelValue(kernel, ellipsoidDistance2(p, s.position));
      if (felt <= 0.0f) continue;
      const float factor = transmits ? photonEstimateFactorBothSides(p.direction, s.ng, s.ns)
                                     : photonEstimateFactor(p.direction, s.ng, s.ns);
      if (factor <= 0.0f) continue;
      ++contributing;
      sum += evalBsdf(s.bsdf, p.direction, s.wo, s.ng, s.ns, s.entering) * p.weightedPower * (felt * factor);
    }
    sums.r[lane] = sum.x;
    sums.g[lane] = sum.y;
    sums.b[lane] = sum.z;
  }
}

}  // namespace isophote::photon_volumes

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The hot loops of every estimator that goes from photons to view samples: the photons of one list against
// the view samples of one tile. Where a photon is felt is their template parameter. For the file that
// compiles them for each instruction set (photon_volumes/estimate.cpp, sphere_loops.cpp), and for the
// benchmark's unvectorised twins.
#pragma once

#include "physics/photon.shared.h"
#include "physics/shading_normal.shared.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_estimate/photon_ellipsoid.shared.h"
#include "stages/photon_estimate/photon_sphere.shared.h"

#include <bit>
#include <cstdint>

namespace isophote::photon_estimate {

/// Lanes whose constants and sums stay in registers while photons pass by: one AVX-512 vector.
inline constexpr int kGroupLanes = 16;

/// Pairs of a photon and a view sample.
struct PairCounts {
  std::uint64_t felt = 0;          ///< Where the sample lies in the photon's footprint; where kCountsFelt.
  std::uint64_t contributing = 0;  ///< Of them, where the photon adds light.
};

/// A footprint says with which weight a photon is felt at a lane of a tile.
struct WithinEllipsoid {
  using Photon = PhotonVolume;
  static constexpr bool kCountsFelt = false;
  static SHARED_FN float felt(const PhotonVolume& p, uint kernel, const ViewTile& tile, int lane) {
    return kernelValue(kernel, ellipsoidDistance2(p, positionOf(tile, lane)));
  }
};

/// The ellipsoid of a photon differential.
struct WithinFootprint {
  using Photon = PhotonEllipsoid;
  static constexpr bool kCountsFelt = false;
  static SHARED_FN float felt(const PhotonEllipsoid& p, uint kernel, const ViewTile& tile, int lane) {
    return kernelValue(kernel, ellipsoidDistance2(p, positionOf(tile, lane)));
  }
};

struct WithinSphere {
  using Photon = PhotonSphere;
  static SHARED_FN bool holds(const PhotonSphere& p, vec3 position) {
    return sphereDistance2(p, position) < 1.0f;
  }
  static constexpr bool kCountsFelt = true;
  static SHARED_FN float felt(const PhotonSphere& p, uint, const ViewTile& tile, int lane) {
    return kernelValue(kKernelConstant, sphereDistance2(p, positionOf(tile, lane)));
  }
};

/// All the tile's samples are known to lie within the sphere.
struct Everywhere {
  using Photon = PhotonSphere;
  static SHARED_FN bool holds(const PhotonSphere&, vec3) { return true; }
  static constexpr bool kCountsFelt = false;
  static SHARED_FN float felt(const PhotonSphere&, uint, const ViewTile&, int) { return 1.0f; }
};

/// What of a photon's power counts at a lane that does not transmit.
SHARED_FN float factorAt(const ViewTile& tile, int lane, vec3 wi) {
  return photonEstimateFactor(wi, ngOf(tile, lane), nsOf(tile, lane));
}
/// 1 where a weight is positive, else 0. By arithmetic: where a comparison decides on the weight already, a
/// second one would have GCC branch instead of vectorising.
SHARED_FN std::uint32_t countOf(float weight) {
  return std::uint32_t(std::int32_t(min(weight * 1e30f, 1.0f)));
}

/// Tiles that reflect diffusely only (ViewTile::lambertian): sums irradiance; lambertianRadiance ends the
/// work. Of the lanes from `begin` on up to `lanes`, multiples of kGroupLanes.
template <class Footprint>
SHARED_FN void estimateLambertianBody(const ViewTile& tile, const typename Footprint::Photon* photons,
                                      const std::uint32_t* list, std::uint32_t count, uint kernel, int lanes,
                                      RadianceTile& sums, PairCounts& counts, int begin = 0) {
  for (int first = begin; first < lanes; first += kGroupLanes) {
    float r[kGroupLanes], g[kGroupLanes], b[kGroupLanes];
    std::uint32_t hits[kGroupLanes], within[kGroupLanes];
    for (int i = 0; i < kGroupLanes; ++i) {
      r[i] = sums.r[first + i];
      g[i] = sums.g[first + i];
      b[i] = sums.b[first + i];
      hits[i] = within[i] = 0;
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      const typename Footprint::Photon& p = photons[list[k]];
      for (int i = 0; i < kGroupLanes; ++i) {
        const int lane = first + i;
        const float felt = Footprint::felt(p, kernel, tile, lane);
        const float weight = felt * factorAt(tile, lane, p.direction);
        r[i] += weight * p.weightedPower.x;
        g[i] += weight * p.weightedPower.y;
        b[i] += weight * p.weightedPower.z;
        hits[i] += countOf(weight);
        if constexpr (Footprint::kCountsFelt) within[i] += countOf(felt);
      }
    }
    std::uint32_t allHits = 0, allWithin = 0;
    for (int i = 0; i < kGroupLanes; ++i) {
      sums.r[first + i] = r[i];
      sums.g[first + i] = g[i];
      sums.b[first + i] = b[i];
      allHits += hits[i];
      allWithin += within[i];
    }
    counts.contributing += allHits;
    counts.felt += allWithin;
  }
}

/// All bits where it holds, else none: loops that combine such masks vectorise where GCC branches otherwise.
SHARED_FN std::uint32_t maskOf(bool holds) { return 0u - std::uint32_t(holds); }
SHARED_FN float masked(float value, std::uint32_t mask) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & mask);
}

/// Likewise tiles whose shading normals are the geometric ones, so that a photon counts whole or not at all.
template <class Footprint>
SHARED_FN void estimateFlatBody(const ViewTile& tile, const typename Footprint::Photon* photons,
                                const std::uint32_t* list, std::uint32_t count, int lanes, RadianceTile& sums,
                                PairCounts& counts) {
  for (int first = 0; first < lanes; first += kGroupLanes) {
    float r[kGroupLanes], g[kGroupLanes], b[kGroupLanes];
    std::uint32_t hits[kGroupLanes], within[kGroupLanes];
    for (int i = 0; i < kGroupLanes; ++i) {
      r[i] = sums.r[first + i];
      g[i] = sums.g[first + i];
      b[i] = sums.b[first + i];
      hits[i] = within[i] = 0;
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      const typename Footprint::Photon& p = photons[list[k]];
      for (int i = 0; i < kGroupLanes; ++i) {
        const int lane = first + i;
        const std::uint32_t felt = maskOf(Footprint::holds(p, positionOf(tile, lane)));
        const std::uint32_t counted = felt & maskOf(dot(p.direction, ngOf(tile, lane)) > 0.0f);
        r[i] += masked(p.weightedPower.x, counted);
        g[i] += masked(p.weightedPower.y, counted);
        b[i] += masked(p.weightedPower.z, counted);
        hits[i] -= counted;
        if constexpr (Footprint::kCountsFelt) within[i] -= felt;
      }
    }
    std::uint32_t allHits = 0, allWithin = 0;
    for (int i = 0; i < kGroupLanes; ++i) {
      sums.r[first + i] = r[i];
      sums.g[first + i] = g[i];
      sums.b[first + i] = b[i];
      allHits += hits[i];
      allWithin += within[i];
    }
    counts.contributing += allHits;
    counts.felt += allWithin;
  }
}

/// Any tile: sums radiance, the full BSDF evaluated at every pair of a group that the photon reaches.
template <class Footprint>
SHARED_FN void estimateGlossyBody(const ViewTile& tile, const typename Footprint::Photon* photons,
                                  const std::uint32_t* list, std::uint32_t count, uint kernel, int lanes,
                                  RadianceTile& sums, PairCounts& counts, int begin = 0) {
  for (int first = begin; first < lanes; first += kGroupLanes) {
    float r[kGroupLanes], g[kGroupLanes], b[kGroupLanes], weight[kGroupLanes];
    for (int i = 0; i < kGroupLanes; ++i) {
      r[i] = sums.r[first + i];
      g[i] = sums.g[first + i];
      b[i] = sums.b[first + i];
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      const typename Footprint::Photon& p = photons[list[k]];
      std::uint32_t hits = 0, within = 0;
      for (int i = 0; i < kGroupLanes; ++i) {
        const int lane = first + i;
        const float felt = Footprint::felt(p, kernel, tile, lane);
        weight[i] = felt * factorAt(tile, lane, p.direction);
        hits += countOf(weight[i]);
        if constexpr (Footprint::kCountsFelt) within += countOf(felt);
      }
      counts.felt += within;
      if (hits == 0) continue;
      counts.contributing += hits;
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
template <class Footprint>
SHARED_FN void estimateTransmittingBody(const ViewTile& tile, const typename Footprint::Photon* photons,
                                        const std::uint32_t* list, std::uint32_t count, uint kernel,
                                        int lanes, RadianceTile& sums, PairCounts& counts, int begin = 0) {
  for (int lane = begin; lane < lanes; ++lane) {
    if (tile.pixel[lane] == kNoPixel) continue;
    const ViewSample s = laneOf(tile, lane);
    const bool transmits = refractsRoughly(s.bsdf) > 0.5f;
    vec3 sum(sums.r[lane], sums.g[lane], sums.b[lane]);
    for (std::uint32_t k = 0; k < count; ++k) {
      const typename Footprint::Photon& p = photons[list[k]];
      const float felt = Footprint::felt(p, kernel, tile, lane);
      if (felt <= 0.0f) continue;
      if constexpr (Footprint::kCountsFelt) ++counts.felt;
      const float factor = transmits ? photonEstimateFactorBothSides(p.direction, s.ng, s.ns)
                                     : photonEstimateFactor(p.direction, s.ng, s.ns);
      if (factor <= 0.0f) continue;
      ++counts.contributing;
      sum += evalBsdf(s.bsdf, p.direction, s.wo, s.ng, s.ns, s.entering) * p.weightedPower * (felt * factor);
    }
    sums.r[lane] = sum.x;
    sums.g[lane] = sum.y;
    sums.b[lane] = sum.z;
  }
}

/// Irradiance to radiance, for a Lambertian tile.
inline void lambertianRadiance(const ViewTile& tile, RadianceTile& sums) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    sums.r[lane] *= tile.diffuseR[lane] * kInvPi;
    sums.g[lane] *= tile.diffuseG[lane] * kInvPi;
    sums.b[lane] *= tile.diffuseB[lane] * kInvPi;
  }
}

}  // namespace isophote::photon_estimate

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/shading_normal.shared.h"
#include "stages/photon_kdtree/kdtree.h"
#include "stages/photon_kdtree/nearest_search.h"
#include "stages/photon_kdtree/photon_kdtree.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace isophote {

namespace {

/// The photon map in the tree's order: what queries read lies together.
struct OrderedPhotons {
  Kdtree tree;
  std::vector<vec3> direction;  ///< Unit, towards where the photon came from.
  std::vector<vec3> power;

  /// Without the tree's.
  std::size_t bytes() const { return (direction.capacity() + power.capacity()) * sizeof(vec3); }
};

void order(const PhotonMap& map, OrderedPhotons& out, const Job& job) {
  std::vector<vec3> positions(map.photons.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = map.photons[i].position;
  out.tree.build(positions, job);
  out.direction.resize(positions.size());
  out.power.resize(positions.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 4096), [&](const auto& range) {
    job.throwIfStopped();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Photon& photon = map.photons[out.tree.pointAt(std::uint32_t(i))];
      out.direction[i] = unpackDirection(photon.direction);
      out.power[i] = photon.power;
    }
  });
}

class Estimate {
 public:
  Estimate(const OrderedPhotons& photons, std::uint32_t nearest, float radius)
      : photons_(photons), search_(photons.tree), nearest_(nearest), radius_(radius) {}

  /// The next sample is not near the one before.
  void restart() { search_.restart(); }
  vec3 radiance(const ViewSample& s) { return nearest_ > 0 ? byNearest(s) : byRadius(s); }

 private:
  vec3 reflected(const ViewSample& s, std::span<const NeighbourKey> found) const {
    const bool transmits = refractsRoughly(s.bsdf) > 0.5f;
    vec3 sum(0.0f);
    for (const NeighbourKey key : found) {
      const vec3 wi = photons_.direction[placeOf(key)];
      const float factor =
          transmits ? photonEstimateFactorBothSides(wi, s.ng, s.ns) : photonEstimateFactor(wi, s.ng, s.ns);
      sum += evalBsdf(s.bsdf, wi, s.wo, s.ng, s.ns, s.entering) * photons_.power[placeOf(key)] * factor;
    }
    return sum;
  }

  vec3 byRadius(const ViewSample& s) {
    const float radius2 = radius_ * radius_;
    return reflected(s, search_.within(s.position, radius2)) * (kInvPi / radius2);
  }

  /// Finds one photon more than contribute: its distance bounds the disc. Taking the last contributing one's
  /// distance instead would overestimate by 1 / nearest on average.
  vec3 byNearest(const ViewSample& s) {
    const std::size_t wanted = std::size_t(nearest_) + 1;
    const bool transmits = refractsRoughly(s.bsdf) > 0.5f;
    // Photons of the back side neither contribute nor count, unless light goes through.
    const auto keep = [&](std::uint32_t at) { return transmits || dot(photons_.direction[at], s.ng) > 0.0f; };
    std::span<const NeighbourKey> found = search_.nearest(s.position, wanted, radius_ * radius_, keep);
    float radius2 = radius_ * radius_;
    if (found.size() == wanted) {
      radius2 = distance2Of(found.back());
      found = found.first(nearest_);
    }
    return radius2 > 0.0f ? reflected(s, found) * (kInvPi / radius2) : vec3(0.0f);
  }

  const OrderedPhotons& photons_;
  NearestSearch search_;
  std::uint32_t nearest_;
  float radius_;
};

}  // namespace

void PhotonKdtree::run(const In& in, Radiance& out, Stats& stats, const Job& job) const {
  out.assign(in.view.tiles.size(), {});
  if (in.map.photons.empty()) return;
  OrderedPhotons photons;
  {
    const auto scope = stats.scope("photon_kdtree.build");
    order(in.map, photons, job);
  }
  stats.peakBytes("photon_kdtree.photons", photons.bytes());
  stats.peakBytes("photon_kdtree.tree", photons.tree.bytes());
  const auto scope = stats.scope("photon_kdtree");
  tbb::enumerable_thread_specific<Estimate> estimates(photons, settings_.nearest, in.radius);
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t t) {
    if (job.stop.stop_requested()) return;
    const ViewTile& tile = in.view.tiles[t];
    Estimate& estimate = estimates.local();
    estimate.restart();
    for (int lane = 0; lane < kTileLanes; ++lane) {
      if (tile.pixel[lane] == kNoPixel) continue;
      const vec3 radiance = estimate.radiance(laneOf(tile, lane));
      out[t].r[lane] = radiance.x;
      out[t].g[lane] = radiance.y;
      out[t].b[lane] = radiance.z;
    }
  });
  job.throwIfStopped();
}

}  // namespace isophote

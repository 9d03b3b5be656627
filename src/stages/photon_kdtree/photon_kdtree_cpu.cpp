// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_kdtree/kdtree.h"
#include "stages/photon_kdtree/photon_kdtree.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace isophote {

namespace {

struct Neighbour {
  float distance2;
  std::uint32_t at;  ///< Place in the tree's order.
  bool operator<(const Neighbour& other) const {
    return distance2 != other.distance2 ? distance2 < other.distance2 : at < other.at;
  }
};

/// The photon map in the tree's order: what queries read lies together.
struct OrderedPhotons {
  Kdtree tree;
  std::vector<vec3> direction;  ///< Unit, towards where the photon came from.
  std::vector<vec3> power;
};

void order(const PhotonMap& map, OrderedPhotons& out) {
  std::vector<vec3> positions(map.photons.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = map.photons[i].position;
  out.tree.build(positions);
  out.direction.resize(positions.size());
  out.power.resize(positions.size());
  tbb::parallel_for(std::size_t(0), positions.size(), [&](std::size_t i) {
    const Photon& photon = map.photons[out.tree.pointAt(std::uint32_t(i))];
    out.direction[i] = unpackDirection(photon.direction);
    out.power[i] = photon.power;
  });
}

class Estimate {
 public:
  Estimate(const OrderedPhotons& photons, std::uint32_t nearest, float radius, std::vector<Neighbour>& heap)
      : photons_(photons), nearest_(nearest), radius_(radius), heap_(heap) {}

  vec3 radiance(const ViewSample& s) { return nearest_ > 0 ? byNearest(s) : byRadius(s); }

 private:
  vec3 reflected(const ViewSample& s, std::uint32_t at) const {
    const vec3 wi = photons_.direction[at];
    const float factor = refractsRoughly(s.bsdf) > 0.5f ? photonEstimateFactorBothSides(wi, s.ng, s.ns)
                                                        : photonEstimateFactor(wi, s.ng, s.ns);
    return evalBsdf(s.bsdf, wi, s.wo, s.ng, s.ns, s.entering) * photons_.power[at] * factor;
  }

  vec3 byRadius(const ViewSample& s) const {
    const float radius2 = radius_ * radius_;
    vec3 sum(0.0f);
    photons_.tree.visitWithin(s.position, radius2, [&](std::uint32_t at, float) {
      sum += reflected(s, at);
      return radius2;
    });
    return sum * (kInvPi / radius2);
  }

  /// Finds one photon more than contribute: its distance bounds the disc. Taking the last contributing one's
  /// distance instead would overestimate by 1 / nearest on average.
  vec3 byNearest(const ViewSample& s) {
    const std::size_t wanted = std::size_t(nearest_) + 1;
    heap_.clear();
    float radius2 = radius_ * radius_;
    const bool transmits = refractsRoughly(s.bsdf) > 0.5f;
    photons_.tree.visitWithin(s.position, radius2, [&](std::uint32_t at, float distance2) {
      // Photons of the back side neither contribute nor count, unless light goes through.
      if (!transmits && dot(photons_.direction[at], s.ng) <= 0.0f) return radius2;
      if (heap_.size() == wanted) {
        std::pop_heap(heap_.begin(), heap_.end());
        heap_.pop_back();
      }
      heap_.push_back({distance2, at});
      std::push_heap(heap_.begin(), heap_.end());
      if (heap_.size() == wanted) radius2 = heap_.front().distance2;
      return radius2;
    });
    std::sort_heap(heap_.begin(), heap_.end());
    const std::size_t contributing = std::min(heap_.size(), std::size_t(nearest_));
    vec3 sum(0.0f);
    for (std::size_t i = 0; i < contributing; ++i) sum += reflected(s, heap_[i].at);
    return radius2 > 0.0f ? sum * (kInvPi / radius2) : vec3(0.0f);
  }

  const OrderedPhotons& photons_;
  std::uint32_t nearest_;
  float radius_;
  std::vector<Neighbour>& heap_;
};

}  // namespace

void PhotonKdtree::run(const In& in, Radiance& out, Stats& stats, const Job& job) const {
  out.assign(in.view.tiles.size(), {});
  if (in.map.photons.empty()) return;
  OrderedPhotons photons;
  {
    const auto scope = stats.scope("photon_kdtree.build");
    order(in.map, photons);
  }
  const auto scope = stats.scope("photon_kdtree");
  tbb::enumerable_thread_specific<std::vector<Neighbour>> heaps;
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t t) {
    if (job.stop.stop_requested()) return;
    const ViewTile& tile = in.view.tiles[t];
    Estimate estimate(photons, settings_.nearest, in.radius, heaps.local());
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

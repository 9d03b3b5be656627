// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "stages/photon_bvh/hierarchy.h"
#include "stages/photon_bvh/photon_bvh.h"
#include "stages/photon_bvh/tile_estimate.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace isophote {

using namespace photon_bvh;

namespace {

struct Pairs {
  std::uint64_t tested = 0;
  std::uint64_t contributing = 0;
};

/// Of the photons that count at a point, if points and footprints lay evenly on all surfaces (IGPM 5.3): the
/// more there are, the larger are the leaves. Measured on a CPU, where a tile asks for 64 points at once.
constexpr double kLeafShare = 6.0;
constexpr double kLeastLeaf = 16, kMostLeaf = 512;

/// In mean radii: what lies farther apart than this has few photons in common.
constexpr float kReach = 0.75f;

std::uint32_t automaticLeaf(double footprintArea, double surfaceArea) {
  const double photons = kLeafShare * footprintArea / std::max(surfaceArea, 1e-30);
  return std::uint32_t(std::lround(std::clamp(photons, kLeastLeaf, kMostLeaf)));
}

}  // namespace

struct PhotonBvh::Scratch {
  KeyedSort sort;
  LargeVector<KeyedIndex> order;
  Ellipsoids ellipsoids;
  Hierarchy hierarchy;
  float reach = 0;           ///< TileEstimate::In::reach
  std::vector<Pairs> pairs;  ///< Of each tile.
  tbb::enumerable_thread_specific<TileEstimate> tiles;

  void build(const In& in, const PhotonBvhSettings& settings, Stats& stats, const Job& job);
  void tell(Stats& stats) const;
};

void PhotonBvh::Scratch::build(const In& in, const PhotonBvhSettings& settings, Stats& stats,
                               const Job& job) {
  const FootprintShape shape = shapeFor(in, settings);
  sortByMorton(in.map, sort, order, job);
  const double area = makeEllipsoids(in.map, shape, order, ellipsoids, job);
  reach = kReach * float(std::sqrt(area / (double(kPi) * double(order.size()))));
  const std::uint32_t leaf =
      settings.leafPhotons > 0 ? settings.leafPhotons : automaticLeaf(area, in.surfaceArea);
  if (settings.split == PhotonSplit::kMorton) {
    hierarchy.buildByMorton(order, ellipsoids, leaf, job);
  } else {
    LargeVector<KeyedIndex> places;
    hierarchy.buildByVolume(ellipsoids, leaf, places, job);
    for (KeyedIndex& place : places) place = order[place.index];
    makeEllipsoids(in.map, shape, places, ellipsoids, job);
  }
  stats.setCounter("photon_bvh.smoothing", double(shape.smoothing.scattered));
  stats.setCounter("photon_bvh.leafPhotons", double(leaf));
  stats.setCounter("photon_bvh.footprintsOverSurfaces", area / std::max(in.surfaceArea, 1e-30));
}

void PhotonBvh::Scratch::tell(Stats& stats) const {
  Pairs sum;
  for (const Pairs& p : pairs) {
    sum.tested += p.tested;
    sum.contributing += p.contributing;
  }
  stats.setCounter("photon_bvh.nodes", double(hierarchy.nodes().size()));
  stats.setCounter("photon_bvh.pairsTested", double(sum.tested));
  stats.setCounter("photon_bvh.pairsContributing", double(sum.contributing));
  stats.peakBytes("photon_bvh.photons", ellipsoids.bytes());
  stats.peakBytes("photon_bvh.hierarchy", hierarchy.bytes());
}

PhotonBvh::PhotonBvh(PhotonBvhSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
PhotonBvh::~PhotonBvh() = default;
PhotonBvh::PhotonBvh(PhotonBvh&&) noexcept = default;
PhotonBvh& PhotonBvh::operator=(PhotonBvh&&) noexcept = default;

void PhotonBvh::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  Scratch& s = *scratch_;
  out.resize(in.view.tiles.size());
  s.pairs.assign(out.size(), {});
  if (in.map.photons.empty()) {
    out.assign(out.size(), {});
    return;
  }
  if (!(in.radius > 0.0f) || !std::isfinite(in.radius))
    failUsage("photon_bvh.radius", "the radius is {} m; it must be a positive number", in.radius);
  if (in.map.footprints.size() != in.map.photons.size())
    fail(ErrorKind::kBadInput, "photon_bvh",
         "the photons have no footprints; PhotonTrace::In::footprints asks for them");
  {
    const auto scope = stats.scope("photon_bvh.build");
    s.build(in, settings_, stats, job);
  }
  const auto scope = stats.scope("photon_bvh");
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t t) {
    job.throwIfStopped();
    photon_estimate::PairCounts counts;
    const TileEstimate::In tile{s.hierarchy, s.ellipsoids, s.reach, settings_.kernel, in.simd};
    s.pairs[t].tested = s.tiles.local().run(tile, in.view.tiles[t], out[t], counts);
    s.pairs[t].contributing = counts.contributing;
    if (++done % 1024 == 0) job.report("photon_bvh", double(done) / double(out.size()));
  });
  s.tell(stats);
}

}  // namespace isophote

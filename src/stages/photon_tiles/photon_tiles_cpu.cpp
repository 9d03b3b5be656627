// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_estimate/photon_lists.h"
#include "stages/photon_estimate/sphere_loops.h"
#include "stages/photon_estimate/sphere_passes.h"
#include "stages/photon_tiles/photon_tiles.h"
#include "stages/photon_tiles/screen_tiles.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace isophote {

using namespace photon_estimate;
using namespace photon_tiles;

namespace {

/// To find a photon's tiles is little work beside the pairs of a list: most of it is rather done twice.
constexpr std::uint64_t kMostKeptBytes = std::uint64_t(4) << 20;

constexpr std::size_t kPhotonsPerPart = 4096;  ///< Copied side by side, so that they stay in the cache.

struct Pairs {
  std::uint64_t tested = 0;
  PairCounts counts;
};

/// Copies of photons that lie together, and 0, 1, 2 ... to index them.
struct Part {
  std::vector<PhotonSphere> spheres;
  std::vector<std::uint32_t> list;

  void copy(std::span<const PhotonSphere> all, std::span<const std::uint32_t> photons) {
    spheres.resize(photons.size());
    for (std::size_t i = 0; i < photons.size(); ++i) spheres[i] = all[photons[i]];
    if (list.size() < photons.size()) {
      list.resize(photons.size());
      std::iota(list.begin(), list.end(), 0u);
    }
  }
};

SphereLoopKind kindOf(const ViewTile& tile) {
  return {.lambertian = tile.lambertian != 0, .transmits = tile.transmits != 0, .flat = isFlat(tile)};
}

}  // namespace

struct PhotonTiles::Scratch {
  std::vector<PhotonSphere> spheres;
  ScreenTiles tiles;
  PhotonLists lists{kMostKeptBytes};
  std::vector<Pairs> pairs;  ///< Of each screen tile.
  tbb::enumerable_thread_specific<Part> parts;

  /// As PhotonLists::build.
  std::uint32_t fillLists(std::uint32_t first, std::uint64_t bytes, const Job& job) {
    return lists.build(first, std::uint32_t(spheres.size()), tiles.size(), bytes,
                       [&](std::uint32_t begin, std::uint32_t end, auto&& visit) {
                         job.throwIfStopped();
                         for (std::uint32_t photon = begin; photon < end; ++photon)
                           tiles.forEachTouched(spheres[photon],
                                                [&](std::size_t tile) { visit(tile, photon); });
                       });
  }

  /// Adds the photons of all lists.
  void estimateAll(const In& in, Radiance& out, const Job& job) {
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t tile) {
      estimate(in, tile, out, job);
      const std::size_t now = ++done;
      if (now % 64 == 0) job.report("photon_tiles", double(now) / double(tiles.size()));
    });
  }

  /// Adds the photons of a tile's list to its samples.
  void estimate(const In& in, std::size_t tile, Radiance& out, const Job& job) {
    const std::span<const std::uint32_t> photons = lists.photons(tile);
    Part& part = parts.local();
    for (std::size_t i = 0; i < photons.size(); i += kPhotonsPerPart) {
      part.copy(spheres, photons.subspan(i, std::min(kPhotonsPerPart, photons.size() - i)));
      for (const std::uint32_t index : tiles.viewTiles(tile)) {
        if (index == kNoTile || in.view.tiles[index].count == 0) continue;
        job.throwIfStopped();
        const ViewTile& view = in.view.tiles[index];
        const std::span<const std::uint32_t> list(part.list.data(), part.spheres.size());
        runSphereLoop(sphereLoopFor(kindOf(view), false, in.simd), view, part.spheres.data(), list,
                      kTileLanes, out[index], pairs[tile].counts);
        pairs[tile].tested += std::uint64_t(list.size()) * view.count;
      }
    }
  }
};

PhotonTiles::PhotonTiles(PhotonTilesSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
PhotonTiles::~PhotonTiles() = default;
PhotonTiles::PhotonTiles(PhotonTiles&&) noexcept = default;
PhotonTiles& PhotonTiles::operator=(PhotonTiles&&) noexcept = default;

void PhotonTiles::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  const Stats::Scope scope = stats.scope("photon_tiles");
  Scratch& s = *scratch_;
  s.tiles.build(in.view);
  s.pairs.assign(s.tiles.size(), {});
  out.resize(in.view.tiles.size());
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) { out[i] = {}; });

  std::uint64_t entries = 0;
  const std::uint32_t passes = forEachSubPass(
      in.map.photons, in.radius, "photon_tiles.radius", s.spheres, job,
      [&](std::uint32_t first, std::uint64_t maxBytes) {
        const std::uint32_t taken = s.fillLists(first, maxBytes, job);
        entries += s.lists.entries();
        return taken;
      },
      [&](const Job& part) { s.estimateAll(in, out, part); });
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) {
    if (in.view.tiles[i].lambertian != 0) lambertianRadiance(in.view.tiles[i], out[i]);
  });

  Pairs sum;
  for (const Pairs& pairs : s.pairs) {
    sum.tested += pairs.tested;
    sum.counts.felt += pairs.counts.felt;
    sum.counts.contributing += pairs.counts.contributing;
  }
  stats.setCounter("photon_tiles.pairsTested", double(sum.tested));
  stats.setCounter("photon_tiles.pairsRejected", double(sum.tested - sum.counts.felt));
  stats.setCounter("photon_tiles.pairsContributing", double(sum.counts.contributing));
  stats.setCounter("photon_tiles.listEntries", double(entries));
  stats.setCounter("photon_tiles.subPasses", double(passes));
  stats.peakBytes("photon_tiles.photons", s.spheres.capacity() * sizeof(PhotonSphere));
  stats.peakBytes("photon_tiles.lists", s.lists.bytes());
}

}  // namespace isophote

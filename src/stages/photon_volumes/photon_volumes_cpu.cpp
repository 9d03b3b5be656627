// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/estimate.h"
#include "stages/photon_volumes/photon_bins.h"
#include "stages/photon_volumes/photon_volumes.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>

namespace isophote {

using namespace photon_volumes;

namespace {

constexpr std::uint64_t kPairsWorthThreads = 4'000'000;  ///< A few milliseconds of one thread.

struct Pairs {
  std::uint64_t tested = 0;
  std::uint64_t contributing = 0;
};

/// One pass over the blocks: what every block's task needs.
struct Pass {
  const ViewSamples& view;
  const TileBlocks& blocks;
  std::span<const PhotonVolume> volumes;
  const PhotonBins& bins;
  Kernel kernel;
  SimdLevel simd;
  bool first;  ///< The radiance starts from 0.
  bool last;   ///< The radiance is complete afterwards.
  const Job& job;
};

/// Adds the photons of one tile's list.
Pairs estimateTile(const Pass& pass, const ViewTile& tile, const BlockLists& lists, int slot,
                   RadianceTile& sums) {
  pass.job.throwIfStopped();
  const std::span<const std::uint32_t> list = lists.list(slot);
  const EstimateFn estimate = estimateFor(tile, pass.simd);
  PairCounts counts;
  for (std::size_t i = 0; i < list.size(); i += kPhotonsPerCall) {
    const std::size_t count = std::min<std::size_t>(kPhotonsPerCall, list.size() - i);
    estimate(tile, lists.volumes().data(), list.data() + i, std::uint32_t(count), uint(pass.kernel), sums,
             counts);
  }
  return {std::uint64_t(list.size()) * tile.count, counts.contributing};
}

/// Adds a part of one block's photons to its tiles; with much to do, by several threads.
Pairs estimatePart(const Pass& pass, std::size_t block, const BlockLists& lists, Radiance& out) {
  std::array<Pairs, kNodeWidth> pairs;
  const auto estimateSlot = [&](int slot) {
    if (lists.list(slot).empty()) return;
    const std::uint32_t tile = pass.blocks.tiles(block)[std::size_t(slot)];
    pairs[std::size_t(slot)] = estimateTile(pass, pass.view.tiles[tile], lists, slot, out[tile]);
  };
  std::uint64_t lanes = 0;
  for (int slot = 0; slot < kNodeWidth; ++slot) lanes += lists.list(slot).size() * kTileLanes;
  if (lanes < kPairsWorthThreads) {
    for (int slot = 0; slot < kNodeWidth; ++slot) estimateSlot(slot);
  } else {
    // Isolated, because a thread that waits here must not take up another block, which would overwrite its
    // lists.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(0, kNodeWidth, estimateSlot); });
  }
  Pairs sum;
  for (const Pairs& p : pairs) {
    sum.tested += p.tested;
    sum.contributing += p.contributing;
  }
  return sum;
}

Pairs estimateBlock(const Pass& pass, std::size_t block, BlockLists& lists, Radiance& out) {
  if (pass.first)
    for (const std::uint32_t tile : pass.blocks.tiles(block))
      if (tile != kNoTile) out[tile] = {};
  const std::span<const std::uint32_t> photons = pass.bins.photons(block);
  Pairs sum;
  for (std::size_t i = 0; i < photons.size(); i += kPhotonsPerPart) {
    const std::size_t count = std::min(kPhotonsPerPart, photons.size() - i);
    lists.build(pass.blocks.bounds(block), pass.volumes, photons.subspan(i, count), touchFor(pass.simd));
    const Pairs pairs = estimatePart(pass, block, lists, out);
    sum.tested += pairs.tested;
    sum.contributing += pairs.contributing;
  }
  if (pass.last)
    for (const std::uint32_t tile : pass.blocks.tiles(block))
      if (tile != kNoTile && pass.view.tiles[tile].lambertian != 0)
        lambertianRadiance(pass.view.tiles[tile], out[tile]);
  return sum;
}

}  // namespace

struct PhotonVolumes::Scratch {
  std::vector<PhotonVolume> volumes;
  TileBlocks blocks;
  PhotonBins bins;
  std::vector<Pairs> pairs;  ///< Of each block.
  tbb::enumerable_thread_specific<BlockLists> lists;
};

PhotonVolumes::PhotonVolumes(PhotonVolumesSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
PhotonVolumes::~PhotonVolumes() = default;
PhotonVolumes::PhotonVolumes(PhotonVolumes&&) noexcept = default;
PhotonVolumes& PhotonVolumes::operator=(PhotonVolumes&&) noexcept = default;

void PhotonVolumes::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  const Stats::Scope scope = stats.scope("photon_volumes");
  Scratch& s = *scratch_;
  out.resize(in.view.tiles.size());
  makeVolumes(in.map, in.radius, settings_, s.volumes);
  s.blocks.build(in.view);
  s.pairs.assign(s.blocks.size(), {});

  const std::size_t perPass = PhotonBins::photonsWithin(job.memoryBudgetBytes, s.blocks.size());
  std::uint64_t largestBins = 0;
  std::size_t first = 0;
  do {
    const std::size_t count = std::min(perPass, s.volumes.size() - first);
    job.throwIfStopped();
    s.bins.build(s.blocks, s.volumes, std::uint32_t(first), std::uint32_t(count), touchFor(in.simd));
    largestBins = std::max(largestBins, s.bins.bytes());
    const Pass pass{in.view,
                    s.blocks,
                    s.volumes,
                    s.bins,
                    settings_.kernel,
                    in.simd,
                    first == 0,
                    first + count == s.volumes.size(),
                    job};
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t(0), s.blocks.size(), [&](std::size_t block) {
      const Pairs pairs = estimateBlock(pass, block, s.lists.local(), out);
      s.pairs[block].tested += pairs.tested;
      s.pairs[block].contributing += pairs.contributing;
      const double share = double(++done) / double(s.blocks.size());
      if (done % 64 == 0)
        job.report("photon_volumes", (double(first) + share * double(count)) /
                                         double(std::max<std::size_t>(s.volumes.size(), 1)));
    });
    first += count;
  } while (first < s.volumes.size());

  Pairs sum;
  for (const Pairs& pairs : s.pairs) {
    sum.tested += pairs.tested;
    sum.contributing += pairs.contributing;
  }
  stats.setCounter("photon_volumes.pairsTested", double(sum.tested));
  stats.setCounter("photon_volumes.pairsContributing", double(sum.contributing));
  stats.peakBytes("photon_volumes.volumes", s.volumes.size() * sizeof(PhotonVolume));
  stats.peakBytes("photon_volumes.lists", s.blocks.bytes() + largestBins);
}

}  // namespace isophote

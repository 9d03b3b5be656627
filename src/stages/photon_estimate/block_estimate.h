// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "stages/photon_estimate/photon_bins.h"
#include "stages/photon_estimate/photon_loops.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote::photon_estimate {

/// Photons to hand to one call: they stay in the first-level cache for all groups of a tile.
inline constexpr std::uint32_t kPhotonsPerCall = 256;

/// A loop over photons[list[0]] to photons[list[count - 1]], in that order, against a tile's view samples.
/// Adds to `sums`, and to `counts`. Every lane does the same operations in the same order at every SimdLevel
/// (no contraction, no reassociation), so that the bytes do not depend on it.
template <class Photon>
using TileLoop = void (*)(const ViewTile& tile, const Photon* photons, const std::uint32_t* list,
                          std::uint32_t count, uint kernel, RadianceTile& sums, PairCounts& counts);

/// An estimate by scattering, whatever a photon's footprint: photons are binned to the blocks of tiles whose
/// view samples they can reach, through a tree over the tiles' bounds that follows the screen; each tile
/// loops over its photons. Sums run in photon order, so that the same bytes come out at any number of threads
/// and any memory budget.
template <class Photon>
class BlockEstimate {
 public:
  struct In {
    std::string_view stage;  ///< Names statistics and progress.
    const ViewSamples& view;
    const std::vector<Photon>& photons;
    uint kernel;
    TouchFn<Photon> touch;
    TileLoop<Photon> (*loopFor)(const ViewTile& tile, SimdLevel level);
    SimdLevel simd;
  };
  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused. Stats (of stage.): counters pairsTested,
  /// pairsContributing, bytes of lists.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job);

 private:
  struct Pairs {
    std::uint64_t tested = 0;
    std::uint64_t contributing = 0;
    void add(const Pairs& other) {
      tested += other.tested;
      contributing += other.contributing;
    }
  };
  static Pairs estimateTile(const In& in, const ViewTile& tile, const BlockLists<Photon>& lists, int slot,
                            RadianceTile& sums, const Job& job);
  Pairs estimatePart(const In& in, std::size_t block, const BlockLists<Photon>& lists, Radiance& out,
                     const Job& job) const;
  void estimateBlock(const In& in, std::size_t block, bool first, bool last, Radiance& out, const Job& job);

  TileBlocks blocks_;
  PhotonBins bins_;
  std::vector<Pairs> pairs_;  ///< Of each block.
  tbb::enumerable_thread_specific<BlockLists<Photon>> lists_;
};

/// Adds the photons of one tile's list.
template <class Photon>
auto BlockEstimate<Photon>::estimateTile(const In& in, const ViewTile& tile, const BlockLists<Photon>& lists,
                                         int slot, RadianceTile& sums, const Job& job) -> Pairs {
  job.throwIfStopped();
  const std::span<const std::uint32_t> list = lists.list(slot);
  const TileLoop<Photon> loop = in.loopFor(tile, in.simd);
  PairCounts counts;
  for (std::size_t i = 0; i < list.size(); i += kPhotonsPerCall) {
    const std::size_t count = std::min<std::size_t>(kPhotonsPerCall, list.size() - i);
    loop(tile, lists.photons().data(), list.data() + i, std::uint32_t(count), in.kernel, sums, counts);
  }
  return {std::uint64_t(list.size()) * tile.count, counts.contributing};
}

/// Adds a part of one block's photons to its tiles; with much to do, by several threads.
template <class Photon>
auto BlockEstimate<Photon>::estimatePart(const In& in, std::size_t block, const BlockLists<Photon>& lists,
                                         Radiance& out, const Job& job) const -> Pairs {
  constexpr std::uint64_t kPairsWorthThreads = 4'000'000;  // A few milliseconds of one thread.
  std::array<Pairs, kNodeWidth> pairs;
  const auto estimateSlot = [&](int slot) {
    if (lists.list(slot).empty()) return;
    const std::uint32_t tile = blocks_.tiles(block)[std::size_t(slot)];
    pairs[std::size_t(slot)] = estimateTile(in, in.view.tiles[tile], lists, slot, out[tile], job);
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
  for (const Pairs& p : pairs) sum.add(p);
  return sum;
}

/// Adds the photons of this pass. The radiance starts from 0 in the first, and is complete after the last.
template <class Photon>
void BlockEstimate<Photon>::estimateBlock(const In& in, std::size_t block, bool first, bool last,
                                          Radiance& out, const Job& job) {
  if (first)
    for (const std::uint32_t tile : blocks_.tiles(block))
      if (tile != kNoTile) out[tile] = {};
  const std::span<const std::uint32_t> photons = bins_.photons(block);
  BlockLists<Photon>& lists = lists_.local();
  for (std::size_t i = 0; i < photons.size(); i += kPhotonsPerPart) {
    const std::size_t count = std::min(kPhotonsPerPart, photons.size() - i);
    lists.build(blocks_.bounds(block), in.photons, photons.subspan(i, count), in.touch);
    pairs_[block].add(estimatePart(in, block, lists, out, job));
  }
  if (last)
    for (const std::uint32_t tile : blocks_.tiles(block))
      if (tile != kNoTile && in.view.tiles[tile].lambertian != 0)
        lambertianRadiance(in.view.tiles[tile], out[tile]);
}

template <class Photon>
void BlockEstimate<Photon>::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  out.resize(in.view.tiles.size());
  blocks_.build(in.view);
  pairs_.assign(blocks_.size(), {});
  const std::size_t perPass = PhotonBins::photonsWithin(job.memoryBudgetBytes, blocks_.size());
  std::uint64_t largestBins = 0;
  std::size_t first = 0;
  do {
    const std::size_t count = std::min(perPass, in.photons.size() - first);
    job.throwIfStopped();
    bins_.build(blocks_, in.photons, std::uint32_t(first), std::uint32_t(count), in.touch);
    largestBins = std::max(largestBins, bins_.bytes());
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t(0), blocks_.size(), [&](std::size_t block) {
      estimateBlock(in, block, first == 0, first + count == in.photons.size(), out, job);
      const double share = double(++done) / double(blocks_.size());
      if (done % 64 == 0)
        job.report(in.stage, (double(first) + share * double(count)) /
                                 double(std::max<std::size_t>(in.photons.size(), 1)));
    });
    first += count;
  } while (first < in.photons.size());

  Pairs sum;
  for (const Pairs& pairs : pairs_) sum.add(pairs);
  const std::string stage(in.stage);
  stats.setCounter(stage + ".pairsTested", double(sum.tested));
  stats.setCounter(stage + ".pairsContributing", double(sum.contributing));
  stats.peakBytes(stage + ".lists", blocks_.bytes() + largestBins);
}

}  // namespace isophote::photon_estimate

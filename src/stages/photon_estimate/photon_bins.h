// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_estimate/tile_blocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote::photon_estimate {

/// Which photons may reach which block of tiles, for a range of photons. Photons are whatever a TouchFn
/// tests.
class PhotonBins {
 public:
  /// Bins photons[first] to photons[first + count - 1]; reuses memory. Parallel over chunks of photons whose
  /// size is fixed, so the lists do not depend on the number of threads.
  template <class Photon>
  void build(const TileBlocks& blocks, const std::vector<Photon>& photons, std::uint32_t first,
             std::uint32_t count, TouchFn<Photon> touch) {
    chunks_.resize((count + kChunkPhotons - 1) / kChunkPhotons);
    tbb::parallel_for(std::size_t(0), chunks_.size(), [&](std::size_t c) {
      Chunk& chunk = chunks_[c];
      chunk.blocks.clear();
      chunk.counts.clear();
      chunk.offsets.assign(blocks.size(), 0);
      const std::uint32_t from = std::uint32_t(c) * kChunkPhotons;
      const std::uint32_t to = std::min(from + kChunkPhotons, count);
      for (std::uint32_t i = from; i < to; ++i) {
        const std::size_t before = chunk.blocks.size();
        blocks.forEachTouched(photons[first + i], touch, [&](std::size_t block) {
          chunk.blocks.push_back(std::uint32_t(block));
          ++chunk.offsets[block];
        });
        chunk.counts.push_back(std::uint32_t(chunk.blocks.size() - before));
      }
    });
    place(blocks.size());
    scatter(first);
  }

  /// Indices into the photons, ascending.
  std::span<const std::uint32_t> photons(std::size_t block) const {
    return {photons_.data() + begin_[block], photons_.data() + begin_[block + 1]};
  }
  std::uint64_t bytes() const;

  /// How many photons to bin at once under a memory budget [bytes], even if every one reached every block; at
  /// least 1. The bins take a small share of the budget.
  static std::uint32_t photonsWithin(std::uint64_t budget, std::size_t blocks);

 private:
  static constexpr std::uint32_t kChunkPhotons = 512;

  struct Chunk {
    std::vector<std::uint32_t> blocks;   ///< Of all its photons, one after the other.
    std::vector<std::uint32_t> counts;   ///< Blocks of each photon.
    std::vector<std::uint32_t> offsets;  ///< For each block: photons of this chunk, then their place.
  };
  void place(std::size_t blocks);
  void scatter(std::uint32_t first);

  std::vector<Chunk> chunks_;
  std::vector<std::size_t> begin_;  ///< Of each block in photons_, and the end.
  std::vector<std::uint32_t> photons_;
};

/// Photons of a block whose lists are made and worked off at once: they stay in the cache, and the lists are
/// small even if every photon reaches every tile.
inline constexpr std::size_t kPhotonsPerPart = 4096;

/// The lists of the 64 tiles of one block, for part of its photons.
template <class Photon>
class BlockLists {
 public:
  /// Reuses memory.
  void build(const BoundsNode& bounds, const std::vector<Photon>& all, std::span<const std::uint32_t> photons,
             TouchFn<Photon> touch) {
    photons_.resize(photons.size());
    masks_.resize(photons.size());
    begin_.fill(0);
    for (std::size_t i = 0; i < photons.size(); ++i) {
      photons_[i] = all[photons[i]];
      touch(bounds, photons_[i], masks_[i]);
      for (std::uint64_t mask = masks_[i]; mask != 0; mask &= mask - 1)
        ++begin_[std::size_t(std::countr_zero(mask)) + 1];
    }
    for (std::size_t slot = 0; slot < kNodeWidth; ++slot) begin_[slot + 1] += begin_[slot];
    list_.resize(begin_[kNodeWidth]);
    std::array<std::uint32_t, kNodeWidth> next;
    std::copy_n(begin_.begin(), kNodeWidth, next.begin());
    for (std::uint32_t i = 0; i < photons.size(); ++i)
      for (std::uint64_t mask = masks_[i]; mask != 0; mask &= mask - 1)
        list_[next[std::size_t(std::countr_zero(mask))]++] = i;
  }

  /// Copies of the photons, in the order of `photons`.
  const std::vector<Photon>& photons() const { return photons_; }
  /// Indices into photons() of what may reach a tile, ascending.
  std::span<const std::uint32_t> list(int slot) const {
    return {list_.data() + begin_[std::size_t(slot)], list_.data() + begin_[std::size_t(slot) + 1]};
  }

 private:
  std::vector<Photon> photons_;
  std::vector<std::uint64_t> masks_;
  std::array<std::uint32_t, kNodeWidth + 1> begin_{};
  std::vector<std::uint32_t> list_;
};

}  // namespace isophote::photon_estimate

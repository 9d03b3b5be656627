// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_trace/photon_map.h"
#include "stages/photon_volumes/photon_volumes.h"
#include "stages/photon_volumes/tile_blocks.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace isophote::photon_volumes {

/// One volume a photon, in the map's order; reuses memory. `radius` as in PhotonVolumes::In.
/// Throws Error(kBadUsage) where the radius is not a positive number.
void makeVolumes(const PhotonMap& map, float radius, const PhotonVolumesSettings& settings,
                 std::vector<PhotonVolume>& volumes);

/// Which photons may reach which block of tiles, for a range of photons.
class PhotonBins {
 public:
  /// Bins volumes[first] to volumes[first + count - 1]; reuses memory. Parallel over chunks of photons whose
  /// size is fixed, so the lists do not depend on the number of threads.
  void build(const TileBlocks& blocks, std::span<const PhotonVolume> volumes, std::uint32_t first,
             std::uint32_t count, TouchFn touch);

  /// Indices into the volumes, ascending.
  std::span<const std::uint32_t> photons(std::size_t block) const {
    return {photons_.data() + begin_[block], photons_.data() + begin_[block + 1]};
  }
  std::uint64_t bytes() const;

  /// How many photons to bin at once under a memory budget [bytes], even if every one reached every block; at
  /// least 1. The bins take a small share of the budget.
  static std::uint32_t photonsWithin(std::uint64_t budget, std::size_t blocks);

 private:
  struct Chunk {
    std::vector<std::uint32_t> blocks;   ///< Of all its photons, one after the other.
    std::vector<std::uint32_t> counts;   ///< Blocks of each photon.
    std::vector<std::uint32_t> offsets;  ///< For each block: photons of this chunk, then their place.
  };
  void scatter(std::uint32_t first);

  std::vector<Chunk> chunks_;
  std::vector<std::size_t> begin_;  ///< Of each block in photons_, and the end.
  std::vector<std::uint32_t> photons_;
};

/// Photons of a block whose lists are made and worked off at once: their volumes stay in the cache, and the
/// lists are small even if every photon reaches every tile.
inline constexpr std::size_t kPhotonsPerPart = 4096;

/// The lists of the 64 tiles of one block, for part of its photons.
class BlockLists {
 public:
  /// Reuses memory.
  void build(const BoundsNode& bounds, std::span<const PhotonVolume> volumes,
             std::span<const std::uint32_t> photons, TouchFn touch);

  /// Copies of the photons' volumes, in the order of `photons`.
  const std::vector<PhotonVolume>& volumes() const { return volumes_; }
  /// Indices into volumes() of what may reach a tile, ascending.
  std::span<const std::uint32_t> list(int slot) const {
    return {list_.data() + begin_[std::size_t(slot)], list_.data() + begin_[std::size_t(slot) + 1]};
  }

 private:
  std::vector<PhotonVolume> volumes_;
  std::vector<std::uint64_t> masks_;
  std::array<std::uint32_t, kNodeWidth + 1> begin_{};
  std::vector<std::uint32_t> list_;
};

}  // namespace isophote::photon_volumes

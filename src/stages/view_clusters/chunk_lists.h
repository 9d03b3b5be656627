// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace isophote::view_clusters {

/// Lists of photons that take two bytes an entry. Photons are worked on in chunks of a fixed size; what a
/// list has of a chunk is kept with the chunk, as places within it, so that nothing is counted beforehand and
/// moved afterwards. Who reads a list goes from chunk to chunk: it is in photon order and does not depend on
/// the number of threads.
class ChunkLists {
 public:
  /// What the photons of one chunk put on lists.
  class Chunk {
   public:
    /// Once for a list at most: `places` of photons in the chunk, ascending.
    void put(std::size_t list, std::span<const std::uint32_t> places);

   private:
    friend class ChunkLists;
    std::vector<std::uint16_t>& to_;
    std::uint32_t* runs_;   ///< The chunk's, of the first list.
    std::size_t stride_;    ///< To that of the next list.
    std::size_t mostKept_;  ///< Beyond, nothing is kept.
    std::size_t size_ = 0;  ///< What it takes in `to_`.
    std::size_t entries_ = 0;

    Chunk(std::vector<std::uint16_t>& to, std::uint32_t* runs, std::size_t stride, std::size_t mostKept)
        : to_(to), runs_(runs), stride_(stride), mostKept_(mostKept) {
      to_.clear();
    }
  };
  /// Puts photons `begin` to `end` on lists, the same every time.
  using Walk = std::function<void(std::uint32_t begin, std::uint32_t end, Chunk& chunk)>;

  /// Puts photons `first`, `first` + 1, ... of `total` on `lists` lists, as many of them as `maxBytes` hold
  /// (one chunk at least), and returns how many. Chunks whose entries would take too much before it is known
  /// whether they have a place are walked twice. Reuses memory.
  std::uint32_t build(std::uint32_t first, std::uint32_t total, std::size_t lists, std::uint64_t maxBytes,
                      const Walk& walk);

  /// Calls part(photons) for a list's photons, ascending, `most` at a time but for the last ones; they lie in
  /// `memory`.
  template <class Part>
  void forEachPart(std::size_t list, std::size_t most, std::vector<std::uint32_t>& memory,
                   Part&& part) const {
    memory.resize(std::max(most, memory.size()));
    std::size_t count = 0;
    for (std::uint32_t chunk = 0; chunk < taken_; ++chunk) {
      const std::uint32_t base = first_ + chunk * kChunk;
      for (std::span<const std::uint16_t> places = run(list, chunk); !places.empty();) {
        const std::size_t now = std::min(places.size(), most - count);
        for (std::size_t i = 0; i < now; ++i) memory[count + i] = base + places[i];
        count += now;
        places = places.subspan(now);
        if (count < most) continue;
        part(std::span<const std::uint32_t>(memory.data(), count));
        count = 0;
      }
    }
    if (count > 0) part(std::span<const std::uint32_t>(memory.data(), count));
  }

  /// Of all lists.
  std::size_t entries() const { return entries_; }
  std::uint64_t bytes() const;

 private:
  static constexpr std::uint32_t kChunk = 512;

  struct Kept {
    std::vector<std::uint16_t> runs;  ///< Of its lists, in the order of being put: how many, then places.
    std::size_t size = 0;             ///< Of `runs`, also where they were too many to be kept.
    std::size_t entries = 0;
  };

  std::span<const std::uint16_t> run(std::size_t list, std::uint32_t chunk) const {
    const std::uint32_t end = runs_[list * chunks_ + chunk];
    if (end == 0) return {};
    const std::uint16_t* const places = kept_[chunk].runs.data() + end;
    return {places, places[-1]};
  }
  std::uint32_t windowWithin(std::size_t lists, std::uint64_t maxBytes) const;
  std::uint32_t chunksWithin(std::uint64_t maxBytes);

  std::uint32_t first_ = 0;
  std::uint32_t chunks_ = 0;  ///< That were walked,
  std::uint32_t taken_ = 0;   ///< and of these, that had a place.
  std::size_t entries_ = 0;
  std::uint32_t lastTaken_ = 0;      ///< Photons.
  std::vector<Kept> kept_;           ///< Of the chunks.
  std::vector<std::uint32_t> runs_;  ///< By list, then chunk: where its places begin; 0: it has none.
  tbb::enumerable_thread_specific<std::vector<std::uint16_t>> walked_;
};

}  // namespace isophote::view_clusters

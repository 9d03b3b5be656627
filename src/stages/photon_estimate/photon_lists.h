// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace isophote::photon_estimate {

/// Lists of photons, filled in three passes: every photon says which lists it goes to and these are counted,
/// a prefix sum gives each list its place, and what they said is inserted; they say it over again where it
/// would take too much memory to be kept. Photons are worked on in chunks of a fixed size, each with a place
/// of its own in every list, so that the lists are in photon order and do not depend on the number of
/// threads.
class PhotonLists {
 public:
  /// What photons said takes no more than `mostKeptBytes`, whatever is allowed for all: little where saying
  /// it over again costs next to nothing beside the work on the lists.
  explicit PhotonLists(std::uint64_t mostKeptBytes) : mostKeptBytes_(mostKeptBytes) {}

  /// Puts photons `first`, `first` + 1, ... of `total` into `lists` lists, as many of them as `maxBytes` hold
  /// (one chunk at least), and returns how many. walk(begin, end, visit) calls visit(list, photon) for each
  /// list of each photon from `begin` to `end`, the same ones in the same order every time, and each list's
  /// photons in ascending order. Reuses memory.
  template <class Walk>
  std::uint32_t build(std::uint32_t first, std::uint32_t total, std::size_t lists, std::uint64_t maxBytes,
                      Walk&& walk) {
    if (lists == 0) return total - first;
    if (first == 0) lastTaken_ = 0;
    const std::uint32_t window = std::min(total - first, windowWithin(lists, maxBytes));
    const std::uint32_t chunks = (window + kChunk - 1) / kChunk;
    counts_.assign(std::size_t(chunks) * lists, 0);
    if (walks_.size() < chunks) walks_.resize(chunks);
    const std::size_t mostKept =
        std::min(maxBytes / 4, mostKeptBytes_) / (sizeof(Entry) * std::max(chunks, 1u));
    const auto walkChunk = [&](std::uint32_t chunk, auto&& visit) {
      walk(first + chunk * kChunk, first + std::min((chunk + 1) * kChunk, window), visit);
    };
    tbb::parallel_for(std::uint32_t(0), chunks, [&](std::uint32_t chunk) {
      std::uint32_t* const counts = counts_.data() + std::size_t(chunk) * lists;
      Walked& walked = walks_[chunk];
      walked.entries.clear();
      walked.whole = true;
      walkChunk(chunk, [&](std::size_t list, std::uint32_t photon) {
        ++counts[list];
        walked.whole = walked.whole && walked.entries.size() < mostKept;
        if (!walked.whole) return;
        if (walked.entries.size() == walked.entries.capacity())
          walked.entries.reserve(std::min(std::max(2 * walked.entries.size(), kFewestKept), mostKept));
        walked.entries.push_back({std::uint32_t(list), photon});
      });
    });
    const std::uint32_t placed = place(lists, maxBytes);
    const std::uint32_t taken = std::min(window, placed * kChunk);
    tbb::parallel_for(std::uint32_t(0), placed, [&](std::uint32_t chunk) {
      std::uint32_t* const next = counts_.data() + std::size_t(chunk) * lists;
      const auto insert = [&](std::size_t list, std::uint32_t photon) {
        photons_[begin_[list] + next[list]++] = photon;
      };
      if (walks_[chunk].whole)
        for (const Entry& entry : walks_[chunk].entries) insert(entry.list, entry.photon);
      else
        walkChunk(chunk, insert);
    });
    lastTaken_ = taken;
    return taken;
  }

  /// Ascending.
  std::span<const std::uint32_t> photons(std::size_t list) const {
    return {photons_.data() + begin_[list], photons_.data() + begin_[list + 1]};
  }
  std::size_t entries() const { return begin_.empty() ? 0 : begin_.back(); }
  std::uint64_t bytes() const {
    std::uint64_t kept = 0;
    for (const Walked& walked : walks_) kept += walked.entries.capacity();
    return kept * sizeof(Entry) + (photons_.capacity() + counts_.capacity()) * sizeof(std::uint32_t) +
           begin_.capacity() * sizeof(std::size_t);
  }

 private:
  static constexpr std::uint32_t kChunk = 512;
  static constexpr std::size_t kFewestKept = 256;

  struct Entry {
    std::uint32_t list, photon;
  };
  /// What the photons of a chunk said.
  struct Walked {
    std::vector<Entry> entries;
    bool whole = true;  ///< It was not too much to be kept.
  };

  /// Photons to count at once: the counters of their chunks take half of the bytes at most; and not many more
  /// than the last time were taken.
  std::uint32_t windowWithin(std::size_t lists, std::uint64_t maxBytes) const {
    const std::uint64_t chunks = maxBytes / (2 * sizeof(std::uint32_t) * std::max<std::uint64_t>(lists, 1));
    const std::uint64_t most = std::clamp<std::uint64_t>(chunks, 1, 1u << 20) * kChunk;
    return std::uint32_t(lastTaken_ == 0 ? most
                                         : std::min<std::uint64_t>(most, 2 * std::uint64_t(lastTaken_)));
  }

  /// Chunks whose entries the bytes hold; turns their counts into places behind begin_[list].
  std::uint32_t place(std::size_t lists, std::uint64_t maxBytes);

  std::vector<std::uint32_t> counts_;  ///< By chunk, then list: photons, then the place of the next one.
  std::vector<Walked> walks_;
  std::vector<std::size_t> begin_;  ///< Of each list in photons_, and the end.
  std::vector<std::uint32_t> photons_;
  std::uint32_t lastTaken_ = 0;
  std::uint64_t mostKeptBytes_;
};

}  // namespace isophote::photon_estimate

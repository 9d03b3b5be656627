// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_estimate/photon_bins.h"

#include <utility>

namespace isophote::photon_estimate {
namespace {

constexpr std::uint64_t kLargestBins = std::uint64_t(256) << 20;  ///< [bytes]
constexpr std::uint64_t kBudgetShare = 8;  ///< Bins take at most this part of the budget.

}  // namespace

std::uint32_t PhotonBins::photonsWithin(std::uint64_t budget, std::size_t blocks) {
  const std::uint64_t bytes = std::min(kLargestBins, budget / kBudgetShare);
  // A photon in every block takes one entry a block in its chunk and one in the result.
  const std::uint64_t worst = 2 * sizeof(std::uint32_t) * std::max<std::uint64_t>(blocks, 1);
  return std::uint32_t(std::clamp<std::uint64_t>(bytes / worst, 1, 1u << 30));
}

/// Gives every block, and within it every chunk, its place.
void PhotonBins::place(std::size_t blocks) {
  begin_.assign(blocks + 1, 0);
  for (std::size_t block = 0; block < blocks; ++block) {
    std::uint32_t photons = 0;
    for (Chunk& chunk : chunks_) photons += std::exchange(chunk.offsets[block], photons);
    begin_[block + 1] = begin_[block] + photons;
  }
  photons_.resize(begin_.back());
}

void PhotonBins::scatter(std::uint32_t first) {
  tbb::parallel_for(std::size_t(0), chunks_.size(), [&](std::size_t c) {
    Chunk& chunk = chunks_[c];
    std::uint32_t photon = first + std::uint32_t(c) * kChunkPhotons;
    std::size_t next = 0;
    for (const std::uint32_t count : chunk.counts) {
      for (const std::size_t end = next + count; next < end; ++next) {
        const std::uint32_t block = chunk.blocks[next];
        photons_[begin_[block] + chunk.offsets[block]++] = photon;
      }
      ++photon;
    }
  });
}

std::uint64_t PhotonBins::bytes() const {
  std::uint64_t words = photons_.size();
  for (const Chunk& chunk : chunks_)
    words += chunk.blocks.size() + chunk.counts.size() + chunk.offsets.size();
  return words * sizeof(std::uint32_t) + begin_.size() * sizeof(std::size_t);
}

}  // namespace isophote::photon_estimate

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/view_clusters/chunk_lists.h"

#include <tbb/parallel_for.h>

namespace isophote::view_clusters {

void ChunkLists::Chunk::put(std::size_t list, std::span<const std::uint32_t> places) {
  if (places.empty()) return;
  runs_[list * stride_] = std::uint32_t(size_ + 1);
  size_ += 1 + places.size();
  entries_ += places.size();
  if (size_ > mostKept_) return;
  const std::size_t at = to_.size();
  to_.resize(size_);
  to_[at] = std::uint16_t(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) to_[at + 1 + i] = std::uint16_t(places[i]);
}

std::uint32_t ChunkLists::build(std::uint32_t first, std::uint32_t total, std::size_t lists,
                                std::uint64_t maxBytes, const Walk& walk) {
  if (first == 0) lastTaken_ = 0;
  if (bytes() > maxBytes / 2) kept_ = {};
  const std::uint32_t window = std::min(total - first, windowWithin(lists, maxBytes));
  first_ = first;
  chunks_ = (window + kChunk - 1) / kChunk;
  runs_.assign(lists * chunks_, 0);
  if (kept_.size() < chunks_) kept_.resize(chunks_);
  const auto walkChunk = [&](std::uint32_t chunk, std::vector<std::uint16_t>& to, std::size_t mostKept) {
    Chunk filled(to, runs_.data() + chunk, chunks_, mostKept);
    walk(first + chunk * kChunk, first + std::min((chunk + 1) * kChunk, window), filled);
    kept_[chunk].size = filled.size_;
    kept_[chunk].entries = filled.entries_;
  };
  const std::size_t mostKept = maxBytes / 4 / (sizeof(std::uint16_t) * std::max(chunks_, 1u));
  tbb::parallel_for(std::uint32_t(0), chunks_, [&](std::uint32_t chunk) {
    std::vector<std::uint16_t>& walked = walked_.local();
    walkChunk(chunk, walked, mostKept);
    Kept& kept = kept_[chunk];
    // No more capacity than what it takes, unlike that of a vector that has grown.
    if (kept.size <= mostKept) kept.runs.assign(walked.begin(), walked.end());
  });
  taken_ = chunksWithin(maxBytes / 2);
  tbb::parallel_for(std::uint32_t(0), taken_, [&](std::uint32_t chunk) {
    Kept& kept = kept_[chunk];
    if (kept.size <= mostKept) return;
    kept.runs.reserve(kept.size);
    walkChunk(chunk, kept.runs, kept.size);
  });
  lastTaken_ = std::min(window, taken_ * kChunk);
  return lastTaken_;
}

/// Photons to walk at once: where their lists begin takes half of the bytes at most; and not many more than
/// the last time were taken.
std::uint32_t ChunkLists::windowWithin(std::size_t lists, std::uint64_t maxBytes) const {
  const std::uint64_t chunks = maxBytes / (2 * sizeof(std::uint32_t) * std::max<std::uint64_t>(lists, 1));
  const std::uint64_t most = std::clamp<std::uint64_t>(chunks, 1, 1u << 20) * kChunk;
  return std::uint32_t(lastTaken_ == 0 ? most : std::min<std::uint64_t>(most, 2 * std::uint64_t(lastTaken_)));
}

/// How many chunks' entries the bytes hold; adds up these.
std::uint32_t ChunkLists::chunksWithin(std::uint64_t maxBytes) {
  std::uint64_t bytes = 0;
  entries_ = 0;
  for (std::uint32_t chunk = 0; chunk < chunks_; ++chunk) {
    bytes += kept_[chunk].size * sizeof(std::uint16_t);
    if (chunk > 0 && bytes > maxBytes) return chunk;
    entries_ += kept_[chunk].entries;
  }
  return chunks_;
}

std::uint64_t ChunkLists::bytes() const {
  std::uint64_t bytes = kept_.capacity() * sizeof(Kept) + runs_.capacity() * sizeof(std::uint32_t);
  for (const Kept& kept : kept_) bytes += kept.runs.capacity() * sizeof(std::uint16_t);
  return bytes;
}

}  // namespace isophote::view_clusters

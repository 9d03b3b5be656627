// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/photon_bins.h"

#include "base/error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace isophote::photon_volumes {
namespace {

constexpr std::uint32_t kChunkPhotons = 512;
constexpr std::uint64_t kLargestBins = std::uint64_t(256) << 20;  ///< [bytes]
constexpr std::uint64_t kBudgetShare = 8;  ///< Bins take at most this part of the budget.

}  // namespace

void makeVolumes(const PhotonMap& map, float radius, const PhotonVolumesSettings& settings,
                 std::vector<PhotonVolume>& volumes) {
  volumes.resize(map.photons.size());
  if (volumes.empty()) return;
  if (!(radius > 0.0f) || !std::isfinite(radius))
    failUsage("photon_volumes.radius", "the radius is {} m; it must be a positive number", radius);
  const auto range = tbb::blocked_range<std::size_t>(0, volumes.size(), 4096);
  tbb::parallel_for(range, [&](const tbb::blocked_range<std::size_t>& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      const Photon& photon = map.photons[i];
      const float r = photonRadius(photon.pathDensity, radius, settings.densityReference,
                                   settings.radiusMin * radius, settings.radiusMax * radius);
      volumes[i] = photonVolume(photon, uint(settings.kernel), r, settings.flatness);
    }
  });
}

std::uint32_t PhotonBins::photonsWithin(std::uint64_t budget, std::size_t blocks) {
  const std::uint64_t bytes = std::min(kLargestBins, budget / kBudgetShare);
  // A photon in every block takes one entry a block in its chunk and one in the result.
  const std::uint64_t worst = 2 * sizeof(std::uint32_t) * std::max<std::uint64_t>(blocks, 1);
  return std::uint32_t(std::clamp<std::uint64_t>(bytes / worst, 1, 1u << 30));
}

void PhotonBins::build(const TileBlocks& blocks, std::span<const PhotonVolume> volumes, std::uint32_t first,
                       std::uint32_t count, TouchFn touch) {
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
      blocks.forEachTouched(volumes[first + i], touch, [&](std::size_t block) {
        chunk.blocks.push_back(std::uint32_t(block));
        ++chunk.offsets[block];
      });
      chunk.counts.push_back(std::uint32_t(chunk.blocks.size() - before));
    }
  });
  begin_.assign(blocks.size() + 1, 0);
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    std::uint32_t photons = 0;
    for (Chunk& chunk : chunks_) photons += std::exchange(chunk.offsets[block], photons);
    begin_[block + 1] = begin_[block] + photons;
  }
  photons_.resize(begin_.back());
  scatter(first);
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

void BlockLists::build(const BoundsNode& bounds, std::span<const PhotonVolume> volumes,
                       std::span<const std::uint32_t> photons, TouchFn touch) {
  volumes_.resize(photons.size());
  masks_.resize(photons.size());
  begin_.fill(0);
  for (std::size_t i = 0; i < photons.size(); ++i) {
    volumes_[i] = volumes[photons[i]];
    touch(bounds, volumes_[i], masks_[i]);
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

}  // namespace isophote::photon_volumes

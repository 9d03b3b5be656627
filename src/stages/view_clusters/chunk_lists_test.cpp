// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/view_clusters/chunk_lists.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <vector>

namespace isophote::view_clusters {
namespace {

constexpr std::uint32_t kPhotons = 20'001;
constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 30;

using Lists = std::vector<std::vector<std::uint32_t>>;

/// Photon i is on every list whose number plus `shift` divides i; list 0 stays empty.
bool isOn(std::size_t list, std::uint32_t photon, std::uint32_t shift) {
  return list > 0 && photon % (std::uint32_t(list) + shift) == 0;
}

std::uint32_t build(ChunkLists& lists, std::uint32_t first, std::size_t count, std::uint64_t maxBytes,
                    std::uint32_t shift = 0) {
  return lists.build(first, kPhotons, count, maxBytes,
                     [&](std::uint32_t begin, std::uint32_t end, ChunkLists::Chunk& chunk) {
                       std::vector<std::uint32_t> places;
                       for (std::size_t list = count; list-- > 0;) {
                         places.clear();
                         for (std::uint32_t photon = begin; photon < end; ++photon)
                           if (isOn(list, photon, shift)) places.push_back(photon - begin);
                         chunk.put(list, places);
                       }
                     });
}

/// Adds to `to`, and returns how many photons the lists hold.
std::size_t read(const ChunkLists& lists, std::size_t most, Lists& to) {
  std::size_t entries = 0;
  std::vector<std::uint32_t> memory;
  for (std::size_t list = 0; list < to.size(); ++list) {
    bool last = false;
    lists.forEachPart(list, most, memory, [&](std::span<const std::uint32_t> photons) {
      EXPECT_FALSE(last) << "only the last part is not full";
      last = photons.size() < most;
      to[list].insert(to[list].end(), photons.begin(), photons.end());
      entries += photons.size();
    });
  }
  return entries;
}

Lists expected(std::size_t count, std::uint32_t shift = 0) {
  Lists lists(count);
  for (std::size_t list = 0; list < count; ++list)
    for (std::uint32_t photon = 0; photon < kPhotons; ++photon)
      if (isOn(list, photon, shift)) lists[list].push_back(photon);
  return lists;
}

TEST(ChunkLists, HoldWhatWasPutOnThem) {
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, threads);
    for (const std::size_t most : {1, 100, 4096, 100'000}) {
      ChunkLists lists;
      EXPECT_EQ(build(lists, 0, 9, kNoLimit), kPhotons);
      Lists got(9);
      EXPECT_EQ(read(lists, most, got), lists.entries());
      EXPECT_EQ(got, expected(9));
    }
  }
}

TEST(ChunkLists, TakeAsManyPhotonsAsTheBytesHold) {
  ChunkLists lists;
  constexpr std::uint64_t kBytes = 16 * 1024;
  Lists got(9);
  std::uint32_t first = 0, passes = 0;
  for (; first < kPhotons; ++passes) {
    first += build(lists, first, got.size(), kBytes);
    read(lists, 4096, got);
    EXPECT_LE(lists.bytes(), 2 * kBytes);
  }
  EXPECT_EQ(first, kPhotons);
  EXPECT_GT(passes, 4u);
  EXPECT_EQ(got, expected(9));
}

TEST(ChunkLists, TakeOneChunkHoweverFewTheBytes) {
  ChunkLists lists;
  Lists got(9);
  std::uint32_t passes = 0;
  for (std::uint32_t first = 0; first < kPhotons; ++passes) {
    first += build(lists, first, got.size(), 1);
    read(lists, 4096, got);
  }
  EXPECT_EQ(passes, (kPhotons + 511) / 512);
  EXPECT_EQ(got, expected(9));
}

// Beside the entries there is where each list begins in each chunk, and how many places it has there.
TEST(ChunkLists, TakeTwoBytesAnEntry) {
  ChunkLists lists;
  build(lists, 0, 9, kNoLimit);
  const std::uint64_t chunks = (kPhotons + 511) / 512;
  EXPECT_LE(lists.bytes(), 2 * lists.entries() + chunks * (9 * (4 + 2) + 64));
}

TEST(ChunkLists, RememberNothingAndTakeNoMoreMemoryTheNextTime) {
  ChunkLists lists;
  build(lists, 0, 9, kNoLimit);
  const std::uint64_t bytes = lists.bytes();
  build(lists, 0, 7, kNoLimit, 3);
  Lists got(7);
  read(lists, 4096, got);
  EXPECT_EQ(got, expected(7, 3));
  build(lists, 0, 9, kNoLimit);
  EXPECT_EQ(lists.bytes(), bytes);
}

}  // namespace
}  // namespace isophote::view_clusters

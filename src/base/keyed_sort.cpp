// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/keyed_sort.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace isophote {

namespace {
/// Longest digit of a pass: its 4096 counters fit the first cache.
constexpr std::uint32_t kMostDigitBits = 12;
constexpr std::size_t kChunk = 16'384;
}  // namespace

/// Moves things to their places by one digit of the key. Each chunk of `from` has places of its own for each
/// digit, behind those of the chunks before it.
void KeyedSort::pass(std::uint32_t shift, std::uint32_t digitBits, const LargeVector<KeyedIndex>& from,
                     LargeVector<KeyedIndex>& to) {
  const std::size_t digits = std::size_t(1) << digitBits, chunks = (from.size() + kChunk - 1) / kChunk;
  const auto digitOf = [=](const KeyedIndex& thing) {
    return thing.key >> shift & std::uint32_t(digits - 1);
  };
  const auto end = [&](std::size_t chunk) { return std::min((chunk + 1) * kChunk, from.size()); };
  places_.assign(chunks * digits, 0);
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    std::uint32_t* counts = &places_[chunk * digits];
    for (std::size_t i = chunk * kChunk; i < end(chunk); ++i) ++counts[digitOf(from[i])];
  });
  std::uint32_t before = 0;
  for (std::size_t digit = 0; digit < digits; ++digit)
    for (std::size_t chunk = 0; chunk < chunks; ++chunk)
      before += std::exchange(places_[chunk * digits + digit], before);
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    std::uint32_t* places = &places_[chunk * digits];
    for (std::size_t i = chunk * kChunk; i < end(chunk); ++i) to[places[digitOf(from[i])]++] = from[i];
  });
}

void KeyedSort::sort(LargeVector<KeyedIndex>& things, std::uint32_t keyBits) {
  other_.resize(things.size());
  const std::uint32_t passes = (keyBits + kMostDigitBits - 1) / kMostDigitBits;
  const std::uint32_t digitBits = (keyBits + passes - 1) / passes;
  for (std::uint32_t i = 0; i < passes; ++i) {
    pass(i * digitBits, digitBits, things, other_);
    std::swap(things, other_);
  }
}

}  // namespace isophote

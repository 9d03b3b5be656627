// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/large_pages.h"

#include <cstdint>
#include <vector>

namespace isophote {

/// A key to sort by, and the index of what it belongs to.
struct KeyedIndex {
  std::uint32_t key;
  std::uint32_t index;
};

/// Sorts by key, stably, by its digits, on all threads; keeps its memory for the next time.
class KeyedSort {
 public:
  /// All keys are below 2^keyBits.
  void sort(LargeVector<KeyedIndex>& things, std::uint32_t keyBits);

 private:
  void pass(std::uint32_t shift, std::uint32_t digitBits, const LargeVector<KeyedIndex>& from,
            LargeVector<KeyedIndex>& to);

  LargeVector<KeyedIndex> other_;
  std::vector<std::uint32_t> places_;  ///< By chunk, then digit.
};

}  // namespace isophote

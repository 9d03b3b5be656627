// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace isophote {

/// What a processor has under way without standing still, with room for others' requests.
inline constexpr std::uint32_t kAskedAtOnce = 12;

/// Memory that will be read soon, asked for a little at a time between other work: a processor has a dozen or
/// so requests under way at once and stands still at the next. Of more than kMost unasked ones the oldest are
/// forgotten.
class PrefetchQueue {
 public:
  void want(const void* address) { wanted_[end_++ % kMost] = address; }

  /// Asks for up to `count`. Always inlined: GCC 12 takes a function that only prefetches for one without
  /// effect and drops the call.
  inline __attribute__((always_inline)) void ask(std::uint32_t count) {
    if (end_ - begin_ > kMost) begin_ = end_ - kMost;
    for (; count > 0 && begin_ != end_; --count) __builtin_prefetch(wanted_[begin_++ % kMost]);
  }

 private:
  static constexpr std::uint32_t kMost = 256;
  std::array<const void*, kMost> wanted_;
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/large_pages.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <numeric>

namespace isophote {
namespace {

TEST(LargePages, AlignsToWhatIsAskedFor) {
  for (const std::size_t bytes : {std::size_t(1), std::size_t(100), (std::size_t(2) << 20) - 1,
                                  std::size_t(2) << 20, (std::size_t(5) << 20) + 3}) {
    LargeVector<std::uint8_t> memory(bytes, 7);
    const std::size_t alignment = bytes < std::size_t(2) << 20 ? 64 : std::size_t(2) << 20;
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory.data()) % alignment, 0u) << bytes;
    EXPECT_EQ(std::accumulate(memory.begin(), memory.end(), std::size_t(0)), 7 * bytes);
  }
}

TEST(LargePages, RefusesWhatNoMachineHas) {
  EXPECT_THROW(allocateLarge(std::numeric_limits<std::size_t>::max() - 1), std::bad_alloc);
  EXPECT_THROW(LargePageAllocator<std::uint64_t>().allocate(std::size_t(1) << 62), std::bad_array_new_length);
}

}  // namespace
}  // namespace isophote

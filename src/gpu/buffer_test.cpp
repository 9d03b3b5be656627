// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/buffer.h"

#include "support/gpu_test.h"

#include <numeric>

namespace isophote {
namespace {

class GpuBuffer : public GpuTest {
 protected:
  static std::vector<std::uint32_t> countUp(std::size_t count) {
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0u);
    return numbers;
  }
};

TEST_F(GpuBuffer, ReturnsWhatWasUploaded) {
  const std::vector<std::uint32_t> numbers = countUp(1000);
  for (const BufferPlace place : {BufferPlace::kDevice, BufferPlace::kHost}) {
    GpuArray<std::uint32_t> array(device(), "buffer_test.numbers", numbers, place);
    EXPECT_EQ(array.download(), numbers);
    array.upload(std::vector<std::uint32_t>{7, 8}, 998);
    EXPECT_EQ(array.download()[997], 997u);
    EXPECT_EQ(array.download()[999], 8u);
  }
}

TEST_F(GpuBuffer, IsCopiedInPiecesWhenLarge) {
  // Two whole pieces of 32 MiB and a bit.
  const std::vector<std::uint32_t> numbers = countUp((std::size_t(64) << 20) / sizeof(std::uint32_t) + 5);
  if (numbers.size() * sizeof(std::uint32_t) > device().facts().maxStorageBufferBytes)
    GTEST_SKIP() << device().facts().name << " has smaller buffers";
  EXPECT_TRUE(GpuArray<std::uint32_t>(device(), "buffer_test.large", numbers).download() == numbers);
}

TEST_F(GpuBuffer, MayBeEmpty) {
  const GpuArray<std::uint32_t> none(device(), "buffer_test.none", std::size_t(0));
  EXPECT_EQ(none.size(), 0u);
  EXPECT_TRUE(none.download().empty());
}

TEST_F(GpuBuffer, MovesWithItsContents) {
  const std::vector<std::uint32_t> numbers = countUp(10);
  GpuArray<std::uint32_t> array(device(), "buffer_test.first", numbers);
  GpuArray<std::uint32_t> moved = std::move(array);
  EXPECT_EQ(moved.download(), numbers);
  moved = GpuArray<std::uint32_t>(device(), "buffer_test.second", countUp(3));
  EXPECT_EQ(moved.download(), countUp(3));
}

TEST_F(GpuBuffer, RefusesWhatLiesOutside) {
  GpuArray<std::uint32_t> array(device(), "buffer_test.small", countUp(10));
  EXPECT_THROW(array.upload(countUp(2), 9), Error);
  EXPECT_THROW(array.upload(countUp(1), ~std::size_t(0) / 4), Error);
}

TEST_F(GpuBuffer, NamesTheBufferThatIsTooLarge) {
  try {
    const Buffer huge(device(), "buffer_test.huge", std::uint64_t(1) << 60);
    FAIL() << "allocated an exbibyte";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDevice);
    EXPECT_EQ(error.subject(), "buffer_test.huge");
  }
}

}  // namespace
}  // namespace isophote

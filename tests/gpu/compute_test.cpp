// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/command_list.h"
#include "shaders/scale_and_add.h"
#include "support/gpu_test.h"

namespace isophote {
namespace {

constexpr std::uint32_t kBindNumbers = 0;
constexpr std::uint32_t kSpecFactor = 0;

class Compute : public GpuTest {
 protected:
  std::vector<std::uint32_t> run(CommandList& list, const GpuArray<std::uint32_t>& numbers) {
    times_ = list.submitAndWait();
    return numbers.download();
  }
  std::vector<ScopeTime> times_;
};

TEST_F(Compute, ReadsTheInterfaceOfAShader) {
  const ComputePipeline pipeline(device(), "compute_test", shaders::scale_and_add);
  const SpirvInterface& interface = pipeline.shaderInterface();
  EXPECT_EQ(interface.workgroupSize, (std::array<std::uint32_t, 3>{32, 1, 1}));
  EXPECT_FALSE(interface.pushConstants);
  ASSERT_EQ(interface.bindings.size(), 1u);
  EXPECT_EQ(interface.bindings[0].binding, kBindNumbers);
  EXPECT_EQ(interface.bindings[0].name, "Numbers");
  EXPECT_EQ(interface.bindings[0].kind, SpirvBindingKind::kStorageBuffer);
}

TEST_F(Compute, RunsInOrderAcrossBarriers) {
  const ComputePipeline add(device(), "compute_test.add", shaders::scale_and_add);
  const ComputePipeline triple(device(), "compute_test.triple", shaders::scale_and_add, {{kSpecFactor, 3}});
  GpuArray<std::uint32_t> numbers(device(), "compute_test.numbers", std::size_t(100));
  CommandList list(device(), "compute_test");
  list.fill(numbers, 5);
  list.barrier();
  for (const ComputePipeline* pipeline : {&add, &triple}) {
    list.use(*pipeline);
    list.bind(kBindNumbers, numbers);
    list.dispatchItems(numbers.size());
    list.barrier();
  }
  EXPECT_EQ(run(list, numbers), std::vector<std::uint32_t>(100, (5 + 1) * 3 + 1));
}

TEST_F(Compute, TakesMoreDispatchesThanOneDescriptorPoolHolds) {
  const ComputePipeline add(device(), "compute_test.add", shaders::scale_and_add);
  GpuArray<std::uint32_t> numbers(device(), "compute_test.numbers", std::size_t(3));
  CommandList list(device(), "compute_test");
  list.fill(numbers, 0);
  list.use(add);
  list.bind(kBindNumbers, numbers);
  for (int i = 0; i < 100; ++i) {
    list.barrier();
    list.dispatch({1, 1, 1});
  }
  EXPECT_EQ(run(list, numbers), std::vector<std::uint32_t>(3, 100));
}

TEST_F(Compute, SeesWhatEarlierListsWrote) {
  const ComputePipeline add(device(), "compute_test.add", shaders::scale_and_add);
  const GpuArray<std::uint32_t> numbers(device(), "compute_test.numbers",
                                        std::vector<std::uint32_t>{1, 2, 3});
  for (int i = 0; i < 2; ++i) {
    CommandList list(device(), "compute_test");
    list.use(add);
    list.bind(kBindNumbers, numbers);
    list.dispatchItems(numbers.size());
    list.submitAndWait();
  }
  EXPECT_EQ(numbers.download(), (std::vector<std::uint32_t>{3, 4, 5}));
}

TEST_F(Compute, TimesItsScopes) {
  const ComputePipeline add(device(), "compute_test.add", shaders::scale_and_add);
  GpuArray<std::uint32_t> numbers(device(), "compute_test.numbers", std::size_t(1) << 20);
  CommandList list(device(), "compute_test");
  {
    const auto whole = list.scope("compute_test.whole");
    list.fill(numbers, 0);
    list.barrier();
    const auto part = list.scope("compute_test.part");
    list.use(add);
    list.bind(kBindNumbers, numbers);
    list.dispatchItems(numbers.size());
  }
  run(list, numbers);
  ASSERT_EQ(times_.size(), 2u);
  EXPECT_EQ(times_[0].name, "compute_test.whole");
  EXPECT_EQ(times_[1].name, "compute_test.part");
  if (device().facts().timestampNanoseconds > 0) {
    EXPECT_GT(times_[1].milliseconds, 0.0);
    EXPECT_GE(times_[0].milliseconds, times_[1].milliseconds);
    EXPECT_LT(times_[0].milliseconds, 60e3);
  }
}

TEST_F(Compute, RefusesADispatchWithoutItsBuffers) {
  const ComputePipeline add(device(), "compute_test.add", shaders::scale_and_add);
  CommandList list(device(), "compute_test");
  EXPECT_THROW(list.dispatch({1, 1, 1}), Error);
  list.use(add);
  try {
    list.dispatch({1, 1, 1});
    FAIL() << "ran without a buffer";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nothing bound to 0 (Numbers)"), std::string::npos);
  }
  EXPECT_THROW(list.push(std::uint32_t(1)), Error);
}

TEST_F(Compute, RefusesMoreWorkgroupsThanTheDeviceRuns) {
  const ComputePipeline add(device(), "compute_test.add", shaders::scale_and_add);
  GpuArray<std::uint32_t> numbers(device(), "compute_test.numbers", std::size_t(1));
  CommandList list(device(), "compute_test");
  list.use(add);
  list.bind(kBindNumbers, numbers);
  EXPECT_THROW(list.dispatchItems(~std::uint64_t(0) - 100), Error);
}

TEST_F(Compute, ValidationCatchesAMissingBarrier) {
  const ComputePipeline add(device(), "compute_test.add", shaders::scale_and_add);
  GpuArray<std::uint32_t> numbers(device(), "compute_test.numbers", std::size_t(3));
  CommandList list(device(), "compute_test");
  list.fill(numbers, 0);
  list.use(add);
  list.bind(kBindNumbers, numbers);
  list.dispatchItems(numbers.size());
  expectValidationMessage("SYNC-HAZARD");
}

}  // namespace
}  // namespace isophote

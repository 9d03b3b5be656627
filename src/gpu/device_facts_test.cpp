// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_facts.h"

#include <gtest/gtest.h>

namespace isophote {
namespace {

DeviceFacts capable(std::string name, DeviceType type) {
  DeviceFacts facts;
  facts.name = std::move(name);
  facts.type = type;
  facts.version = {1, 3, 230};
  facts.scalarBlockLayout = facts.synchronization2 = facts.maintenance4 = facts.computeQueue = true;
  facts.maxWorkgroupInvocations = 1024;
  facts.maxStorageBuffers = 32;
  return facts;
}

DeviceOptions withSoftware() {
  DeviceOptions options;
  options.allowSoftware = true;
  return options;
}

TEST(RankDevices, PutsRealHardwareFirst) {
  const std::vector<DeviceFacts> devices{
      capable("llvmpipe", DeviceType::kSoftware), capable("laptop", DeviceType::kIntegrated),
      capable("guest", DeviceType::kVirtual), capable("workstation", DeviceType::kDiscrete)};
  EXPECT_EQ(rankDevices(devices, withSoftware()).usable, (std::vector<std::size_t>{3, 1, 2, 0}));
}

TEST(RankDevices, PrefersRayTracingThenMemoryThenTheLoadersOrder) {
  std::vector<DeviceFacts> devices(4, capable("card", DeviceType::kDiscrete));
  devices[1].deviceMemoryBytes = 1 << 20;
  devices[2].deviceMemoryBytes = 1 << 20;
  devices[3].hasRayQuery = true;
  EXPECT_EQ(rankDevices(devices).usable, (std::vector<std::size_t>{3, 1, 2, 0}));
}

TEST(RankDevices, SaysWhatADeviceLacks) {
  std::vector<DeviceFacts> devices{capable("llvmpipe", DeviceType::kSoftware),
                                   capable("phone", DeviceType::kIntegrated),
                                   capable("old card", DeviceType::kDiscrete)};
  devices[0].scalarBlockLayout = false;
  devices[1].maxStorageBuffers = 4;
  devices[1].synchronization2 = false;
  devices[2] = DeviceFacts{};
  devices[2].name = "old card";
  devices[2].version = {1, 1, 70};
  const DeviceRanking ranking = rankDevices(devices, withSoftware());
  EXPECT_TRUE(ranking.usable.empty());
  EXPECT_EQ(ranking.reasons,
            (std::vector<std::string>{
                "llvmpipe lacks scalarBlockLayout",
                "phone lacks synchronization2 and offers 4 storage buffers a shader (12 are needed)",
                "old card supports Vulkan 1.1 (1.3 is needed)"}));
}

TEST(RankDevices, TakesSoftwareOnlyOnRequest) {
  const std::vector<DeviceFacts> devices{capable("llvmpipe", DeviceType::kSoftware)};
  EXPECT_TRUE(whyUnusable(devices[0]).empty());
  const DeviceRanking ranking = rankDevices(devices);
  EXPECT_TRUE(ranking.usable.empty());
  EXPECT_EQ(ranking.reasons,
            (std::vector<std::string>{"llvmpipe computes in software, which is used only on request"}));
  EXPECT_EQ(rankDevices(devices, withSoftware()).usable, std::vector<std::size_t>{0});
}

TEST(RankDevices, FindsThePreferredNameInAnyCase) {
  const std::vector<DeviceFacts> devices{capable("Fast Card", DeviceType::kDiscrete),
                                         capable("Slow Card", DeviceType::kIntegrated)};
  DeviceOptions options;
  options.preferredName = "slow";
  const DeviceRanking ranking = rankDevices(devices, options);
  EXPECT_EQ(ranking.usable, std::vector<std::size_t>{1});
  EXPECT_EQ(ranking.reasons, (std::vector<std::string>{"Fast Card is not the \"slow\" asked for"}));
}

TEST(RankDevices, OfNothingIsNothing) {
  const DeviceRanking ranking = rankDevices({});
  EXPECT_TRUE(ranking.usable.empty());
  EXPECT_TRUE(ranking.reasons.empty());
}

}  // namespace
}  // namespace isophote

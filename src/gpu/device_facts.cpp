// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_facts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <tuple>

namespace isophote {

namespace {
constexpr VulkanVersion kMinVersion{1, 3, 0};
constexpr std::uint32_t kMinWorkgroupInvocations = 256;
constexpr std::uint32_t kMinStorageBuffers = 12;

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return lower;
}

std::string whyExcluded(const DeviceFacts& device, const DeviceOptions& options) {
  if (lowerCase(device.name).find(lowerCase(options.preferredName)) == std::string::npos)
    return fmt::format("is not the \"{}\" asked for", options.preferredName);
  if (std::string why = whyUnusable(device); !why.empty()) return why;
  if (device.type == DeviceType::kSoftware && !options.allowSoftware)
    return "computes in software, which is used only on request";
  return {};
}
}  // namespace

std::string_view name(DeviceType type) {
  switch (type) {
    case DeviceType::kDiscrete:
      return "discrete GPU";
    case DeviceType::kIntegrated:
      return "integrated GPU";
    case DeviceType::kVirtual:
      return "virtual GPU";
    case DeviceType::kSoftware:
      return "software";
    case DeviceType::kOther:
      break;
  }
  return "other device";
}

std::string whyUnusable(const DeviceFacts& device) {
  // Nothing else is known of an older device.
  if (device.version < kMinVersion)
    return fmt::format("supports Vulkan {}.{} ({}.{} is needed)", device.version.major, device.version.minor,
                       kMinVersion.major, kMinVersion.minor);
  std::vector<std::string> reasons;
  if (!device.computeQueue) reasons.emplace_back("has no compute queue");
  if (!device.scalarBlockLayout) reasons.emplace_back("lacks scalarBlockLayout");
  if (!device.synchronization2) reasons.emplace_back("lacks synchronization2");
  if (!device.maintenance4) reasons.emplace_back("lacks maintenance4");
  if (device.maxWorkgroupInvocations < kMinWorkgroupInvocations)
    reasons.push_back(fmt::format("offers {} invocations a workgroup ({} are needed)",
                                  device.maxWorkgroupInvocations, kMinWorkgroupInvocations));
  if (device.maxStorageBuffers < kMinStorageBuffers)
    reasons.push_back(fmt::format("offers {} storage buffers a shader ({} are needed)",
                                  device.maxStorageBuffers, kMinStorageBuffers));
  return fmt::format("{}", fmt::join(reasons, " and "));
}

DeviceRanking rankDevices(std::span<const DeviceFacts> devices, const DeviceOptions& options) {
  DeviceRanking ranking;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const std::string why = whyExcluded(devices[i], options);
    if (why.empty())
      ranking.usable.push_back(i);
    else
      ranking.reasons.push_back(fmt::format("{} {}", devices[i].name, why));
  }
  std::ranges::stable_sort(ranking.usable, {}, [&](std::size_t i) {
    const DeviceFacts& d = devices[i];
    // DeviceType is declared from best to worst; the other keys are negated for "larger is better".
    return std::make_tuple(d.type, !d.hasRayQuery, ~d.deviceMemoryBytes);
  });
  return ranking;
}

}  // namespace isophote

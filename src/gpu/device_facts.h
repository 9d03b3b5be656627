// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

enum class DeviceType { kDiscrete, kIntegrated, kVirtual, kOther, kSoftware };

/// "discrete GPU", "software" ...
std::string_view name(DeviceType type);

/// A Vulkan version as the API packs it, without the variant.
struct VulkanVersion {
  std::uint32_t major = 0;
  std::uint32_t minor = 0;
  std::uint32_t patch = 0;
  auto operator<=>(const VulkanVersion&) const = default;
};

/// Everything that decides whether a device can run the Vulkan engine, and how well. Plain data: tests make
/// it up. Below Vulkan 1.3 only name, type and version are asked for.
struct DeviceFacts {
  std::string name;    ///< "NVIDIA H100", "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string driver;  ///< "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)".
  DeviceType type = DeviceType::kOther;
  VulkanVersion version;
  // What the engine needs.
  bool scalarBlockLayout = false;  ///< Structs lie in buffers as C++ lays them out.
  bool synchronization2 = false;
  bool maintenance4 = false;
  bool computeQueue = false;  ///< Some queue family takes compute and transfer work.
  std::uint32_t maxWorkgroupInvocations = 0;
  std::uint32_t maxStorageBuffers = 0;  ///< Per shader stage.
  // What it adapts to.
  bool graphicsQueue = false;                ///< The same family also rasterises.
  bool hasRayQuery = false;                  ///< VK_KHR_ray_query, in hardware.
  std::uint32_t subgroupSize = 0;            ///< For information; no shader depends on it.
  std::uint32_t sharedMemoryBytes = 0;       ///< Per workgroup.
  std::array<std::uint32_t, 3> maxGroups{};  ///< Of one dispatch.
  std::uint64_t maxStorageBufferBytes = 0;   ///< The largest range that one binding sees.
  std::uint64_t deviceMemoryBytes = 0;       ///< The largest device-local heap.
  double timestampNanoseconds = 0;           ///< Of one tick of the GPU's clock; 0: it has none.
};

/// What a caller asks of the device that it gets.
struct DeviceOptions {
  /// Turns the validation layers on (with synchronisation validation) and collects what they say; fails where
  /// they are not installed.
  bool validation = false;
  /// Part of the device's name, in any case; empty: the best one.
  std::string preferredName;
  /// Also takes a software device, which is slower than the CPU engine but computes the same.
  bool allowSoftware = false;
};

/// Why the Vulkan engine cannot run on the device, as the end of a sentence ("lacks scalarBlockLayout and
/// offers 4 storage buffers a shader (12 are needed)"); empty where it can.
std::string whyUnusable(const DeviceFacts& device);

struct DeviceRanking {
  std::vector<std::size_t> usable;   ///< Indices of the devices to try, the best first.
  std::vector<std::string> reasons;  ///< One sentence for each of the others, in their order.
};

/// Orders devices by type (discrete, integrated, virtual, other, software), then ray tracing hardware, then
/// memory; ties keep the loader's order. Leaves out what cannot run or what `options` exclude, and says why.
DeviceRanking rankDevices(std::span<const DeviceFacts> devices, const DeviceOptions& options = {});

}  // namespace isophote

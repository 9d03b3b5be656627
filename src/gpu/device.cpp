// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/device.h"

#include <fmt/ranges.h>

namespace isophote {

namespace {
std::vector<DeviceFacts> factsOf(const VulkanInstance& instance) {
  std::vector<DeviceFacts> facts;
  for (const PhysicalDevice& device : instance.devices()) facts.push_back(device.facts);
  return facts;
}

const PhysicalDevice& chosenDevice(const VulkanInstance& instance, const DeviceOptions& options) {
  const std::vector<DeviceFacts> facts = factsOf(instance);
  const DeviceRanking ranking = rankDevices(facts, options);
  if (facts.empty()) fail(ErrorKind::kDevice, "", "no usable GPU: the Vulkan drivers found no device");
  if (ranking.usable.empty())
    fail(ErrorKind::kDevice, "", "no usable GPU: {}", fmt::join(ranking.reasons, "; "));
  return instance.devices()[ranking.usable.front()];
}

VkDevice createDevice(const InstanceTable& functions, const PhysicalDevice& physical) {
  auto features13 =
      vkStruct<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  features13.synchronization2 = VK_TRUE;
  features13.maintenance4 = VK_TRUE;
  auto features12 = vkStruct<VkPhysicalDeviceVulkan12Features>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &features13);
  features12.scalarBlockLayout = VK_TRUE;

  const float priority = 1.0f;
  auto queue = vkStruct<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = physical.queueFamily;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto info = vkStruct<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features12);
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  VkDevice device = VK_NULL_HANDLE;
  checkVk(functions.createDevice(physical.handle, &info, nullptr, &device), "open {}", physical.facts.name);
  return device;
}

/// volk reads one global pointer while it fills a table; it is set here, under a lock, and used nowhere else.
void loadTable(VolkDeviceTable& table, const InstanceTable& functions, VkDevice device) {
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  vkGetDeviceProcAddr = functions.getDeviceProcAddr;
  volkLoadDeviceTable(&table, device);
}
}  // namespace

std::vector<DeviceFacts> listDevices(std::string& whyNone) {
  whyNone.clear();
  try {
    std::vector<DeviceFacts> facts = factsOf(VulkanInstance(false));
    if (facts.empty()) whyNone = "the Vulkan drivers found no device";
    return facts;
  } catch (const Error& error) {
    whyNone = error.what();
    return {};
  }
}

GpuDevice::GpuDevice(const DeviceOptions& options)
    : instance_(std::make_unique<VulkanInstance>(options.validation)),
      log_(instance_->validationLog()),
      physical_(chosenDevice(*instance_, options)) {
  const InstanceTable& functions = instance_->functions();
  functions.getPhysicalDeviceMemoryProperties(physical_.handle, &memory_);
  handle_ = createDevice(functions, physical_);
  loadTable(table_, functions, handle_);
  table_.vkGetDeviceQueue(handle_, physical_.queueFamily, 0, &queue_);
}

GpuDevice::~GpuDevice() { table_.vkDestroyDevice(handle_, nullptr); }

std::uint32_t GpuDevice::memoryType(std::uint32_t allowed, VkMemoryPropertyFlags required,
                                    VkMemoryPropertyFlags wished) const {
  for (const VkMemoryPropertyFlags flags : {required | wished, required})
    for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
      if ((allowed >> i & 1u) && (memory_.memoryTypes[i].propertyFlags & flags) == flags) return i;
  fail(ErrorKind::kDevice, "", "{} has no memory with properties {:#x}", facts().name, required);
}

void GpuDevice::submitAndWait(VkCommandBuffer commands, VkFence fence, std::string_view name) {
  auto buffer = vkStruct<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  buffer.commandBuffer = commands;
  auto submit = vkStruct<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer;
  {
    const std::scoped_lock lock(queueMutex_);
    checkVk(table_.vkQueueSubmit2(queue_, 1, &submit, fence), "submit {}", name);
  }
  checkVk(table_.vkWaitForFences(handle_, 1, &fence, VK_TRUE, UINT64_MAX), "finish {}", name);
}

void GpuDevice::beginLabel(VkCommandBuffer commands, const std::string& label) const {
  const auto begin = instance_->functions().cmdBeginDebugUtilsLabel;
  if (!begin) return;
  auto info = vkStruct<VkDebugUtilsLabelEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT);
  info.pLabelName = label.c_str();
  begin(commands, &info);
}

void GpuDevice::endLabel(VkCommandBuffer commands) const {
  if (const auto end = instance_->functions().cmdEndDebugUtilsLabel) end(commands);
}

void GpuDevice::setName(VkObjectType type, std::uint64_t handle, std::string_view name) const {
  const auto setObjectName = instance_->functions().setDebugUtilsObjectName;
  if (!setObjectName) return;
  const std::string text(name);
  auto info = vkStruct<VkDebugUtilsObjectNameInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT);
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = text.c_str();
  checkVk(setObjectName(handle_, &info), "name {}", text);
}

}  // namespace isophote

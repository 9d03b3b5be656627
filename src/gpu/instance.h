// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/device_facts.h"
#include "gpu/vulkan.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace isophote {

/// The instance's own function table: volk's global pointers stay unset, so that devices share nothing but
/// the loader.
struct InstanceTable {
  PFN_vkDestroyInstance destroyInstance = nullptr;
  PFN_vkEnumeratePhysicalDevices enumeratePhysicalDevices = nullptr;
  PFN_vkGetPhysicalDeviceProperties getPhysicalDeviceProperties = nullptr;
  PFN_vkGetPhysicalDeviceProperties2 getPhysicalDeviceProperties2 = nullptr;
  PFN_vkGetPhysicalDeviceFeatures2 getPhysicalDeviceFeatures2 = nullptr;
  PFN_vkGetPhysicalDeviceMemoryProperties getPhysicalDeviceMemoryProperties = nullptr;
  PFN_vkGetPhysicalDeviceQueueFamilyProperties getPhysicalDeviceQueueFamilyProperties = nullptr;
  PFN_vkEnumerateDeviceExtensionProperties enumerateDeviceExtensionProperties = nullptr;
  PFN_vkCreateDevice createDevice = nullptr;
  PFN_vkGetDeviceProcAddr getDeviceProcAddr = nullptr;
  // VK_EXT_debug_utils; null where it is absent.
  PFN_vkCreateDebugUtilsMessengerEXT createDebugUtilsMessenger = nullptr;
  PFN_vkDestroyDebugUtilsMessengerEXT destroyDebugUtilsMessenger = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT setDebugUtilsObjectName = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT cmdBeginDebugUtilsLabel = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT cmdEndDebugUtilsLabel = nullptr;
};

/// What the validation layers said. Any thread may ask; it outlives the device, whose destruction is checked
/// too.
class ValidationLog {
 public:
  void add(std::string message);
  std::vector<std::string> messages() const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};

struct PhysicalDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  DeviceFacts facts;
  std::uint32_t queueFamily = 0;    ///< Takes compute work, and graphics where facts.graphicsQueue.
  std::uint64_t timestampMask = 0;  ///< The bits of a timestamp that count.
};

/// The connection to the Vulkan loader and what it found. Throws Error(kDevice) with the reason where there
/// is no loader or no driver.
class VulkanInstance {
 public:
  explicit VulkanInstance(bool validation);
  VulkanInstance(const VulkanInstance&) = delete;
  VulkanInstance& operator=(const VulkanInstance&) = delete;
  ~VulkanInstance();

  const InstanceTable& functions() const { return functions_; }
  const std::vector<PhysicalDevice>& devices() const { return devices_; }
  std::shared_ptr<const ValidationLog> validationLog() const { return log_; }

 private:
  void create(bool validation);
  void loadFunctions(bool debugUtils);
  void listen();
  void findDevices();
  void destroy();
  PhysicalDevice inspect(VkPhysicalDevice handle) const;
  void chooseQueue(PhysicalDevice& device) const;

  std::shared_ptr<ValidationLog> log_ = std::make_shared<ValidationLog>();
  VkInstance handle_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  InstanceTable functions_;
  std::vector<PhysicalDevice> devices_;
};

}  // namespace isophote

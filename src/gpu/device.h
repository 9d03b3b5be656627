// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/device_facts.h"
#include "gpu/instance.h"
#include "gpu/vulkan.h"

#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// Every Vulkan device of this machine, usable or not (whyUnusable() tells). Where there is none, `whyNone`
/// says why.
std::vector<DeviceFacts> listDevices(std::string& whyNone);

/// A Vulkan device with one queue, on its own instance: two of them share nothing but the loader. Buffers,
/// pipelines and command lists refer to it and must die first. Threads may share it.
class GpuDevice {
 public:
  /// Opens the best device that `options` allow. Throws Error(kDevice) with the reason for each that was
  /// refused.
  explicit GpuDevice(const DeviceOptions& options = {});
  GpuDevice(const GpuDevice&) = delete;
  GpuDevice& operator=(const GpuDevice&) = delete;
  ~GpuDevice();

  const DeviceFacts& facts() const { return physical_.facts; }
  /// What the validation layers have said so far; empty without DeviceOptions::validation.
  std::vector<std::string> validationMessages() const { return log_->messages(); }
  /// The same, for reading after the device is gone: what was leaked is reported last.
  std::shared_ptr<const ValidationLog> validationLog() const { return log_; }

  // For the classes of this folder.
  VkDevice handle() const { return handle_; }
  const VolkDeviceTable& vk() const { return table_; }
  const InstanceTable& instanceFunctions() const { return instance_->functions(); }
  std::uint32_t queueFamily() const { return physical_.queueFamily; }
  std::uint64_t timestampMask() const { return physical_.timestampMask; }
  /// The first memory type among `allowed` with all `required` properties, if possible one that also has
  /// `wished`.
  std::uint32_t memoryType(std::uint32_t allowed, VkMemoryPropertyFlags required,
                           VkMemoryPropertyFlags wished) const;
  /// Submits and returns once the device has finished. `name` is for messages.
  void submitAndWait(VkCommandBuffer commands, VkFence fence, std::string_view name);

  /// Takes charge of a fresh object and names it, "stage.thing".
  template <class Handle>
  Owned<Handle> own(std::string_view name, Handle handle, typename Owned<Handle>::Destroy destroy) const {
    static_assert(kObjectType<Handle> != VK_OBJECT_TYPE_UNKNOWN, "give kObjectType this handle's type");
    Owned<Handle> owned(handle_, handle, destroy);
    setName(kObjectType<Handle>, reinterpret_cast<std::uint64_t>(handle), name);
    return owned;
  }
  /// Command buffers are freed with their pool and so are only named.
  void setName(VkCommandBuffer commands, std::string_view name) const {
    setName(VK_OBJECT_TYPE_COMMAND_BUFFER, reinterpret_cast<std::uint64_t>(commands), name);
  }
  /// Labels in a debugger or profiler what is recorded between the two.
  void beginLabel(VkCommandBuffer commands, const std::string& label) const;
  void endLabel(VkCommandBuffer commands) const;

 private:
  void setName(VkObjectType type, std::uint64_t handle, std::string_view name) const;

  std::unique_ptr<VulkanInstance> instance_;
  std::shared_ptr<const ValidationLog> log_;
  PhysicalDevice physical_;
  VkPhysicalDeviceMemoryProperties memory_{};
  VkDevice handle_ = VK_NULL_HANDLE;
  VolkDeviceTable table_{};
  VkQueue queue_ = VK_NULL_HANDLE;
  std::mutex queueMutex_;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What every file of the Vulkan engine needs: the API through volk (the loader is opened at run time, so that
// the program also runs without libvulkan), checked results and owned handles.
#pragma once

#include "base/error.h"

#include <volk.h>

#include <string_view>
#include <utility>

namespace isophote {

/// "VK_ERROR_DEVICE_LOST" and the like; the number where it has no name here.
std::string resultName(VkResult result);

/// Throws Error(kDevice), in every build type, unless `result` is VK_SUCCESS:
/// checkVk(vkQueueSubmit2(...), "submit {}", name) gives "cannot submit photon_volumes:
/// VK_ERROR_DEVICE_LOST".
template <class... Args>
void checkVk(VkResult result, fmt::format_string<Args...> what, Args&&... args) {
  if (result != VK_SUCCESS)
    fail(ErrorKind::kDevice, "", "cannot {}: {}", fmt::format(what, std::forward<Args>(args)...),
         resultName(result));
}

/// A zeroed structure of the API with its type and chain.
template <class Struct>
Struct vkStruct(VkStructureType type, void* next = nullptr) {
  Struct s{};
  s.sType = type;
  s.pNext = next;
  return s;
}

/// One Vulkan object and the duty to destroy it. Only GpuDevice::own makes one, which also names it: no
/// object of ours is ever anonymous in a debugger or in a validation message.
template <class Handle>
class Owned {
 public:
  using Destroy = void(VKAPI_PTR*)(VkDevice, Handle, const VkAllocationCallbacks*);

  Owned() = default;
  Owned(Owned&& other) noexcept
      : device_(other.device_),
        handle_(std::exchange(other.handle_, VK_NULL_HANDLE)),
        destroy_(other.destroy_) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    std::swap(destroy_, other.destroy_);
    return *this;
  }
  ~Owned() {
    if (handle_ != VK_NULL_HANDLE) destroy_(device_, handle_, nullptr);
  }

  Handle get() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 private:
  friend class GpuDevice;
  Owned(VkDevice device, Handle handle, Destroy destroy)
      : device_(device), handle_(handle), destroy_(destroy) {}

  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
  Destroy destroy_ = nullptr;
};

/// The enumerator of a handle's type, for naming it.
template <class Handle>
inline constexpr VkObjectType kObjectType = VK_OBJECT_TYPE_UNKNOWN;
template <>
inline constexpr VkObjectType kObjectType<VkBuffer> = VK_OBJECT_TYPE_BUFFER;
template <>
inline constexpr VkObjectType kObjectType<VkDeviceMemory> = VK_OBJECT_TYPE_DEVICE_MEMORY;
template <>
inline constexpr VkObjectType kObjectType<VkShaderModule> = VK_OBJECT_TYPE_SHADER_MODULE;
template <>
inline constexpr VkObjectType kObjectType<VkDescriptorSetLayout> = VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT;
template <>
inline constexpr VkObjectType kObjectType<VkDescriptorPool> = VK_OBJECT_TYPE_DESCRIPTOR_POOL;
template <>
inline constexpr VkObjectType kObjectType<VkPipelineLayout> = VK_OBJECT_TYPE_PIPELINE_LAYOUT;
template <>
inline constexpr VkObjectType kObjectType<VkPipeline> = VK_OBJECT_TYPE_PIPELINE;
template <>
inline constexpr VkObjectType kObjectType<VkCommandPool> = VK_OBJECT_TYPE_COMMAND_POOL;
template <>
inline constexpr VkObjectType kObjectType<VkQueryPool> = VK_OBJECT_TYPE_QUERY_POOL;
template <>
inline constexpr VkObjectType kObjectType<VkFence> = VK_OBJECT_TYPE_FENCE;

}  // namespace isophote

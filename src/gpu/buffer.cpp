// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/buffer.h"

#include "gpu/command_list.h"

#include <algorithm>
#include <cstring>

namespace isophote {

namespace {
/// Larger copies go in pieces, so that staging never doubles the memory of a big scene.
constexpr std::uint64_t kStagingBytes = std::uint64_t(32) << 20;

VkMemoryPropertyFlags requiredMemory(BufferPlace place) {
  return place == BufferPlace::kDevice
             ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
             : VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
}

VkMemoryPropertyFlags wishedMemory(BufferPlace place) {
  return place == BufferPlace::kDevice ? 0 : VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
}
}  // namespace

Buffer::Buffer(GpuDevice& device, std::string name, std::uint64_t bytes, BufferPlace place)
    : device_(&device), name_(std::move(name)), bytes_(bytes) {
  if (bytes > device.facts().maxStorageBufferBytes)
    fail(ErrorKind::kDevice, name_, "{} bytes are more than the {} that {} takes in one buffer", bytes,
         device.facts().maxStorageBufferBytes, device.facts().name);
  const VolkDeviceTable& vk = device.vk();
  auto info = vkStruct<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = bytes;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  checkVk(vk.vkCreateBuffer(device.handle(), &info, nullptr, &buffer), "create buffer {} of {} bytes", name_,
          bytes);
  buffer_ = device.own(name_, buffer, vk.vkDestroyBuffer);

  VkMemoryRequirements needs{};
  vk.vkGetBufferMemoryRequirements(device.handle(), buffer, &needs);
  auto allocation = vkStruct<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocation.allocationSize = needs.size;
  allocation.memoryTypeIndex =
      device.memoryType(needs.memoryTypeBits, requiredMemory(place), wishedMemory(place));
  VkDeviceMemory memory = VK_NULL_HANDLE;
  checkVk(vk.vkAllocateMemory(device.handle(), &allocation, nullptr, &memory), "allocate {} bytes for {}",
          needs.size, name_);
  memory_ = device.own(name_, memory, vk.vkFreeMemory);
  checkVk(vk.vkBindBufferMemory(device.handle(), buffer, memory, 0), "bind the memory of {}", name_);
  if (place == BufferPlace::kDevice) return;
  void* mapped = nullptr;
  checkVk(vk.vkMapMemory(device.handle(), memory, 0, VK_WHOLE_SIZE, 0, &mapped), "map {}", name_);
  mapped_ = static_cast<std::byte*>(mapped);
}

void Buffer::upload(std::span<const std::byte> data, std::uint64_t offset) {
  requireInside(offset, data.size());
  if (data.empty()) return;
  if (mapped_) {
    std::memcpy(mapped_ + offset, data.data(), data.size());
    return;
  }
  Buffer staging(*device_, name_ + ".staging", std::min<std::uint64_t>(kStagingBytes, data.size()),
                 BufferPlace::kHost);
  for (std::uint64_t done = 0; done < data.size(); done += staging.bytes()) {
    const std::uint64_t bytes = std::min(staging.bytes(), data.size() - done);
    std::memcpy(staging.mapped_, data.data() + done, bytes);
    CommandList list(*device_, name_ + ".upload");
    list.copy(staging, 0, *this, offset + done, bytes);
    list.submitAndWait();
  }
}

void Buffer::download(std::span<std::byte> data, std::uint64_t offset) const {
  requireInside(offset, data.size());
  if (data.empty()) return;
  if (mapped_) {
    std::memcpy(data.data(), mapped_ + offset, data.size());
    return;
  }
  Buffer staging(*device_, name_ + ".staging", std::min<std::uint64_t>(kStagingBytes, data.size()),
                 BufferPlace::kHost);
  for (std::uint64_t done = 0; done < data.size(); done += staging.bytes()) {
    const std::uint64_t bytes = std::min(staging.bytes(), data.size() - done);
    CommandList list(*device_, name_ + ".download");
    list.copy(*this, offset + done, staging, 0, bytes);
    list.submitAndWait();
    std::memcpy(data.data() + done, staging.mapped_, bytes);
  }
}

void Buffer::requireInside(std::uint64_t offset, std::uint64_t bytes) const {
  if (offset > bytes_ || bytes > bytes_ - offset)
    fail(ErrorKind::kInternal, name_, "bytes {} to {} lie outside its {}", offset, offset + bytes, bytes_);
}

}  // namespace isophote

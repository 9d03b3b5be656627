// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/device.h"

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace isophote {

enum class BufferPlace {
  kDevice,  ///< The GPU's own memory; upload and download copy through a staging buffer.
  kHost     ///< Memory that both sides see, and that the CPU reads fast: results that come back every frame.
};

/// A named storage buffer. Its contents start undefined. Throws Error(kDevice) where the device cannot hold
/// it.
class Buffer {
 public:
  Buffer(GpuDevice& device, std::string name, std::uint64_t bytes, BufferPlace place = BufferPlace::kDevice);

  const std::string& name() const { return name_; }
  std::uint64_t bytes() const { return bytes_; }
  VkBuffer handle() const { return buffer_.get(); }

  /// Copies to and from bytes [offset, offset + data.size()), which must lie inside. Both wait for the
  /// device.
  void upload(std::span<const std::byte> data, std::uint64_t offset = 0);
  void download(std::span<std::byte> data, std::uint64_t offset = 0) const;

 private:
  void requireInside(std::uint64_t offset, std::uint64_t bytes) const;

  GpuDevice* device_;
  std::string name_;
  std::uint64_t bytes_;
  Owned<VkDeviceMemory> memory_;  // Freed after the buffer that lies in it.
  Owned<VkBuffer> buffer_;
  std::byte* mapped_ = nullptr;  ///< kHost only.
};

/// A Buffer of `count` elements of T, a plain struct of a *.shared.h or a scalar. Never smaller than one
/// element, since Vulkan has no empty buffers; size() is what was asked for.
template <class T>
class GpuArray : public Buffer {
  static_assert(std::is_trivially_copyable_v<T>, "what crosses to the GPU is plain data");

 public:
  GpuArray(GpuDevice& device, std::string name, std::size_t count, BufferPlace place = BufferPlace::kDevice)
      : Buffer(device, std::move(name), (count > 0 ? count : 1) * sizeof(T), place), count_(count) {}
  GpuArray(GpuDevice& device, std::string name, std::span<const T> data,
           BufferPlace place = BufferPlace::kDevice)
      : GpuArray(device, std::move(name), data.size(), place) {
    upload(data);
  }

  std::size_t size() const { return count_; }
  /// Copies elements to [first, first + data.size()).
  void upload(std::span<const T> data, std::size_t first = 0) {
    Buffer::upload(std::as_bytes(data), first * sizeof(T));
  }
  std::vector<T> download() const {
    std::vector<T> data(count_);
    Buffer::download(std::as_writable_bytes(std::span(data)));
    return data;
  }

 private:
  std::size_t count_;
};

}  // namespace isophote

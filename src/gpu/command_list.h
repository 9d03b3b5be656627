// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/buffer.h"
#include "gpu/compute.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

namespace isophote {

/// GPU time between the start and the end of a scope; 0 on a device without a clock.
struct ScopeTime {
  std::string name;
  double milliseconds = 0;
};

/// Work for the device, recorded once and run once. It sees everything that earlier lists wrote, and the host
/// sees everything that it wrote. Within it, nothing is ordered but by barrier(). What is bound must outlive
/// submitAndWait. One thread records; lists of several threads may run at once.
class CommandList {
 public:
  CommandList(GpuDevice& device, std::string name);
  CommandList(const CommandList&) = delete;
  CommandList& operator=(const CommandList&) = delete;

  /// Labels and times what is recorded until it goes out of scope.
  class [[nodiscard]] Scope {
   public:
    Scope(CommandList& list, std::string name);
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();

   private:
    CommandList& list_;
    std::uint32_t index_;
  };
  Scope scope(std::string name) { return Scope(*this, std::move(name)); }

  /// Chooses the pipeline of the following dispatches. Bindings and push constants start anew.
  void use(const ComputePipeline& pipeline);
  /// Binds the whole buffer to a kBind... of the stage's *.shared.h, until rebound.
  void bind(std::uint32_t binding, const Buffer& buffer) { bound_[binding] = buffer.handle(); }
  /// Sets the push constants, a struct of the stage's *.shared.h.
  template <class T>
  void push(const T& constants) {
    static_assert(sizeof(T) <= kMaxPushBytes, "push constants are limited to 128 bytes");
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
    pushBytes(&constants, sizeof(T));
  }
  /// Runs that many workgroups. Every binding of the shader must be bound.
  void dispatch(std::array<std::uint32_t, 3> groups);
  /// Runs at least `count` invocations along x; the shader drops those beyond.
  void dispatchItems(std::uint64_t count);

  /// What follows sees what came before.
  void barrier();
  void copy(const Buffer& from, std::uint64_t fromOffset, Buffer& to, std::uint64_t toOffset,
            std::uint64_t bytes);
  /// Sets every 32-bit word of the buffer.
  void fill(Buffer& buffer, std::uint32_t word);

  /// Runs the list, waits, and returns the times of its scopes in order of their beginning. The list is then
  /// spent.
  std::vector<ScopeTime> submitAndWait();

 private:
  void pushBytes(const void* data, std::uint32_t bytes);
  void bindDescriptors();
  VkDescriptorSet newSet();
  void addDescriptorPool();
  std::vector<ScopeTime> readTimes() const;

  GpuDevice& device_;
  std::string name_;
  Owned<VkCommandPool> commandPool_;
  Owned<VkQueryPool> queries_;
  std::vector<Owned<VkDescriptorPool>> descriptorPools_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  std::vector<std::string> scopes_;
  const ComputePipeline* pipeline_ = nullptr;
  std::map<std::uint32_t, VkBuffer> bound_;
  bool pushed_ = false;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace isophote {

/// Memory that is read at random, on pages of 2 MiB where the system has them: a read at random from a large
/// texture otherwise costs a walk of the page table besides the texel. No less than `bytes`, aligned to a
/// cache line at least; throws std::bad_alloc. To be freed with freeLarge().
void* allocateLarge(std::size_t bytes);
void freeLarge(void* memory) noexcept;

/// For containers of such memory.
template <class T>
struct LargePageAllocator {
  using value_type = T;
  LargePageAllocator() = default;
  template <class U>
  LargePageAllocator(const LargePageAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) {
    if (count > std::size_t(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocateLarge(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t) noexcept { freeLarge(memory); }

  template <class U>
  bool operator==(const LargePageAllocator<U>&) const noexcept {
    return true;
  }
};

template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

}  // namespace isophote

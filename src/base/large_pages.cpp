// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/large_pages.h"

#include <cstdlib>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace isophote {

namespace {
constexpr std::size_t kLargePage = std::size_t(2) << 20;
constexpr std::size_t kCacheLine = 64;
}  // namespace

void* allocateLarge(std::size_t bytes) {
  const std::size_t alignment = bytes >= kLargePage ? kLargePage : kCacheLine;
  if (bytes > std::size_t(-1) - alignment) throw std::bad_alloc();
  // aligned_alloc wants a multiple of the alignment; what lies beyond `bytes` is never touched.
  void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!memory) throw std::bad_alloc();
#ifdef __linux__
  // Whole pages only, so that the last ones, small, are no larger than what is used of them. Where the kernel
  // declines, small pages serve.
  if (bytes >= kLargePage) (void)madvise(memory, bytes / kLargePage * kLargePage, MADV_HUGEPAGE);
#endif
  return memory;
}

void freeLarge(void* memory) noexcept { std::free(memory); }

}  // namespace isophote

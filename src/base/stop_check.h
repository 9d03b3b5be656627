// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"

#include <cstdint>

namespace isophote {

/// For long loops of short steps, comparisons of a sort among them: call it in each; once in thousands of
/// calls it throws Error(kStopped) if a stop was requested. One thread uses it.
class StopCheck {
 public:
  explicit StopCheck(const Job& job) : job_(job) {}
  void operator()() {
    if (++calls_ % kCallsPerCheck == 0) job_.throwIfStopped();
  }

 private:
  static constexpr std::uint32_t kCallsPerCheck = 8192;
  const Job& job_;
  std::uint32_t calls_ = 0;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string_view>

namespace isophote {

enum class LogLevel { kDetail, kInfo, kWarning };

/// What the host of a long task hands down to it: where to report, when to stop. Copied by value and never
/// global, so that two renders may run at once. Every member may be left empty.
struct Job {
  /// Called from any thread, a few times a second at most: what is being done, and how much of it [0, 1].
  std::function<void(std::string_view task, double fraction)> progress = {};
  /// Called from any thread; the library itself prints nothing.
  std::function<void(LogLevel, std::string_view message)> log = {};
  /// Checked at least every 50 ms by everything that takes longer; Error(kStopped) is thrown then.
  std::stop_token stop = {};
  /// Upper bound of the bytes that one load or render may allocate [bytes].
  std::uint64_t memoryBudgetBytes = std::uint64_t(16) << 30;

  /// The same job, its progress [0, 1] mapped to [begin, end] of this one's.
  Job part(double begin, double end) const;

  void report(std::string_view task, double fraction) const;
  void info(std::string_view message) const;
  void warn(std::string_view message) const;
  /// Throws Error(kStopped) once a stop was requested.
  void throwIfStopped() const;
};

}  // namespace isophote

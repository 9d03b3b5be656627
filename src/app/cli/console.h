// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace isophote::cli {

/// What a person sees on stderr while the program works: warnings, and a progress line where stderr is a
/// terminal. Safe to call from any thread.
class Console {
 public:
  /// A quiet console shows errors only.
  explicit Console(bool quiet);
  ~Console() { clear(); }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void progress(std::string_view task, double fraction);
  void warn(std::string_view message);
  /// A line for a person who watches; scripts do not see it.
  void note(std::string_view message);
  /// Why the program ends without what was asked for. Shown by a quiet console too.
  void error(std::string_view sentence);
  /// Removes the progress line.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void clearLocked();

  std::mutex mutex_;
  bool quiet_;
  bool terminal_;
  bool drawn_ = false;
  std::string task_;
  double fraction_ = 0;       ///< As last reported.
  double startFraction_ = 0;  ///< Where the present work began.
  Clock::time_point start_;
  Clock::time_point lastDrawn_;
};

/// The progress line: task, bar, percentage and the time that is left, judged by the pace since
/// `startFraction`.
std::string progressLine(std::string_view task, double fraction, double startFraction, double elapsedSeconds);

}  // namespace isophote::cli

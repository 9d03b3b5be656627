// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/console.h"

#include "base/one_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace isophote::cli {
namespace {

void print(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

std::string duration(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string progressLine(std::string_view task, double fraction, double startFraction,
                         double elapsedSeconds) {
  constexpr int kWidth = 30;
  const double done = std::clamp(fraction, 0.0, 1.0);
  const int filled = int(done * kWidth);
  std::string line =
      fmt::format("{:<24} [{:#<{}}{:.<{}}] {:3.0f} %", task, "", filled, "", kWidth - filled, 100 * done);
  // A forecast from the first moments would only jump about.
  if (done > startFraction && done < 1 && elapsedSeconds > 1)
    line += fmt::format("  {} left", duration(elapsedSeconds * (1 - done) / (done - startFraction)));
  return line;
}

Console::Console(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void Console::progress(std::string_view task, double fraction) {
  if (quiet_ || !terminal_) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  // Threads may overtake each other a little; a fraction far below the last one begins new work.
  if (fraction < fraction_ - 0.1 || start_ == Clock::time_point()) {
    start_ = now;
    startFraction_ = fraction;
  }
  fraction_ = fraction;
  if (task == task_ && now - lastDrawn_ < std::chrono::milliseconds(100)) return;
  task_ = task;
  lastDrawn_ = now;
  drawn_ = true;
  const std::chrono::duration<double> elapsed = now - start_;
  print("\r\033[K" + onOneLine(progressLine(task, fraction, startFraction_, elapsed.count())));
}

void Console::warn(std::string_view message) {
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
  clearLocked();
  print(fmt::format("isophote: warning: {}\n", onOneLine(message)));
}

void Console::note(std::string_view message) {
  if (quiet_ || !terminal_) return;
  const std::lock_guard lock(mutex_);
  clearLocked();
  print(onOneLine(message) + '\n');
}

void Console::error(std::string_view sentence) {
  const std::lock_guard lock(mutex_);
  clearLocked();
  print(fmt::format("isophote: {}\n", onOneLine(sentence)));
}

void Console::clear() {
  const std::lock_guard lock(mutex_);
  clearLocked();
}

void Console::clearLocked() {
  if (drawn_) print("\r\033[K");
  drawn_ = false;
}

}  // namespace isophote::cli

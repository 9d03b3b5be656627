// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/suite.h"

#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace isophote::bench {

Context::Context(const Options& options, double quickSeconds, Job job, Section& section,
                 std::function<void(const Table&)> changed)
    : options_(options),
      budgetSeconds_(options.budgetSeconds > 0 ? options.budgetSeconds
                     : options.quick           ? quickSeconds
                                               : 0),
      job_(std::move(job)),
      section_(section),
      changed_(std::move(changed)) {}

SceneChoice Context::scene(PublicScene wanted) {
  SceneChoice choice = choosePublicScene(wanted, options_.assetFolders, job_);
  if (choice.standsIn)
    note(
        fmt::format("A public scene is not at hand, so that a built-in one is measured: {}. Name the folder "
                    "of the public scenes with --assets or in ISOPHOTE_ASSETS.",
                    choice.name));
  return choice;
}

SceneChoice Context::scene(const std::string& nameOrPath) {
  SceneOptions sceneOptions;
  sceneOptions.assetFolders = options_.assetFolders;
  return {loadScene(nameOrPath, sceneOptions, job_), nameOrPath, false};
}

namespace {

double scaleOf(const Options& options) {
  constexpr double kQuickScale = 0.25;
  if (options.scale > 0) return options.scale;
  return options.quick ? kQuickScale : 1.0;
}

}  // namespace

std::uint32_t Context::side(std::uint32_t ofPaper) const {
  constexpr double kLeast = 16;
  return std::uint32_t(std::max(kLeast, std::round(double(ofPaper) * std::sqrt(scaleOf(options_)))));
}

void Context::setSize(FrameSettings& frame, std::uint32_t width, std::uint32_t height) const {
  frame.width = side(width);
  frame.height = side(height);
}

std::uint32_t Context::photons(std::uint32_t ofPaper) const {
  constexpr double kLeast = 100;
  const double scaled = std::round(double(ofPaper) * scaleOf(options_));
  return std::uint32_t(std::max(std::min(kLeast, double(ofPaper)), scaled));
}

double Context::elapsedSeconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double Context::secondsLeft() const {
  return budgetSeconds_ > 0 ? budgetSeconds_ - elapsedSeconds() : std::numeric_limits<double>::infinity();
}

bool Context::hasTimeFor(const std::string& what, double seconds) {
  job_.throwIfStopped();
  if (!begun_ || secondsLeft() > seconds) {
    begun_ = true;
    return true;
  }
  note(fmt::format("Left out for lack of time: {}.", what));
  return false;
}

void Context::repeat(std::initializer_list<Samples*> samples, const std::function<void()>& round,
                     std::uint32_t most) {
  repeat(std::span<Samples* const>(samples.begin(), samples.size()), round, most);
}

void Context::repeat(std::span<Samples* const> samples, const std::function<void()>& round,
                     std::uint32_t most) {
  constexpr std::uint32_t kLeast = 2;
  const std::uint32_t usual = options_.repeats > 0 ? options_.repeats : options_.quick ? 3 : 7;
  const std::uint32_t wanted = std::min(usual, most);
  job_.throwIfStopped();
  round();
  for (Samples* const warmUp : samples) warmUp->clear();
  for (std::uint32_t i = 0; i < wanted && (i < std::min(kLeast, wanted) || secondsLeft() > 0); ++i) {
    job_.throwIfStopped();
    round();
  }
}

void Context::add(Table table) {
  for (const auto& row : table.rows)
    if (row.size() != table.columns.size())
      throw std::logic_error(fmt::format("table {}: a row of {} cells for {} columns", table.id, row.size(),
                                         table.columns.size()));
  section_.tables.push_back(std::move(table));
  if (changed_) changed_(section_.tables.back());
}

void Context::note(const std::string& sentence) {
  if (std::ranges::find(section_.notes, sentence) == section_.notes.end()) section_.notes.push_back(sentence);
}

double millisecondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double processorMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

}  // namespace isophote::bench

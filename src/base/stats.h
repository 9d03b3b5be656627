// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace isophote {

/// What one render measured about itself: collected by the frame on its own thread, written by `--stats`.
/// Names appear in the order in which they were first given.
class Stats {
 public:
  std::string engine;  ///< "cpu" or "vulkan".
  std::string device;  ///< The processor's or the graphics device's own name.

  /// Wall-clock time of a stage; several additions to one name sum up.
  void addStage(std::string_view name, double milliseconds);
  /// A number; the last one given holds.
  void setCounter(std::string_view name, double value);
  /// A list, for example one number a bounce; the last one given holds.
  void setCounter(std::string_view name, std::vector<double> values);
  /// Memory that a named buffer takes; of several passes the most holds.
  void peakBytes(std::string_view buffer, std::uint64_t bytes);

  /// Adds another's stages and takes over its counters, as if it had been measured here.
  void add(const Stats& later);
  /// The same, but counters sum up: of a part of one and the same task.
  void addPart(const Stats& part);

  /// Adds the time from its birth to its death to the stage of that name.
  class Scope {
   public:
    Scope(Stats& stats, std::string_view stage);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Stats& stats_;
    std::string stage_;
    std::chrono::steady_clock::time_point start_;
  };
  [[nodiscard]] Scope scope(std::string_view stage) { return Scope(*this, stage); }

  /// Milliseconds of a stage; 0 where there is none of that name.
  double stageMilliseconds(std::string_view name) const;
  /// A counter's number; 0 where there is none of that name, or a list.
  double counter(std::string_view name) const;
  /// A counter's list; empty where there is none of that name, or a number.
  std::vector<double> counterList(std::string_view name) const;
  /// All stages and their milliseconds.
  const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }
  /// All stages, summed.
  double totalMilliseconds() const;

  /// Keys engine, device, stages (milliseconds), counters, bytes, peakMemoryBytes (of the whole process).
  std::string toJson() const;

 private:
  using Counter = std::variant<double, std::vector<double>>;
  std::vector<std::pair<std::string, double>> stages_;
  std::vector<std::pair<std::string, Counter>> counters_;
  std::vector<std::pair<std::string, std::uint64_t>> bytes_;
};

/// The most memory that this process has ever had resident; 0 where the system does not say.
std::uint64_t peakMemoryBytes();

/// The processor's own name, for example "AMD EPYC 7B13".
std::string processorName();

}  // namespace isophote

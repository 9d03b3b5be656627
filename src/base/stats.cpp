// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/stats.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace isophote {
namespace {

/// The value of that name, added at the end where there is none yet.
template <class T>
T& entry(std::vector<std::pair<std::string, T>>& list, std::string_view name) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const auto& e) { return e.first == name; });
  return found != list.end() ? found->second : list.emplace_back(std::string(name), T{}).second;
}

/// Counts read better without a decimal point; doubles hold them exactly up to 2^53.
nlohmann::ordered_json number(double value) {
  if (value == std::floor(value) && std::abs(value) <= 9007199254740992.0) return std::int64_t(value);
  return value;
}

/// Text after "key" and its colon in a file of "key: value" lines; empty where there is none.
std::string valueOfLine(const char* path, std::string_view key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const auto colon = line.find(':');
    const auto first = line.find_first_not_of(" \t", colon == std::string::npos ? colon : colon + 1);
    if (first != std::string::npos) return line.substr(first);
  }
  return {};
}

}  // namespace

void Stats::addStage(std::string_view name, double milliseconds) { entry(stages_, name) += milliseconds; }

void Stats::setCounter(std::string_view name, double value) { entry(counters_, name) = value; }

void Stats::setCounter(std::string_view name, std::vector<double> values) {
  entry(counters_, name) = std::move(values);
}

void Stats::peakBytes(std::string_view buffer, std::uint64_t bytes) {
  std::uint64_t& most = entry(bytes_, buffer);
  most = std::max(most, bytes);
}

void Stats::add(const Stats& later) {
  for (const auto& [name, milliseconds] : later.stages_) addStage(name, milliseconds);
  for (const auto& [name, value] : later.counters_) entry(counters_, name) = value;
  for (const auto& [name, bytes] : later.bytes_) peakBytes(name, bytes);
}

void Stats::addPart(const Stats& part) {
  Stats sum = part;
  for (auto& [name, value] : sum.counters_) {
    const auto same = [&wanted = name](const auto& counter) { return counter.first == wanted; };
    const auto before = std::find_if(counters_.begin(), counters_.end(), same);
    if (before == counters_.end() || before->second.index() != value.index()) continue;
    if (double* const one = std::get_if<double>(&value)) {
      *one += std::get<double>(before->second);
      continue;
    }
    auto& list = std::get<std::vector<double>>(value);
    const auto& listBefore = std::get<std::vector<double>>(before->second);
    list.resize(std::max(list.size(), listBefore.size()));
    for (std::size_t i = 0; i < listBefore.size(); ++i) list[i] += listBefore[i];
  }
  add(sum);
}

Stats::Scope::Scope(Stats& stats, std::string_view stage)
    : stats_(stats), stage_(stage), start_(std::chrono::steady_clock::now()) {}

Stats::Scope::~Scope() {
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start_;
  stats_.addStage(stage_, elapsed.count());
}

double Stats::stageMilliseconds(std::string_view name) const {
  const auto found =
      std::find_if(stages_.begin(), stages_.end(), [&](const auto& s) { return s.first == name; });
  return found != stages_.end() ? found->second : 0.0;
}

double Stats::counter(std::string_view name) const {
  for (const auto& [counter, value] : counters_)
    if (counter == name && std::holds_alternative<double>(value)) return std::get<double>(value);
  return 0;
}

std::vector<double> Stats::counterList(std::string_view name) const {
  for (const auto& [counter, value] : counters_)
    if (counter == name && std::holds_alternative<std::vector<double>>(value))
      return std::get<std::vector<double>>(value);
  return {};
}

double Stats::totalMilliseconds() const {
  double total = 0;
  for (const auto& stage : stages_) total += stage.second;
  return total;
}

std::string Stats::toJson() const {
  using Json = nlohmann::ordered_json;
  Json stages = Json::object(), counters = Json::object(), bytes = Json::object();
  for (const auto& [name, milliseconds] : stages_) stages[name] = milliseconds;
  for (const auto& [name, counter] : counters_) {
    if (const auto* values = std::get_if<std::vector<double>>(&counter)) {
      Json list = Json::array();
      for (const double value : *values) list.push_back(number(value));
      counters[name] = std::move(list);
    } else {
      counters[name] = number(std::get<double>(counter));
    }
  }
  for (const auto& [name, size] : bytes_) bytes[name] = size;
  const Json json = {{"engine", engine},     {"device", device}, {"stages", stages},
                     {"counters", counters}, {"bytes", bytes},   {"peakMemoryBytes", peakMemoryBytes()}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::uint64_t peakMemoryBytes() {
  const std::string kibibytes = valueOfLine("/proc/self/status", "VmHWM");
  return kibibytes.empty() ? 0 : std::strtoull(kibibytes.c_str(), nullptr, 10) * 1024;
}

std::string processorName() {
  const std::string name = valueOfLine("/proc/cpuinfo", "model name");
  return name.empty() ? "unknown processor" : name;
}

}  // namespace isophote

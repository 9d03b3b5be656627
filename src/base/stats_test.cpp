// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/stats.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <thread>

namespace isophote {
namespace {

TEST(Stats, WritesNamesInTheOrderInWhichTheyCame) {
  Stats stats;
  stats.engine = "cpu";
  stats.device = "a \"processor\"";
  stats.addStage("photon_trace", 2.5);
  stats.addStage("direct", 1.0);
  stats.addStage("photon_trace", 0.5);
  stats.setCounter("photonsEmitted", 200000);
  stats.setCounter("hitsPerBounce", {3.0, 2.0, 0.5});
  stats.peakBytes("photons", std::uint64_t(1) << 33);
  stats.peakBytes("photons", 1);

  const auto json = nlohmann::ordered_json::parse(stats.toJson());
  EXPECT_EQ(json["engine"], "cpu");
  EXPECT_EQ(json["device"], "a \"processor\"");
  EXPECT_EQ(json["stages"].dump(), R"({"photon_trace":3.0,"direct":1.0})");
  EXPECT_EQ(json["counters"].dump(), R"({"photonsEmitted":200000,"hitsPerBounce":[3,2,0.5]})");
  EXPECT_EQ(json["bytes"]["photons"], std::uint64_t(1) << 33);
  EXPECT_EQ(stats.totalMilliseconds(), 4.0);
  EXPECT_EQ(stats.stageMilliseconds("direct"), 1.0);
  EXPECT_EQ(stats.stageMilliseconds("composite"), 0.0);
  EXPECT_EQ(stats.counter("photonsEmitted"), 200000.0);
  EXPECT_EQ(stats.counter("hitsPerBounce"), 0.0);
}

TEST(Stats, ScopeTimesWhatItEncloses) {
  Stats stats;
  const auto start = std::chrono::steady_clock::now();
  {
    const auto scope = stats.scope("gbuffer");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const std::chrono::duration<double, std::milli> whole = std::chrono::steady_clock::now() - start;
  EXPECT_GE(stats.stageMilliseconds("gbuffer"), 5.0);
  EXPECT_LE(stats.stageMilliseconds("gbuffer"), whole.count());
}

TEST(Stats, PeakMemoryHoldsWhatWasTouched) {
  constexpr std::size_t kBytes = std::size_t(64) << 20;
  std::vector<char> block(kBytes, 1);
  EXPECT_GE(peakMemoryBytes(), kBytes);
  EXPECT_EQ(block[kBytes / 2], 1);
}

TEST(Stats, PartsOfATaskSumUpAndLaterTasksTakeOver) {
  const auto measured = [](double count, std::vector<double> list, std::uint64_t bytes) {
    Stats stats;
    stats.addStage("stage", 2.0);
    stats.setCounter("count", count);
    stats.setCounter("list", std::move(list));
    stats.peakBytes("buffer", bytes);
    return stats;
  };
  const auto json = [](const Stats& stats) { return nlohmann::json::parse(stats.toJson()); };
  Stats sum;
  sum.addPart(measured(1, {1, 2}, 10));
  sum.addPart(measured(4, {10, 20, 30}, 7));
  EXPECT_EQ(json(sum)["stages"]["stage"], 4);
  EXPECT_EQ(json(sum)["counters"]["count"], 5);
  EXPECT_EQ(json(sum)["counters"]["list"], nlohmann::json({11, 22, 30}));
  EXPECT_EQ(json(sum)["bytes"]["buffer"], 10);
  sum.add(measured(3, {7}, 11));
  EXPECT_EQ(json(sum)["stages"]["stage"], 6);
  EXPECT_EQ(json(sum)["counters"]["count"], 3);
  EXPECT_EQ(json(sum)["counters"]["list"], nlohmann::json({7}));
  EXPECT_EQ(json(sum)["bytes"]["buffer"], 11);
}

}  // namespace
}  // namespace isophote

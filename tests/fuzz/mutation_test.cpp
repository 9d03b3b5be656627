// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Damaged files of every format are read or refused in one sentence, in bounded time and memory. How many of
// each format: ISOPHOTE_MUTATIONS, 500 otherwise; `./check --all` takes 10,000.
#include "base/stats.h"
#include "fuzz/mutate.h"
#include "fuzz/scene_formats.h"
#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stop_token>
#include <thread>

namespace isophote::fuzz {
namespace {

using namespace std::chrono_literals;

constexpr const char* kFormatNames[] = {"gltf", "glb",  "obj", "mtl", "description", "settings",
                                        "png",  "jpeg", "exr", "hdr", "tga"};
/// Far beyond what any input takes, however busy the machine.
constexpr auto kHangsAfter = 60s;
/// Of the whole process: the budget, what lies beside it, and what the address sanitizer keeps.
constexpr std::uint64_t kMostProcessBytes = std::uint64_t(2) << 30;

int mutationCount() {
  const char* text = std::getenv("ISOPHOTE_MUTATIONS");
  return text ? std::max(std::atoi(text), 1) : 500;
}

/// Ends the process where one input takes too long; the input is left in its file.
class HangWatch {
 public:
  explicit HangWatch(const std::filesystem::path& file)
      : thread_([this, file](const std::stop_token& stop) { watch(stop, file); }) {}
  void next() { ++reads_; }

 private:
  void watch(const std::stop_token& stop, const std::filesystem::path& file) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any wake;
    for (int seen = -1; !stop.stop_requested();) {
      if (seen == reads_) {
        std::fprintf(stderr, "reading %s does not end\n", file.c_str());
        std::abort();
      }
      seen = reads_;
      wake.wait_for(lock, stop, kHangsAfter, [] { return false; });
    }
  }

  std::atomic<int> reads_ = 0;
  std::jthread thread_;
};

class Mutations : public testing::TestWithParam<const char*> {
 protected:
  const Format& format() const {
    for (const Format& format : formats_)
      if (format.name == GetParam()) return format;
    throw std::runtime_error("there is no such format");
  }

  TestFolder folder_;
  std::vector<Format> formats_ = allFormats(folder_.path());
};

TEST_P(Mutations, SeedsAreRead) {
  for (const std::string& seed : format().seeds) {
    std::string repaired = seed;
    if (format().repair) format().repair(repaired);
    EXPECT_TRUE(repaired == seed) << "what needs no repair is left alone";
    EXPECT_NO_THROW(format().read(seed));
  }
}

TEST_P(Mutations, AreReadOrRefusedInOneSentence) {
  const std::filesystem::path copy = folder_.path() / "mutation";
  Mutator mutator(format(), 20261122);
  HangWatch watch(copy);
  int refused = 0;
  const int count = mutationCount();
  for (int i = 0; i < count; ++i) {
    const std::string bytes = mutator.next();
    writeBytes(copy, bytes);
    watch.next();
    try {
      format().read(bytes);
    } catch (const Error& error) {
      ++refused;
      ASSERT_TRUE(error.kind() == ErrorKind::kBadInput || error.kind() == ErrorKind::kResources)
          << error.what();
      ASSERT_THAT(error.what(), testing::Not(testing::HasSubstr("\n"))) << "mutation " << i;
      ASSERT_LT(std::string_view(error.what()).size(), 2000u) << "mutation " << i << error.what();
    }
  }
  RecordProperty("refused", refused);
  EXPECT_GT(refused, count / 20) << "mutations do harm";
  EXPECT_LT(refused, count) << "but not always";
  EXPECT_LT(peakMemoryBytes(), kMostProcessBytes);
}

INSTANTIATE_TEST_SUITE_P(Formats, Mutations, testing::ValuesIn(kFormatNames),
                         [](const auto& format) { return std::string(format.param); });

TEST(MutationsCover, EveryFormat) {
  const TestFolder folder;
  std::vector<std::string> names;
  for (const Format& format : allFormats(folder.path())) names.push_back(format.name);
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(kFormatNames));
}

}  // namespace
}  // namespace isophote::fuzz

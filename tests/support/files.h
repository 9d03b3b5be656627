// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "base/job.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace isophote {

/// An empty folder for one test, gone with it.
class TestFolder {
 public:
  TestFolder() {
    static int count = 0;
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            fmt::format("isophote-{}-{}-{}-{}", test.test_suite_name(), test.name(), ::getpid(), count++);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file, and the folders that `name` names.
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// The folder of public test scenes; empty where this machine has none.
inline std::filesystem::path publicScenes() {
  const char* assets = std::getenv("ISOPHOTE_ASSETS");
  const std::filesystem::path folder = assets
                                           ? std::filesystem::path(assets)
                                           : std::filesystem::path(ISOPHOTE_SOURCE_DIR) / "../shared/scenes";
  std::error_code ignored;
  return std::filesystem::is_directory(folder, ignored) ? folder : std::filesystem::path();
}

/// A job that keeps its warnings.
struct WarningLog {
  std::vector<std::string> warnings;
  Job job() {
    Job result;
    result.log = [this](LogLevel level, std::string_view message) {
      if (level == LogLevel::kWarning) warnings.emplace_back(message);
    };
    return result;
  }
};

/// The sentence of the Error that `call` throws; fails the test where it throws none or one of another kind.
template <class Call>
std::string errorOf(Call&& call, ErrorKind kind = ErrorKind::kBadInput) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(int(error.kind()), int(kind)) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return "";
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/files.h"

#include "base/error.h"
#include "support/files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>

namespace isophote {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  TestFolder testFolder_;
  fs::path folder_ = testFolder_.path();
  std::ptrdiff_t fileCount() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }
};

std::string messageOf(auto&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(Files, WhatIsWrittenIsReadBack) {
  const std::string bytes("a\0b\n\xff", 5);
  writeFileAtomically(folder_ / "f", bytes);
  EXPECT_EQ(readFile(folder_ / "f"), bytes);
  writeFileAtomically(folder_ / "f", std::string_view("shorter"));
  EXPECT_EQ(readFile(folder_ / "f"), "shorter");
  EXPECT_EQ(fileCount(), 1);
}

TEST_F(Files, MissingFolderIsNamed) {
  const std::string message =
      messageOf([&] { writeFileAtomically(folder_ / "none" / "f.exr", std::string_view("x")); });
  EXPECT_NE(message.find((folder_ / "none").string() + "\" does not exist"), std::string::npos) << message;
  EXPECT_THROW(requireWritable(folder_ / "none" / "f.exr"), Error);
  EXPECT_THROW(requireWritable(folder_), Error);
  EXPECT_EQ(fileCount(), 0);
}

TEST_F(Files, FailedWriteKeepsTheOldFileAndLeavesNoOther) {
  writeFileAtomically(folder_ / "f", std::string_view("old"));
  // A limit on file sizes makes the write itself fail, as a full disk would.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto oldHandler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = messageOf([&] { writeFileAtomically(folder_ / "f", std::string(5000, 'n')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, oldHandler);
  EXPECT_NE(message.find("cannot be written"), std::string::npos) << message;
  EXPECT_EQ(readFile(folder_ / "f"), "old");
  EXPECT_EQ(fileCount(), 1);
}

TEST_F(Files, ProcessKilledHalfWayLeavesNoFile) {
  const int unnamed = ::open(folder_.c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (unnamed < 0) GTEST_SKIP() << "this file system has no files without a name (O_TMPFILE)";
  ::close(unnamed);
  writeFileAtomically(folder_ / "f", std::string_view("old"));
  const auto writeTooMuch = [&] {
    std::signal(SIGXFSZ, SIG_DFL);
    const rlimit small{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &small);
    writeFileAtomically(folder_ / "f", std::string(5000, 'n'));
  };
  EXPECT_EXIT(writeTooMuch(), testing::KilledBySignal(SIGXFSZ), "");
  EXPECT_EQ(readFile(folder_ / "f"), "old");
  EXPECT_EQ(fileCount(), 1);
}

TEST_F(Files, RequireWritableLeavesNoTrace) {
  requireWritable(folder_ / "f");
  EXPECT_EQ(fileCount(), 0);
}

TEST_F(Files, LinkIsKeptAndItsTargetReplaced) {
  writeFileAtomically(folder_ / "target", std::string_view("old"));
  fs::create_symlink("target", folder_ / "link");
  writeFileAtomically(folder_ / "link", std::string_view("new"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(readFile(folder_ / "target"), "new");
}

TEST_F(Files, DeviceIsWrittenToNotReplaced) {
  requireWritable("/dev/null");
  writeFileAtomically("/dev/null", std::string_view("gone"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(Files, ReadingSaysWhatIsWrong) {
  EXPECT_NE(messageOf([&] { readFile(folder_ / "none"); }).find("does not exist"), std::string::npos);
  EXPECT_NE(messageOf([&] { readFile(folder_); }).find("is a folder"), std::string::npos);
  writeFileAtomically(folder_ / "f", std::string_view("12345"));
  EXPECT_EQ(readFile(folder_ / "f", 5), "12345");
  EXPECT_NE(messageOf([&] { readFile(folder_ / "f", 4); }).find("more than 4 bytes"), std::string::npos);
  EXPECT_NE(messageOf([&] { readFile("/dev/zero"); }).find("is a device or pipe"), std::string::npos);
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);  // To which nobody ever writes.
  EXPECT_NE(messageOf([&] { readFile(folder_ / "pipe"); }).find("is a device or pipe"), std::string::npos);
}

}  // namespace
}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/screenshot.h"
#include "base/files.h"
#include "support/files.h"

#include <gtest/gtest.h>

namespace isophote::viewer {
namespace {

TEST(Screenshot, NeverTakesANameTwice) {
  const TestFolder folderOfTest;
  const std::filesystem::path folder = folderOfTest.path();
  EXPECT_EQ(unusedName(folder, "room", ".png").filename(), "room-0001.png");
  writeFileAtomically(folder / "room-0001.png", std::string_view("kept"));
  EXPECT_EQ(unusedName(folder, "room", ".png").filename(), "room-0002.png");
  std::filesystem::create_symlink("nowhere", folder / "room-0002.png");
  EXPECT_EQ(unusedName(folder, "room", ".png").filename(), "room-0003.png");
  EXPECT_EQ(unusedName(folder, "room", ".exr").filename(), "room-0001.exr");
}

TEST(Screenshot, IsNamedAfterItsScene) {
  EXPECT_EQ(screenshotName("models/room.glb"), "room");
  EXPECT_EQ(screenshotName("cornell-box"), "cornell-box");
}

}  // namespace
}  // namespace isophote::viewer

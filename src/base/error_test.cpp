// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

#include "base/one_line.h"

#include <gtest/gtest.h>

namespace isophote {
namespace {

TEST(Error, SentenceNamesItsSubject) {
  EXPECT_STREQ(Error(ErrorKind::kBadInput, "a.obj", "is cut off").what(), "a.obj: is cut off");
  EXPECT_STREQ(Error(ErrorKind::kBadInput, "", "is cut off").what(), "is cut off");
}

TEST(Error, SentenceKeepsToOneLine) {
  const Error error(ErrorKind::kBadInput, "a\nb.obj", "has no \x1b[31m\"wall\r\t\x7f\"");
  EXPECT_STREQ(error.what(), "a?b.obj: has no ?[31m\"wall???\"");
  EXPECT_EQ(error.subject(), "a\nb.obj");
  EXPECT_EQ(onOneLine("Häuser"), "Häuser");
}

TEST(Error, LongNamesAreCutInTheMiddle) {
  const std::string what =
      Error(ErrorKind::kBadInput, "a.obj", "has no \"" + std::string(100000, 'x') + "\"; it has b").what();
  EXPECT_LT(what.size(), 1200u);
  EXPECT_TRUE(what.starts_with("a.obj: has no \"xxx"));
  EXPECT_TRUE(what.ends_with("xxx\"; it has b"));
}

}  // namespace
}  // namespace isophote

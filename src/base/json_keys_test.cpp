// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/json_keys.h"

#include <gtest/gtest.h>

#include <string>

namespace isophote {
namespace {

std::string errorOf(std::string_view text, ErrorKind kind = ErrorKind::kBadInput) {
  try {
    requireUniqueKeys(text, "a.json", kind);
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(int(error.kind()), int(kind));
    return error.what();
  }
}

TEST(JsonKeys, OnceEachIsFine) {
  EXPECT_EQ(errorOf("{}"), "");
  EXPECT_EQ(errorOf("[1, \"a\", null, true, 1.5, -2]"), "");
  EXPECT_EQ(errorOf(R"({"a": {"a": 1, "b": {"a": 2}}, "b": [{"a": 1}, {"a": 2}]})"), "");
}

TEST(JsonKeys, TwiceIsNamedWithItsPlace) {
  EXPECT_EQ(errorOf(R"({"a": 1, "b": 2, "a": 3})"), "a.json: the key \"a\" is given twice; keep one");
  EXPECT_EQ(errorOf(R"({"x": 1, "materials": [1, {}, {"extras": {"b": [], "b": {}}}], "y": 2})"),
            "a.json: materials[2].extras: the key \"b\" is given twice; keep one");
  EXPECT_EQ(errorOf(R"([[0], [0, {"k": 1, "k": 1}]])"),
            "a.json: [1][1]: the key \"k\" is given twice; keep one");
  // Escapes spell the same key.
  EXPECT_EQ(errorOf("{\"a\": 1, \"\\u0061\": 2}", ErrorKind::kBadUsage),
            "a.json: the key \"a\" is given twice; keep one");
}

TEST(JsonKeys, DeepNestingIsNoProblem) {
  EXPECT_EQ(errorOf(std::string(200000, '[') + std::string(200000, ']')), "");
}

}  // namespace
}  // namespace isophote

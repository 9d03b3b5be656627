// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace isophote {

/// For the message of a failed comparison: writes both pictures, as EXR and PNG, into the build folder and
/// says where they are.
inline std::string writeFailure(const Image& actual, const Image& expected) {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::string suite = test.test_suite_name();
  for (char& c : suite) c = c == '/' ? '-' : c;
  const std::filesystem::path folder =
      std::filesystem::path(ISOPHOTE_BINARY_DIR) / "failures" / fmt::format("{}.{}", suite, test.name());
  std::filesystem::create_directories(folder);
  for (const auto& [name, image] : {std::pair("actual", &actual), std::pair("expected", &expected)}) {
    Film film;
    film.colour = *image;
    writeFilm(folder / fmt::format("{}.exr", name), film);
    writeFilm(folder / fmt::format("{}.png", name), film);
  }
  return fmt::format("the pictures lie in {}", folder.string());
}

}  // namespace isophote

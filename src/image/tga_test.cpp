// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/tga.h"

#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace isophote {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::uint64_t kBudget = 64u << 20;

struct TgaOptions {
  int type = 2;
  int bits = 24;
  int descriptor = 0x20;  ///< Rows from the top.
  int mapFirst = 0;
  int mapCount = 0;
  int mapBits = 0;
  std::string id = "";
};

std::string tga(int width, int height, const TgaOptions& o, const std::string& data) {
  const auto word = [](int v) { return std::string{char(v & 255), char(v >> 8)}; };
  std::string file = {char(o.id.size()), char(o.mapCount > 0), char(o.type)};
  file +=
      word(o.mapFirst) + word(o.mapCount) + char(o.mapBits) + word(0) + word(0) + word(width) + word(height);
  return file + char(o.bits) + char(o.descriptor) + o.id + data;
}

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += char(value);
  return text;
}

DecodedImage decoded(const std::string& file) {
  return decodeImage(std::as_bytes(std::span(file)), "picture", kBudget);
}
std::string errorIn(const std::string& file) {
  return errorOf([&] { decodeTga(std::as_bytes(std::span(file)), "picture", kBudget); });
}
std::string errorWithin(std::uint64_t budget, const std::string& file) {
  return errorOf([&] { decodeTga(std::as_bytes(std::span(file)), "picture", budget); },
                 ErrorKind::kResources);
}

TEST(Tga, ReadsTrueColour) {
  const DecodedImage image = decoded(tga(2, 1, {.id = "made by a test"}, bytes({3, 2, 1, 6, 5, 4})));
  EXPECT_EQ(image.width, 2);
  EXPECT_EQ(image.height, 1);
  EXPECT_THAT(image.rgba, ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
  const std::string two = bytes({3, 2, 1, 9, 6, 5, 4, 8});
  EXPECT_THAT(decoded(tga(2, 1, {.bits = 32, .descriptor = 0x28}, two)).rgba,
              ElementsAre(1, 2, 3, 9, 4, 5, 6, 8));
  EXPECT_THAT(decoded(tga(2, 1, {.bits = 32}, two)).rgba, ElementsAre(1, 2, 3, 255, 4, 5, 6, 255))
      << "a fourth byte that is not declared as alpha";
  // 5 bits each: red 31, green 16, blue 1, attribute bit set, then unset.
  const std::string packed = bytes({0x01, 0xfe, 0x01, 0x7e});
  EXPECT_THAT(decoded(tga(2, 1, {.bits = 16, .descriptor = 0x21}, packed)).rgba,
              ElementsAre(255, 132, 8, 255, 255, 132, 8, 0));
  EXPECT_THAT(decoded(tga(2, 1, {.bits = 15}, packed)).rgba, ElementsAre(255, 132, 8, 255, 255, 132, 8, 255));
}

TEST(Tga, ReadsGreyAndColourMaps) {
  EXPECT_THAT(decoded(tga(2, 1, {.type = 3, .bits = 8}, bytes({7, 200}))).rgba,
              ElementsAre(7, 7, 7, 255, 200, 200, 200, 255));
  EXPECT_THAT(decoded(tga(1, 1, {.type = 3, .bits = 16, .descriptor = 0x28}, bytes({7, 100}))).rgba,
              ElementsAre(7, 7, 7, 100));
  const TgaOptions mapped{.type = 1, .bits = 8, .mapFirst = 10, .mapCount = 2, .mapBits = 24};
  const std::string map = bytes({3, 2, 1, 6, 5, 4});
  EXPECT_THAT(decoded(tga(2, 1, mapped, map + bytes({11, 10}))).rgba,
              ElementsAre(4, 5, 6, 255, 1, 2, 3, 255));
  EXPECT_THAT(errorIn(tga(2, 1, mapped, map + bytes({12, 10}))), HasSubstr("damaged"));
  EXPECT_THAT(errorIn(tga(2, 1, mapped, map + bytes({9, 10}))), HasSubstr("damaged"));
}

TEST(Tga, ReadsRunsAcrossRows) {
  // A run of 3 and 3 plain pixels fill 2 rows of 3; then 4 rows of 64 from runs of 128.
  const std::string file = tga(2, 3, {.type = 11, .bits = 8}, bytes({128 + 2, 50, 2, 1, 2, 3}));
  EXPECT_EQ(decoded(file).rgba[8], 50);
  EXPECT_EQ(decoded(file).rgba[12], 1);
  EXPECT_EQ(decoded(file).rgba[20], 3);
  EXPECT_EQ(decoded(tga(64, 4, {.type = 10}, bytes({255, 1, 2, 3, 255, 4, 5, 6}))).rgba[255 * 4], 6);
  EXPECT_THAT(errorIn(tga(2, 3, {.type = 11, .bits = 8}, bytes({128 + 6, 50}))), HasSubstr("damaged"))
      << "a run that is too long";
}

TEST(Tga, PutsEveryCornerUpright) {
  const auto grey = [](int descriptor, std::initializer_list<int> values) {
    std::vector<int> result;
    const DecodedImage image =
        decoded(tga(2, 2, {.type = 3, .bits = 8, .descriptor = descriptor}, bytes(values)));
    for (std::size_t i = 0; i < 16; i += 4) result.push_back(image.rgba[i]);
    return result;
  };
  const auto upright = ElementsAre(1, 2, 3, 4);
  EXPECT_THAT(grey(0x20, {1, 2, 3, 4}), upright);
  EXPECT_THAT(grey(0x00, {3, 4, 1, 2}), upright);
  EXPECT_THAT(grey(0x30, {2, 1, 4, 3}), upright);
  EXPECT_THAT(grey(0x10, {4, 3, 2, 1}), upright);
}

TEST(Tga, NamesWhatIsWrong) {
  EXPECT_THAT(errorIn("short"), HasSubstr("damaged or truncated"));
  EXPECT_THAT(errorIn(tga(1, 1, {.type = 32}, "abc")), HasSubstr("type 32"));
  EXPECT_THAT(errorIn(tga(0, 1, {}, "abc")), HasSubstr("without pixels"));
  EXPECT_THAT(errorIn(tga(1, 1, {.bits = 17}, "abc")), HasSubstr("17 bits"));
  EXPECT_THAT(errorIn(tga(1, 1, {.type = 1, .bits = 8}, "abc")), HasSubstr("without a colour map"));
  EXPECT_THAT(errorIn(tga(1, 1, {.type = 1, .bits = 8, .mapCount = 1, .mapBits = 7}, "abc")),
              HasSubstr("7 bits"));
  EXPECT_THAT(errorIn(tga(1, 1, {.type = 1, .bits = 8, .mapCount = 60000, .mapBits = 24}, "abc")),
              HasSubstr("damaged"));
  EXPECT_THAT(errorWithin(kBudget, tga(65535, 65535, {}, "abc")), HasSubstr("where 67108864 are allowed"));
  EXPECT_THAT(errorIn(tga(1000, 1000, {}, "abc")), HasSubstr("declares 1000 x 1000 pixels but holds only"));
  EXPECT_THAT(errorIn(tga(1000, 1000, {.type = 10}, "abc")), HasSubstr("declares 1000 x 1000 pixels"));
  EXPECT_THAT(errorWithin(15, tga(2, 2, {}, std::string(12, 'x'))),
              HasSubstr("16 bytes where 15 are allowed"));
}

TEST(Tga, RefusesEveryTruncation) {
  const std::string files[] = {
      tga(2, 2, {.id = "id"}, std::string(12, 'x')),
      tga(3, 2, {.type = 10}, bytes({128 + 2, 1, 2, 3, 2, 1, 1, 1, 2, 2, 2, 3, 3, 3})),
      tga(2, 1, {.type = 1, .bits = 8, .mapCount = 2, .mapBits = 32}, std::string(8, 'x') + bytes({1, 0}))};
  for (const std::string& file : files) {
    EXPECT_NO_THROW(decoded(file));
    for (std::size_t length = 0; length < file.size(); ++length)
      EXPECT_NE(errorIn(file.substr(0, length)), "") << length << " of " << file.size();
  }
}

}  // namespace
}  // namespace isophote

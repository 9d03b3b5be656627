// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/hdr.h"

#include "base/error.h"
#include "image/exr.h"
#include "image/radiance.h"
#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace isophote {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kBudget = 64u << 20;

std::span<const std::byte> bytesOf(const std::string& text) { return std::as_bytes(std::span(text)); }
Image decoded(const std::string& file) { return decodeHdr(bytesOf(file), "sky", kBudget); }
std::string errorIn(const std::string& file) {
  return errorOf([&] { decodeHdr(bytesOf(file), "sky", kBudget); });
}
std::string errorWithin(std::uint64_t budget, const std::string& file) {
  return errorOf([&] { decodeHdr(bytesOf(file), "sky", budget); }, ErrorKind::kResources);
}

std::string header(const std::string& size, const std::string& lines = "FORMAT=32-bit_rle_rgbe\n") {
  return "#?RADIANCE\n# made by a test\n" + lines + "\n" + size + "\n";
}

std::string texel(int r, int g, int b, int e) { return {char(r), char(g), char(b), char(e)}; }

/// A line of one colour of the newer kind: a run for each component.
std::string run(int length, const std::string& colour) {
  std::string line = {2, 2, char(length >> 8), char(length & 255)};
  for (const char component : colour)
    for (int left = length; left > 0; left -= 127) line += {char(128 + std::min(left, 127)), component};
  return line;
}

TEST(Hdr, ReadsPlainTexels) {
  const Image image =
      decoded(header("-Y 1 +X 3") + texel(128, 64, 0, 129) + texel(255, 1, 2, 136) + texel(9, 9, 9, 0));
  ASSERT_EQ(image.width, 3);
  ASSERT_EQ(image.height, 1);
  EXPECT_EQ(image.at(0, 0), vec3(1.0f, 0.5f, 0.0f));
  EXPECT_EQ(image.at(1, 0), vec3(255.0f, 1.0f, 2.0f));
  EXPECT_EQ(image.at(2, 0), vec3(0.0f)) << "no exponent: black";
}

TEST(Hdr, ReadsBothRunLengthCodes) {
  const std::string white = texel(128, 128, 128, 129);
  // The newer: 200 texels in runs, then plain stretches.
  std::string mixed = {2, 2, 0, 10};
  for (const int value : {128, 64, 32})
    mixed += {char(128 + 4), char(value), 6, char(value), 0, 0, 0, 0, char(value)};
  mixed += {char(128 + 10), char(129)};
  const Image newer = decoded(header("-Y 1 +X 10") + mixed);
  EXPECT_EQ(newer.at(0, 0), vec3(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(newer.at(4, 0), vec3(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(newer.at(5, 0), vec3(0.0f));
  EXPECT_EQ(newer.at(9, 0), vec3(1.0f, 0.5f, 0.25f));
  const Image wide = decoded(header("-Y 2 +X 300") + run(300, white) + run(300, texel(64, 0, 0, 129)));
  EXPECT_EQ(wide.at(299, 0), vec3(1.0f));
  EXPECT_EQ(wide.at(0, 1), vec3(0.5f, 0.0f, 0.0f));
  // The older: 1 + 44 + 256 * 1 = 301 texels.
  const Image older =
      decoded(header("-Y 1 +X 302") + white + texel(1, 1, 1, 44) + texel(1, 1, 1, 1) + texel(128, 0, 0, 129));
  EXPECT_EQ(older.at(300, 0), vec3(1.0f));
  EXPECT_EQ(older.at(301, 0), vec3(1.0f, 0.0f, 0.0f));
}

TEST(Hdr, PutsEveryOrderUpright) {
  // Four texels of a 2 x 2 picture, as the first order has them: a b / c d.
  const std::string a = texel(128, 0, 0, 129), b = texel(0, 128, 0, 129), c = texel(0, 0, 128, 129),
                    d = texel(128, 128, 128, 129);
  const Image expected = decoded(header("-Y 2 +X 2") + a + b + c + d);
  EXPECT_EQ(expected.at(1, 0), vec3(0.0f, 1.0f, 0.0f));
  const std::pair<const char*, std::string> orders[] = {
      {"-Y 2 -X 2", b + a + d + c}, {"+Y 2 +X 2", c + d + a + b}, {"+Y 2 -X 2", d + c + b + a},
      {"+X 2 -Y 2", a + c + b + d}, {"-X 2 -Y 2", b + d + a + c}, {"+X 2 +Y 2", c + a + d + b},
      {"-X 2 +Y 2", d + b + c + a}};
  for (const auto& [size, texels] : orders)
    EXPECT_EQ(decoded(header(size) + texels).pixels, expected.pixels) << size;
  const Image tall = decoded(header("+X 1 -Y 2") + a + b);
  EXPECT_EQ(tall.width, 1);
  EXPECT_EQ(tall.at(0, 1), vec3(0.0f, 1.0f, 0.0f));
}

TEST(Hdr, DividesEveryExposureOut) {
  EXPECT_EQ(decoded(header("-Y 1 +X 1", "EXPOSURE=2\nEXPOSURE= 4.0\r\n") + texel(128, 0, 0, 129)).at(0, 0).x,
            0.125f);
  EXPECT_THAT(errorIn(header("-Y 1 +X 1", "EXPOSURE=0\n") + texel(128, 0, 0, 129)),
              HasSubstr("EXPOSURE of 0"));
  EXPECT_THAT(errorIn(header("-Y 1 +X 1", "EXPOSURE=nan\n") + texel(128, 0, 0, 129)), HasSubstr("EXPOSURE"));
}

TEST(Hdr, NamesWhatIsWrong) {
  EXPECT_THAT(errorIn("#?RGBE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234"), HasSubstr("32-bit_rle_xyze"));
  EXPECT_THAT(errorIn(header("-Y 0 +X 1") + "1234"), HasSubstr("a side of 0 pixels"));
  EXPECT_THAT(errorIn(header("-Y 99999999999 +X 1") + "1234"), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(errorIn(header("-Y 1 +X") + "1234"), HasSubstr("a side of no pixels"));
  for (const char* size : {"-Y 1 +Y 1", "Y 1 X 1", "-Z 1 +X 1", "*Y 1 +X 1"})
    EXPECT_THAT(errorIn(header(size) + "1234"), HasSubstr("damaged")) << size;
  EXPECT_THAT(errorWithin(kBudget, header("-Y 60000 +X 60000") + std::string(1000, 'x')),
              HasSubstr("where 67108864 are allowed"));
  EXPECT_THAT(errorIn(header("-Y 2000 +X 1000") + std::string(1000, 'x')),
              HasSubstr("declares 1000 x 2000 pixels"));
  EXPECT_THAT(errorWithin(47, header("-Y 2 +X 2") + std::string(16, 'x')),
              HasSubstr("48 bytes where 47 are allowed"));
  EXPECT_THAT(errorIn("P6 1 1 255 abc"), HasSubstr("not a Radiance picture"));
}

TEST(Hdr, RefusesRunsThatLeaveTheirLine) {
  const std::string rest(100, 'x');
  const auto line = [](std::initializer_list<int> codes) {
    std::string text = {2, 2, 0, 8};
    for (const int code : codes) text += char(code);
    return text;
  };
  const std::string start = header("-Y 1 +X 8");
  EXPECT_THAT(errorIn(start + line({128 + 9, 1}) + rest), HasSubstr("damaged")) << "a run too long";
  EXPECT_THAT(errorIn(start + line({128 + 7, 1, 2, 1, 1}) + rest), HasSubstr("damaged"))
      << "a stretch too long";
  EXPECT_THAT(errorIn(start + line({0}) + rest), HasSubstr("damaged")) << "a stretch of nothing";
  EXPECT_THAT(errorIn(start + std::string{2, 2, 0, 9} + rest), HasSubstr("damaged")) << "another length";
  EXPECT_THAT(errorIn(start + texel(1, 1, 1, 8) + rest), HasSubstr("damaged")) << "nothing to repeat";
  EXPECT_THAT(errorIn(start + texel(9, 9, 9, 9) + texel(1, 1, 1, 8) + rest), HasSubstr("damaged"));
}

TEST(Hdr, RefusesEveryTruncation) {
  const std::string white = texel(128, 128, 128, 129);
  const std::string files[] = {
      header("-Y 2 +X 300") + run(300, white) + run(300, white),
      header("-Y 2 +X 4") + white + texel(1, 1, 1, 3) + white + white + white + white};
  for (const std::string& file : files) {
    EXPECT_NO_THROW(decoded(file));
    for (std::size_t length = 0; length < file.size(); ++length)
      EXPECT_NE(errorIn(file.substr(0, length)), "") << length << " of " << file.size();
  }
}

TEST(Radiance, ReadsFloatPicturesWithUsableValues) {
  const std::string hdr = header("-Y 1 +X 1") + texel(255, 128, 0, 255);
  EXPECT_TRUE(holdsRadiance(bytesOf(hdr)));
  EXPECT_EQ(decodeRadiance(bytesOf(hdr), "sky", kBudget).at(0, 0), vec3(1e9f, 1e9f, 0.0f));
  Film film;
  film.colour = Image(2, 1);
  const float infinity = std::numeric_limits<float>::infinity();
  film.colour.pixels = {vec3(infinity, -infinity, std::nanf("")), vec3(-1.0f, 2.5f, 0.0f)};
  const std::vector<std::uint8_t> exr = encodeExr(film);
  EXPECT_TRUE(holdsRadiance(std::as_bytes(std::span(exr))));
  const Image image = decodeRadiance(std::as_bytes(std::span(exr)), "sky", kBudget);
  EXPECT_EQ(image.at(0, 0), vec3(65504.0f, 0.0f, 0.0f));
  EXPECT_EQ(image.at(1, 0), vec3(0.0f, 2.5f, 0.0f));
  EXPECT_FALSE(holdsRadiance(bytesOf("\x89PNG\r\n\x1a\n")));
  EXPECT_THAT(errorOf([] { decodeRadiance(bytesOf("GIF89a"), "sky", kBudget); }),
              HasSubstr("is a GIF file; a picture of radiance must be OpenEXR or Radiance HDR"));
}

}  // namespace
}  // namespace isophote

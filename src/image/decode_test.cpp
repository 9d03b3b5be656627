// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/decode.h"

#include "base/error.h"
#include "image/png.h"
#include "support/encoded_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>

namespace isophote {
namespace {

constexpr std::uint64_t kBudget = 64u << 20;

Bytes bytesOf(std::string_view text) {
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

/// The sentence of the Error that decoding gives; empty if it succeeds.
std::string errorOf(std::span<const std::byte> bytes, std::uint64_t budget = kBudget) {
  try {
    decodeImage(bytes, "picture", budget);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

std::vector<std::uint8_t> noise(std::size_t count) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> values(count);
  for (auto& value : values) value = std::uint8_t(random() >> 24);
  return values;
}

TEST(Decode, PngRoundTripIsExact) {
  const int width = 37, height = 23;
  const std::vector<std::uint8_t> rgb = noise(std::size_t(width * height * 3));
  const std::vector<std::uint8_t> png = encodePng(width, height, rgb);
  const DecodedImage image = decodeImage(std::as_bytes(std::span(png)), "picture", kBudget);
  ASSERT_EQ(image.width, width);
  ASSERT_EQ(image.height, height);
  for (std::size_t i = 0; i < std::size_t(width * height); ++i) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(image.rgba[4 * i + c], rgb[3 * i + c]);
    ASSERT_EQ(image.rgba[4 * i + 3], 255);
  }
}

TEST(Decode, PngOfEveryKindBecomesRgba8) {
  using Pixels = LargeVector<std::uint8_t>;
  const auto decoded = [](const Bytes& bytes) { return decodeImage(bytes, "picture", kBudget).rgba; };
  // One bit a pixel: 0b10... is white, then black.
  EXPECT_EQ(decoded(makePng(2, {{0x80}}, {1, PNG_COLOR_TYPE_GRAY})),
            (Pixels{255, 255, 255, 255, 0, 0, 0, 255}));
  EXPECT_EQ(decoded(makePng(1, {{77}}, {8, PNG_COLOR_TYPE_GRAY})), (Pixels{77, 77, 77, 255}));
  EXPECT_EQ(decoded(makePng(1, {{77, 9}}, {8, PNG_COLOR_TYPE_GRAY_ALPHA})), (Pixels{77, 77, 77, 9}));
  EXPECT_EQ(decoded(makePng(1, {{1, 2, 3, 4}}, {8, PNG_COLOR_TYPE_RGB_ALPHA})), (Pixels{1, 2, 3, 4}));
  // 16 bits are rounded: 0x0080 / 257 = 0.498 is 0, 0x0081 / 257 = 0.502 is 1, 0xfffe / 257 = 254.996 is 255.
  EXPECT_EQ(decoded(makePng(1, {{0x00, 0x80, 0x00, 0x81, 0xff, 0xfe}}, {16, PNG_COLOR_TYPE_RGB})),
            (Pixels{0, 1, 255, 255}));
  PngOptions palette{8, PNG_COLOR_TYPE_PALETTE};
  palette.palette = {{10, 20, 30}, {40, 50, 60}};
  palette.paletteAlpha = {128};
  EXPECT_EQ(decoded(makePng(2, {{1, 0}}, palette)), (Pixels{40, 50, 60, 255, 10, 20, 30, 128}));
}

TEST(Decode, InterlacedPngIsPutTogether) {
  std::vector<std::vector<png_byte>> rows;
  for (int y = 0; y < 11; ++y) {
    rows.emplace_back();
    for (int x = 0; x < 13; ++x) rows.back().push_back(png_byte(y * 16 + x));
  }
  const DecodedImage image =
      decodeImage(makePng(13, rows, {8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7}), "picture", kBudget);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 13; ++x) ASSERT_EQ(image.rgba[std::size_t(4 * (y * 13 + x))], y * 16 + x);
  }
}

// One colour survives the cosine transform up to its rounding: 1 from the colour transform, 1 from the
// coefficients.
void expectColour(const DecodedImage& image, std::array<int, 3> colour) {
  ASSERT_EQ(image.rgba.size(), std::size_t(image.width * image.height * 4));
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(image.rgba[i + c], colour[c], 2) << "channel " << c;
    ASSERT_EQ(image.rgba[i + 3], 255);
  }
}

TEST(Decode, JpegOfEveryKindBecomesRgba8) {
  const auto decoded = [](const Bytes& bytes) { return decodeImage(bytes, "picture", kBudget); };
  expectColour(decoded(makeJpeg(19, 21, {200, 100, 50}, {})), {200, 100, 50});
  expectColour(decoded(makeJpeg(19, 21, {200, 100, 50}, {JCS_RGB, 3, true})), {200, 100, 50});
  expectColour(decoded(makeJpeg(19, 21, {77}, {JCS_GRAYSCALE, 1})), {77, 77, 77});
  // Inks of 0, 51/255 = 0.2 and 102/255 = 0.4 with black 0.5: red is 1 * 0.5, green 0.8 * 0.5, blue 0.6 *
  // 0.5.
  expectColour(decoded(makeJpeg(19, 21, {0, 51, 102, 128}, {JCS_CMYK, 4, false, false})), {127, 102, 76});
  // The same inks as Adobe writes them, inverted.
  expectColour(decoded(makeJpeg(19, 21, {255, 204, 153, 127}, {JCS_CMYK, 4})), {127, 102, 76});
}

TEST(Decode, NamesWhatItCannotRead) {
  using namespace std::string_view_literals;
  EXPECT_EQ(errorOf({}), "picture: is empty; a picture must be PNG, JPEG or TGA");
  EXPECT_EQ(errorOf(bytesOf("RIFF\x10\0\0\0WEBPVP8 "sv)),
            "picture: is a WebP file, which is not supported here; convert it to PNG, JPEG or TGA");
  EXPECT_EQ(formatOf(bytesOf("\xabKTX 20\xbb\r\n\x1a\n"sv)), "KTX2");
  EXPECT_EQ(formatOf(bytesOf("#?RADIANCE\n"sv)), "Radiance HDR");
  EXPECT_EQ(formatOf(bytesOf("\0\0\2\0\0\0\0\0\0\0\0\0\x10\0\x10\0\x18\0"sv)), "TGA");
  EXPECT_EQ(formatOf(bytesOf("hello, world, this is text"sv)), "");
  EXPECT_EQ(errorOf(bytesOf("hello, world, this is text"sv)),
            "picture: is not a picture of a known format; PNG, JPEG and TGA can be read");
  EXPECT_NE(errorOf(bytesOf("version https://git-lfs.github.com/spec/v1\n"sv)).find("git lfs pull"),
            std::string::npos);
}

TEST(Decode, RefusesSizesOverTheBudgetBeforeAllocating) {
  const Bytes png = makePng(100, std::vector(100, std::vector<png_byte>(300)), {});
  EXPECT_EQ(errorOf(png, 40000), "");
  EXPECT_EQ(errorOf(png, 39999),
            "picture: is a PNG of 100 x 100 pixels, which takes 40000 bytes where 39999 are allowed");
  EXPECT_EQ(errorOf(makeJpeg(100, 100, {1, 2, 3}, {}), 39999),
            "picture: is a JPEG of 100 x 100 pixels, which takes 40000 bytes where 39999 are allowed");
  // A progressive file also needs 16-bit coefficients of its three components: 10000 * (4 + 6) bytes.
  EXPECT_EQ(errorOf(makeJpeg(100, 100, {1, 2, 3}, {JCS_RGB, 3, true}), 99999),
            "picture: is a JPEG of 100 x 100 pixels, which takes 100000 bytes where 99999 are allowed");
}

TEST(Decode, RefusesSizesThatTheFileCannotHold) {
  // Height in the header of the JPEG, after ff c0, length and precision, set to 65500.
  Bytes jpeg = makeJpeg(1000, 8, {1, 2, 3}, {});
  const std::array startOfFrame{std::byte{0xff}, std::byte{0xc0}};
  auto frame = std::search(jpeg.begin(), jpeg.end(), startOfFrame.begin(), startOfFrame.end());
  ASSERT_NE(frame, jpeg.end());
  frame[5] = std::byte{0xff};
  frame[6] = std::byte{0xdc};
  EXPECT_NE(errorOf(jpeg, std::uint64_t(1) << 40).find("1000 x 65500 pixels but holds only"),
            std::string::npos);
  const Bytes png = makePng(64, std::vector(64, std::vector<png_byte>(192)), {});
  EXPECT_NE(errorOf(std::span(png).first(60)), "");
}

/// Every damaged copy must either decode or end in an Error of bad input or resources; anything else (a
/// crash, another exception, a hang) fails the test.
void expectSurvivesDamage(const Bytes& whole) {
  for (std::size_t length = 0; length < whole.size(); length += length < 64 ? 1 : 97) {
    const std::string error = errorOf(std::span(whole).first(length));
    // Only the last bytes, an end marker, may be missing without loss of pixels.
    const bool pixelsMissing = length + 24 < whole.size();
    EXPECT_TRUE(!pixelsMissing || !error.empty()) << "of " << whole.size() << " bytes only " << length;
  }
  std::mt19937 random(11);
  for (int trial = 0; trial < 400; ++trial) {
    Bytes damaged = whole;
    const int flips = 1 + int(random() % 8);
    for (int i = 0; i < flips; ++i) damaged[random() % damaged.size()] ^= std::byte(1u << (random() % 8));
    // Half of the trials damage the head, where the sizes are.
    if (trial % 2) damaged[8 + random() % 56] = std::byte(random() & 255u);
    errorOf(damaged);
  }
}

TEST(Decode, DamagedPngNeverCrashes) {
  const std::vector<std::uint8_t> png = encodePng(61, 47, noise(61 * 47 * 3));
  const auto bytes = std::as_bytes(std::span(png));
  expectSurvivesDamage(Bytes(bytes.begin(), bytes.end()));
  std::vector<std::vector<png_byte>> rows(40, std::vector<png_byte>(40, 200));
  expectSurvivesDamage(makePng(40, rows, {8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7}));
}

TEST(Decode, DamagedJpegNeverCrashes) {
  expectSurvivesDamage(makeJpeg(120, 90, {200, 100, 50}, {}));
  expectSurvivesDamage(makeJpeg(120, 90, {200, 100, 50}, {JCS_RGB, 3, true}));
  expectSurvivesDamage(makeJpeg(120, 90, {0, 51, 102, 128}, {JCS_CMYK, 4}));
}

}  // namespace
}  // namespace isophote

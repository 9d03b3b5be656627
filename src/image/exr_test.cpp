// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/exr.h"

#include "base/error.h"
#include "base/files.h"
#include "base/stats.h"

#include <gtest/gtest.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <random>
#include <string>

namespace isophote {
namespace {

namespace imf = OPENEXR_IMF_NAMESPACE;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kBudget = 64u << 20;

class TemporaryFile {
 public:
  explicit TemporaryFile(std::string_view name)
      : path_(std::filesystem::path(testing::TempDir()) /
              fmt::format("isophote_exr_{}_{}.exr", name, getpid())) {}
  ~TemporaryFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

Film decoded(const Bytes& bytes, std::uint64_t budget = kBudget) {
  return decodeExr(std::as_bytes(std::span(bytes)), "film", budget);
}

/// The sentence of the Error that decoding gives; empty if it succeeds.
std::string errorOf(std::span<const std::uint8_t> bytes, std::uint64_t budget = kBudget) {
  try {
    decodeExr(std::as_bytes(bytes), "film", budget);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

Image noise(int width, int height, unsigned seed, bool grey = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-1.0f, 30.0f);
  Image image(width, height);
  for (vec3& pixel : image.pixels)
    pixel = grey ? vec3(value(random)) : vec3(value(random), value(random), value(random));
  return image;
}

Film testFilm(int width, int height) {
  Film film;
  film.colour = noise(width, height, 1);
  film.layers["direct"] = noise(width, height, 2);
  film.layers["normal"] = noise(width, height, 3);
  film.layers["depth"] = noise(width, height, 4, true);
  film.layers["density"] = noise(width, height, 5, true);
  film.metadata = {{"photons", "20000"}, {"settings", "{\"a\": 1}\n"}, {"note", ""}};
  return film;
}

struct ForeignChannel {
  const char* name;
  imf::PixelType type;
  float first;  ///< The pixel (x, y) of the data window holds first + x + 100 y.
};

struct ForeignOptions {
  imf::Compression compression = imf::ZIP_COMPRESSION;
  bool tiled = false;
};

/// A file as other programs write it.
Bytes makeForeign(const IMATH_NAMESPACE::Box2i& display, const IMATH_NAMESPACE::Box2i& data,
                  const std::vector<ForeignChannel>& channels, const ForeignOptions& options = {}) {
  const TemporaryFile file("foreign");
  const int width = data.max.x - data.min.x + 1, height = data.max.y - data.min.y + 1;
  imf::Header header(display, data);
  header.compression() = options.compression;
  imf::FrameBuffer frame;
  // Every type is stored in 4 bytes a pixel; a half takes the first two.
  std::vector<std::vector<std::uint32_t>> planes;
  for (const ForeignChannel& channel : channels) {
    header.channels().insert(channel.name, imf::Channel(channel.type));
    auto& plane = planes.emplace_back(std::size_t(width * height));
    for (int i = 0; i < width * height; ++i) {
      const float value = channel.first + float(i % width) + 100.0f * float(i / width);
      const auto whole = std::uint32_t(value);
      const half small = value;
      auto* to = &plane[std::size_t(i)];
      if (channel.type == imf::UINT) std::memcpy(to, &whole, sizeof(whole));
      if (channel.type == imf::FLOAT) std::memcpy(to, &value, sizeof(value));
      if (channel.type == imf::HALF) std::memcpy(to, &small, sizeof(small));
    }
    frame.insert(channel.name, imf::Slice::Make(channel.type, plane.data(), data, 4, 4 * std::size_t(width)));
  }
  if (options.tiled) {
    header.setTileDescription(imf::TileDescription(8, 4));
    imf::TiledOutputFile output(file.path().c_str(), header, 0);
    output.setFrameBuffer(frame);
    output.writeTiles(0, output.numXTiles() - 1, 0, output.numYTiles() - 1);
  } else {
    imf::OutputFile output(file.path().c_str(), header, 0);
    output.setFrameBuffer(frame);
    output.writePixels(height);
  }
  const std::string bytes = [&] { return readFile(file.path()); }();
  return Bytes(bytes.begin(), bytes.end());
}

IMATH_NAMESPACE::Box2i box(int x0, int y0, int x1, int y1) { return {{x0, y0}, {x1, y1}}; }

TEST(Exr, RoundTripIsExact) {
  const Film film = testFilm(37, 29);
  const Film read = decoded(encodeExr(film));
  EXPECT_EQ(read.colour.width, 37);
  EXPECT_EQ(read.colour.pixels, film.colour.pixels);
  ASSERT_EQ(read.layers.size(), film.layers.size());
  for (const auto& [name, image] : film.layers) EXPECT_EQ(read.layers.at(name).pixels, image.pixels) << name;
  auto sorted = film.metadata;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(read.metadata, sorted);
}

TEST(Exr, NonFiniteValuesSurvive) {
  Film film;
  film.colour = Image(2, 1, vec3(std::numeric_limits<float>::infinity()));
  film.colour.at(1, 0) = vec3(std::numeric_limits<float>::quiet_NaN());
  const Film read = decoded(encodeExr(film));
  EXPECT_EQ(read.colour.at(0, 0).x, std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(read.colour.at(1, 0).y));
}

TEST(Exr, ChannelsFollowTheConventions) {
  const TemporaryFile file("channels");
  writeFileAtomically(file.path(), encodeExr(testFilm(5, 4)));
  const imf::InputFile input(file.path().c_str(), 0);
  std::vector<std::string> names;
  for (auto it = input.header().channels().begin(); it != input.header().channels().end(); ++it) {
    names.push_back(it.name());
    EXPECT_EQ(it.channel().type, imf::FLOAT);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"B", "G", "R", "density.Y", "depth.Z", "direct.B", "direct.G",
                                             "direct.R", "normal.X", "normal.Y", "normal.Z"}));
  // Nothing about time, host or program.
  std::vector<std::string> attributes;
  for (auto it = input.header().begin(); it != input.header().end(); ++it) attributes.push_back(it.name());
  EXPECT_EQ(attributes,
            (std::vector<std::string>{"channels", "compression", "dataWindow", "displayWindow",
                                      "isophote.note", "isophote.photons", "isophote.settings", "lineOrder",
                                      "pixelAspectRatio", "screenWindowCenter", "screenWindowWidth"}));
}

/// What the library itself writes in one go.
Bytes writtenAgain(const Bytes& bytes) {
  const TemporaryFile first("first"), second("second");
  writeFileAtomically(first.path(), bytes);
  {
    imf::InputFile input(first.path().c_str(), 0);
    EXPECT_TRUE(input.isComplete());
    const auto window = input.header().dataWindow();
    const int width = window.max.x + 1, height = window.max.y + 1;
    std::vector<std::vector<float>> planes;
    imf::FrameBuffer frame;
    for (auto it = input.header().channels().begin(); it != input.header().channels().end(); ++it) {
      auto& plane = planes.emplace_back(std::size_t(width * height));
      frame.insert(it.name(), imf::Slice::Make(imf::FLOAT, plane.data(), window, 4, 4 * std::size_t(width)));
    }
    input.setFrameBuffer(frame);
    input.readPixels(0, height - 1);
    imf::OutputFile output(second.path().c_str(), input.header(), 0);
    output.setFrameBuffer(frame);
    output.writePixels(height);
  }
  const std::string again = readFile(second.path());
  return Bytes(again.begin(), again.end());
}

TEST(Exr, BandsJoinToTheFileThatTheLibraryWrites) {
  for (const int height : {1, 16, 63, 64, 65, 200}) {
    const Bytes bytes = encodeExr(testFilm(21, height));
    EXPECT_TRUE(bytes == writtenAgain(bytes)) << "height " << height;
  }
}

TEST(Exr, TheSameFilmGivesTheSameBytes) {
  EXPECT_EQ(encodeExr(testFilm(64, 48)), encodeExr(testFilm(64, 48)));
}

TEST(Exr, ReadsHalfFloatAndUintInEveryCompression) {
  for (const auto compression : {imf::NO_COMPRESSION, imf::RLE_COMPRESSION, imf::ZIPS_COMPRESSION,
                                 imf::ZIP_COMPRESSION, imf::PIZ_COMPRESSION}) {
    for (const bool tiled : {false, true}) {
      const Bytes bytes =
          makeForeign(box(0, 0, 19, 8), box(0, 0, 19, 8),
                      {{"R", imf::HALF, 1}, {"G", imf::FLOAT, 2}, {"B", imf::UINT, 3}, {"A", imf::HALF, 9}},
                      {compression, tiled});
      const Film film = decoded(bytes);
      EXPECT_TRUE(film.layers.empty());
      // 7 + 100 * 8 = 807 is exact in half precision.
      EXPECT_EQ(film.colour.at(7, 8), vec3(808.0f, 809.0f, 810.0f)) << "compression " << compression;
    }
  }
}

TEST(Exr, ReadsAnyArrangementOfChannels) {
  const auto read = [](const std::vector<ForeignChannel>& channels) {
    return decoded(makeForeign(box(0, 0, 3, 1), box(0, 0, 3, 1), channels));
  };
  EXPECT_EQ(read({{"Y", imf::HALF, 5}}).colour.at(1, 0), vec3(6.0f));

  const Film depth = read({{"Y", imf::FLOAT, 5}, {"Z", imf::FLOAT, 7}});
  EXPECT_EQ(depth.colour.at(0, 0), vec3(5.0f));
  EXPECT_EQ(depth.layers.at("depth").at(1, 1), vec3(108.0f));

  // The first layer with colours is the picture where none is without a name.
  const Film layers = read({{"Scene.Combined.R", imf::HALF, 1},
                            {"Scene.Combined.G", imf::HALF, 2},
                            {"Scene.Combined.B", imf::HALF, 3},
                            {"Scene.Combined.A", imf::HALF, 4},
                            {"Scene.Also.V", imf::FLOAT, 5},
                            {"Scene.Motion.X", imf::FLOAT, 6},
                            {"Scene.Motion.Y", imf::FLOAT, 7},
                            {"Scene.Motion.W", imf::FLOAT, 8}});
  EXPECT_EQ(layers.colour.at(0, 0), vec3(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(layers.layers.at("Scene.Combined").at(0, 0), vec3(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(layers.layers.at("Scene.Also").at(0, 0), vec3(5.0f));
  EXPECT_EQ(layers.layers.at("Scene.Motion").at(0, 0), vec3(6.0f, 7.0f, 0.0f));
  EXPECT_EQ(layers.layers.at("Scene.Motion.W").at(0, 0), vec3(8.0f));
  EXPECT_EQ(layers.layers.size(), 4u);
}

TEST(Exr, DataWindowIsPlacedInTheDisplayWindow) {
  // The data covers x 8..11, y 21..22 of a picture with corners (10, 20) and (14, 23): two columns fall off
  // its left.
  const Film film = decoded(makeForeign(box(10, 20, 14, 23), box(8, 21, 11, 22), {{"Y", imf::FLOAT, 1}}));
  ASSERT_EQ(film.colour.width, 5);
  ASSERT_EQ(film.colour.height, 4);
  EXPECT_EQ(film.colour.at(0, 1).x, 3.0f);    // (10, 21) is data pixel (2, 0).
  EXPECT_EQ(film.colour.at(1, 2).x, 104.0f);  // (11, 22) is data pixel (3, 1).
  EXPECT_EQ(film.colour.at(2, 1).x, 0.0f);
  EXPECT_EQ(film.colour.at(0, 0).x, 0.0f);
  EXPECT_EQ(film.colour.at(0, 3).x, 0.0f);
}

TEST(Exr, RefusesWhatItCannotRead) {
  Bytes bytes = encodeExr(testFilm(8, 8));
  EXPECT_EQ(errorOf(Bytes{1, 2, 3}), "film: is not an OpenEXR file");
  bytes[5] = 0x10;
  EXPECT_NE(errorOf(bytes).find("several parts"), std::string::npos);
  bytes[5] = 0x08;
  EXPECT_NE(errorOf(bytes).find("deep"), std::string::npos);
}

TEST(Exr, RefusesSizesBeforeAllocating) {
  Film film;
  film.colour = Image(1000, 1000);
  const Bytes bytes = encodeExr(film);
  EXPECT_NE(errorOf(bytes, 4u << 20).find("are allowed"), std::string::npos);
  // The data window's xMax, after name, type and size, xMin and yMin: 2^28 pixels a row in a file of some
  // kilobytes.
  Bytes wide = bytes;
  const std::string_view key("dataWindow\0box2i\0", 17);
  const auto found = std::search(wide.begin(), wide.end(), key.begin(), key.end());
  ASSERT_NE(found, wide.end());
  found[17 + 4 + 8 + 3] = 0x10;
  EXPECT_NE(errorOf(wide, std::uint64_t(1) << 50).find("the file is damaged or truncated"),
            std::string::npos);
  // An attribute that claims two gigabytes.
  Bytes large = encodeExr(testFilm(8, 8));
  const std::string_view name("isophote.note\0string\0", 21);
  const auto note = std::search(large.begin(), large.end(), name.begin(), name.end());
  ASSERT_NE(note, large.end());
  note[21 + 3] = 0x7f;
  EXPECT_EQ(errorOf(large), "film: is not a readable OpenEXR file: it is truncated");
  EXPECT_LT(peakMemoryBytes(), std::uint64_t(1) << 30);
}

/// Every damaged copy must either decode or end in an Error; anything else (a crash, another exception, a
/// hang) fails.
void expectSurvivesDamage(const Bytes& whole) {
  for (std::size_t length = 0; length < whole.size(); length += length < 600 ? 1 : 131) {
    EXPECT_NE(errorOf(std::span(whole).first(length)), "")
        << "of " << whole.size() << " bytes only " << length;
  }
  std::mt19937 random(17);
  for (int trial = 0; trial < 1500; ++trial) {
    Bytes damaged = whole;
    // Two thirds of the trials damage the header alone.
    const std::size_t reach = trial % 3 ? std::min<std::size_t>(whole.size(), 500) : whole.size();
    const int flips = 1 + int(random() % 6);
    for (int i = 0; i < flips; ++i) damaged[8 + random() % (reach - 8)] ^= std::uint8_t(1u << (random() % 8));
    errorOf(damaged);
  }
  EXPECT_LT(peakMemoryBytes(), std::uint64_t(1) << 30);
}

TEST(Exr, DamagedFilesNeverCrash) { expectSurvivesDamage(encodeExr(testFilm(33, 40))); }

TEST(Exr, DamagedFilesOfOthersNeverCrash) {
  const std::vector<ForeignChannel> channels{{"R", imf::HALF, 1}, {"G", imf::HALF, 2}, {"B", imf::FLOAT, 3}};
  for (const auto compression : {imf::NO_COMPRESSION, imf::RLE_COMPRESSION, imf::PIZ_COMPRESSION,
                                 imf::PXR24_COMPRESSION, imf::B44A_COMPRESSION, imf::DWAA_COMPRESSION}) {
    for (const bool tiled : {false, true}) {
      expectSurvivesDamage(makeForeign(box(0, 0, 30, 40), box(0, 0, 30, 40), channels, {compression, tiled}));
    }
  }
}

}  // namespace
}  // namespace isophote

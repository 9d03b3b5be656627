// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/exr_header.h"

#include "base/error.h"

#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

namespace isophote {

namespace {

constexpr std::uint32_t kTiled = 0x200, kDeep = 0x800, kMultipart = 0x1000;
constexpr std::size_t kMaxNameBytes = 255;
/// Coordinates beyond this are refused by the library too.
constexpr std::int64_t kMaxCoordinate = 1 << 29;
constexpr std::uint32_t kMaxTileSide = 1 << 14;
constexpr std::uint8_t kRle = 1, kZips = 2, kZip = 3, kPxr24 = 5, kDwab = 9;

/// Reads little-endian values off the front of the bytes; the end of the bytes is an error that names the
/// file.
class Cursor {
 public:
  Cursor(std::span<const std::byte> bytes, std::string_view subject) : rest_(bytes), subject_(subject) {}

  std::span<const std::byte> take(std::size_t count) {
    if (count > rest_.size()) failInput(subject_, "is not a readable OpenEXR file: it is truncated");
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::uint8_t byte() { return std::uint8_t(take(1)[0]); }
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 8) value |= std::uint32_t(byte()) << shift;
    return value;
  }
  std::int64_t integer() { return std::int32_t(word()); }
  std::string_view name() {
    const std::size_t most = std::min(rest_.size(), kMaxNameBytes + 1);
    const auto* text = reinterpret_cast<const char*>(rest_.data());
    const void* end = most == 0 ? nullptr : std::memchr(text, 0, most);
    if (!end) failInput(subject_, "is not a readable OpenEXR file: its header is damaged");
    const std::size_t length = std::size_t(static_cast<const char*>(end) - text);
    take(length + 1);
    return {text, length};
  }
  bool empty() const { return rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
  std::string_view subject_;
};

struct Window {
  std::int64_t width = 0;
  std::int64_t height = 0;
};

struct Tiles {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

/// What the size of a file's pixels depends on.
struct Facts {
  std::optional<Window> data;
  std::optional<Window> display;
  std::optional<Tiles> tiles;
  std::optional<std::uint8_t> compression;
  std::uint64_t bytesPerPixel = 0;
  std::size_t channels = 0;
};

class HeaderWalk {
 public:
  HeaderWalk(std::span<const std::byte> bytes, std::string_view subject)
      : cursor_(bytes, subject), subject_(subject) {}

  Facts facts() {
    cursor_.take(4);  // The magic number was seen by the caller.
    const std::uint32_t version = cursor_.word();
    if (version & kMultipart)
      failInput(subject_, "is an OpenEXR file of several parts; save one part by itself");
    if (version & kDeep) failInput(subject_, "is a deep OpenEXR file; flatten it first");
    for (std::string_view name = cursor_.name(); !name.empty(); name = cursor_.name()) {
      const std::string_view type = cursor_.name();
      const std::uint32_t size = cursor_.word();
      readAttribute(name, type, cursor_.take(size));
    }
    if (!facts_.data || !facts_.display || !facts_.compression || facts_.channels == 0) {
      failInput(subject_,
                "is not a readable OpenEXR file: its header names no channels, windows or compression");
    }
    if (bool(version & kTiled) != facts_.tiles.has_value()) damaged();
    return facts_;
  }

 private:
  [[noreturn]] void damaged() {
    failInput(subject_, "is not a readable OpenEXR file: its header is damaged");
  }

  void readAttribute(std::string_view name, std::string_view type, std::span<const std::byte> value) {
    Cursor cursor(value, subject_);
    if (name == "dataWindow") facts_.data = window(cursor);
    if (name == "displayWindow") facts_.display = window(cursor);
    if (name == "compression") facts_.compression = cursor.byte();
    if (name == "channels") readChannels(cursor);
    if (name == "tiles") readTiles(cursor);
    if (type == "preview") {
      const std::uint64_t width = cursor.word(), height = cursor.word();
      if (width > value.size() || height > value.size() || width * height * 4 + 8 != value.size()) damaged();
    }
  }

  Window window(Cursor& cursor) {
    const std::int64_t xMin = cursor.integer(), yMin = cursor.integer();
    const std::int64_t xMax = cursor.integer(), yMax = cursor.integer();
    for (const std::int64_t bound : {xMin, yMin, xMax, yMax}) {
      if (std::abs(bound) > kMaxCoordinate) damaged();
    }
    if (xMax < xMin || yMax < yMin) damaged();
    return {xMax - xMin + 1, yMax - yMin + 1};
  }

  void readChannels(Cursor& cursor) {
    for (std::string_view name = cursor.name(); !name.empty(); name = cursor.name()) {
      const std::uint32_t pixelType = cursor.word();
      cursor.word();  // Linearity and reserved bytes.
      const std::int64_t xSampling = cursor.integer(), ySampling = cursor.integer();
      if (pixelType > 2) damaged();
      if (xSampling != 1 || ySampling != 1) {
        failInput(subject_,
                  "stores channel \"{}\" at a lower resolution, which is not supported; save it as RGB",
                  name);
      }
      facts_.bytesPerPixel += pixelType == 1 ? 2 : 4;
      ++facts_.channels;
    }
    if (!cursor.empty()) damaged();
  }

  void readTiles(Cursor& cursor) {
    const Tiles tiles{cursor.word(), cursor.word()};
    if (tiles.width == 0 || tiles.height == 0 || tiles.width > kMaxTileSide || tiles.height > kMaxTileSide)
      damaged();
    facts_.tiles = tiles;
  }

  Cursor cursor_;
  std::string_view subject_;
  Facts facts_;
};

std::uint64_t linesPerChunk(std::uint8_t compression) {
  if (compression <= kZips) return 1;
  if (compression == kZip || compression == kPxr24) return 16;
  return compression == kDwab ? 256 : 32;
}

/// Most bytes of pixels that one byte of file can hold; 0 where the compression has no useful bound.
std::uint64_t maxExpansion(std::uint8_t compression) {
  switch (compression) {
    case 0:
      return 1;
    case kRle:
      return 64;  // Two bytes for a run of up to 128.
    case kZips:
    case kZip:
      return 1032;  // DEFLATE's limit.
    case kPxr24:
      return 1376;  // The same, of 24 bits for each 32.
    default:
      return 0;
  }
}

std::uint64_t chunksOf(const Facts& facts) {
  const auto count = [](std::int64_t length, std::uint64_t step) {
    return (std::uint64_t(length) + step - 1) / step;
  };
  if (!facts.tiles) return count(facts.data->height, linesPerChunk(*facts.compression));
  return count(facts.data->width, facts.tiles->width) * count(facts.data->height, facts.tiles->height);
}

}  // namespace

void requireSaneExrHeader(std::span<const std::byte> bytes, std::string_view subject,
                          std::uint64_t budgetBytes) {
  const Facts facts = HeaderWalk(bytes, subject).facts();
  const auto [width, height] = *facts.data;
  // At most 2^60 pixels; in floating point the products below cannot overflow.
  const double pixels = double(width) * double(height);
  const double stored = pixels * double(facts.bytesPerPixel);
  const double expansion = double(maxExpansion(*facts.compression));
  const bool tooShort = double(chunksOf(facts)) * 8.0 > double(bytes.size()) ||
                        (expansion > 0.0 && stored > expansion * double(bytes.size()));
  if (tooShort) {
    failInput(subject, "declares {} x {} pixels but holds only {} bytes; the file is damaged or truncated",
              width, height, bytes.size());
  }
  // Tables and buffers of the library: a row of chunks as they lie in the file and as pixels, and one tile.
  const double chunkLines = double(facts.tiles ? facts.tiles->height : linesPerChunk(*facts.compression));
  const double tileWidth = facts.tiles ? double(facts.tiles->width) : 0.0;
  const double needed = 2.0 * (double(width) + tileWidth) * chunkLines * double(facts.bytesPerPixel);
  if (needed > double(budgetBytes)) {
    fail(ErrorKind::kResources, subject, "takes up to {:.0f} bytes to read where {} are allowed", needed,
         budgetBytes);
  }
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/tga.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace isophote {

namespace {

constexpr std::size_t kHeaderBytes = 18;
/// A run-length packet covers this many pixels at most.
constexpr std::uint64_t kLongestPacket = 128;

using Rgba = std::array<std::uint8_t, 4>;

struct Header {
  std::size_t idBytes;
  bool hasMap;
  bool mapped;
  bool grey;
  bool packed;
  std::size_t mapFirst;
  std::size_t mapCount;
  unsigned mapBits;
  int width;
  int height;
  unsigned bits;       ///< Of a pixel as it is stored.
  unsigned alphaBits;  ///< As the file declares them.
  bool fromRight;
  bool fromTop;
};

class TgaReader {
 public:
  TgaReader(std::span<const std::byte> bytes, std::string_view subject) : bytes_(bytes), subject_(subject) {}

  DecodedImage read(std::uint64_t budgetBytes) {
    readHeader();
    const std::uint64_t pixels = std::uint64_t(header_.width) * std::uint64_t(header_.height);
    if (pixels * 4 > budgetBytes)
      fail(ErrorKind::kResources, subject_,
           "is a TGA of {} x {} pixels, which takes {} bytes where {} are allowed", header_.width,
           header_.height, pixels * 4, budgetBytes);
    skip(header_.idBytes);
    readMap();
    const std::uint64_t pixelBytes = (header_.bits + 7) / 8;
    const std::uint64_t fewest = header_.packed
                                     ? (pixels + kLongestPacket - 1) / kLongestPacket * (1 + pixelBytes)
                                     : pixels * pixelBytes;
    if (fewest > bytes_.size() - position_)
      failInput(subject_, "declares {} x {} pixels but holds only {} bytes; the file is damaged or truncated",
                header_.width, header_.height, bytes_.size());
    DecodedImage image;
    image.width = header_.width;
    image.height = header_.height;
    image.rgba.resize(std::size_t(pixels) * 4);
    readPixels(image, std::size_t(pixels));
    return image;
  }

 private:
  [[noreturn]] void damaged() const { failInput(subject_, "is a damaged or truncated TGA picture"); }

  unsigned byteAt(std::size_t i) const { return std::to_integer<unsigned>(bytes_[i]); }
  unsigned wordAt(std::size_t i) const { return byteAt(i) | byteAt(i + 1) << 8; }

  void skip(std::size_t count) {
    if (count > bytes_.size() - position_) damaged();
    position_ += count;
  }

  void readHeader() {
    if (bytes_.size() < kHeaderBytes) damaged();
    const unsigned type = byteAt(2), descriptor = byteAt(17);
    header_.idBytes = byteAt(0);
    header_.hasMap = byteAt(1) == 1;
    header_.packed = type >= 9;
    header_.mapped = (type & 7u) == 1;
    header_.grey = (type & 7u) == 3;
    header_.mapFirst = wordAt(3);
    header_.mapCount = header_.hasMap ? wordAt(5) : 0;
    header_.mapBits = byteAt(7);
    header_.width = int(wordAt(12));
    header_.height = int(wordAt(14));
    header_.bits = byteAt(16);
    header_.alphaBits = descriptor & 15u;
    header_.fromRight = (descriptor & 16u) != 0;
    header_.fromTop = (descriptor & 32u) != 0;
    position_ = kHeaderBytes;
    const bool typeKnown = (type >= 1 && type <= 3) || (type >= 9 && type <= 11);
    if (!typeKnown)
      failInput(subject_, "is a TGA picture of type {}; 1, 2, 3, 9, 10 and 11 can be read", type);
    if (header_.width < 1 || header_.height < 1) failInput(subject_, "is a TGA picture without pixels");
    const unsigned b = header_.bits;
    const bool bitsKnown = header_.mapped || header_.grey ? b == 8 || (b == 16 && header_.grey)
                                                          : b == 15 || b == 16 || b == 24 || b == 32;
    if (!bitsKnown) failInput(subject_, "is a TGA picture of {} bits a pixel, which cannot be read", b);
    if (header_.mapped && header_.mapCount == 0)
      failInput(subject_, "is a colour-mapped TGA picture without a colour map");
  }

  void readMap() {
    if (!header_.hasMap) return;
    const unsigned b = header_.mapBits;
    if (b != 15 && b != 16 && b != 24 && b != 32)
      failInput(subject_, "has a TGA colour map of {} bits an entry, which cannot be read", b);
    const std::size_t entryBytes = (b + 7) / 8;
    if (header_.mapCount * entryBytes > bytes_.size() - position_) damaged();
    // A map may stand beside true colour, where it means nothing.
    if (!header_.mapped) return skip(header_.mapCount * entryBytes);
    map_.reserve(header_.mapCount);
    // An entry's fourth byte is meant as alpha, whatever the picture's descriptor says of its pixels.
    for (std::size_t i = 0; i < header_.mapCount; ++i) map_.push_back(nextColour(b, b == 32));
  }

  std::uint8_t nextByte() {
    if (position_ >= bytes_.size()) damaged();
    return std::to_integer<std::uint8_t>(bytes_[position_++]);
  }

  Rgba nextColour(unsigned bits, bool hasAlpha) {
    const std::uint8_t first = nextByte(), second = nextByte();
    if (bits <= 16) {
      const unsigned word = first | unsigned(second) << 8;
      const auto five = [&](unsigned shift) {
        const unsigned v = (word >> shift) & 31u;
        return std::uint8_t(v << 3 | v >> 2);
      };
      const bool opaque = !hasAlpha || bits == 15 || (word & 0x8000u) != 0;
      return {five(10), five(5), five(0), std::uint8_t(opaque ? 255 : 0)};
    }
    const std::uint8_t red = nextByte();
    const std::uint8_t alpha = bits == 32 ? nextByte() : std::uint8_t(255);
    return {red, second, first, hasAlpha ? alpha : std::uint8_t(255)};
  }

  Rgba nextPixel() {
    if (header_.mapped) {
      const std::size_t index = nextByte();
      if (index < header_.mapFirst || index - header_.mapFirst >= map_.size()) damaged();
      return map_[index - header_.mapFirst];
    }
    if (header_.grey) {
      const std::uint8_t value = nextByte();
      const std::uint8_t alpha = header_.bits == 16 ? nextByte() : std::uint8_t(255);
      return {value, value, value, header_.alphaBits > 0 ? alpha : std::uint8_t(255)};
    }
    return nextColour(header_.bits, header_.alphaBits > 0);
  }

  /// Pixels come in the file's order; packets may reach from one row into the next.
  void readPixels(DecodedImage& image, std::size_t count) {
    const auto width = std::size_t(header_.width), height = std::size_t(header_.height);
    std::size_t i = 0;
    const auto put = [&](const Rgba& pixel) {
      const std::size_t row = i / width, column = i % width;
      const std::size_t y = header_.fromTop ? row : height - 1 - row;
      const std::size_t x = header_.fromRight ? width - 1 - column : column;
      std::memcpy(&image.rgba[(y * width + x) * 4], pixel.data(), 4);
      ++i;
    };
    if (!header_.packed) {
      while (i < count) put(nextPixel());
      return;
    }
    while (i < count) {
      const unsigned code = nextByte();
      const std::size_t length = (code & 127u) + 1;
      if (length > count - i) damaged();
      const bool run = (code & 128u) != 0;
      Rgba pixel = nextPixel();
      for (std::size_t k = 0; k < length; ++k) {
        if (k > 0 && !run) pixel = nextPixel();
        put(pixel);
      }
    }
  }

  std::span<const std::byte> bytes_;
  std::string_view subject_;
  std::size_t position_ = 0;
  Header header_{};
  std::vector<Rgba> map_;
};

}  // namespace

DecodedImage decodeTga(std::span<const std::byte> bytes, std::string_view subject,
                       std::uint64_t budgetBytes) {
  return TgaReader(bytes, subject).read(budgetBytes);
}

}  // namespace isophote

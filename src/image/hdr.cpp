// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/hdr.h"

#include "base/error.h"
#include "image/decode.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

namespace isophote {

namespace {

constexpr int kLargestSide = 1 << 16;
/// Lines of these lengths may be encoded by component; others are of the older kind.
constexpr int kFirstLongLine = 8, kFirstTooLongLine = 32768;
/// Longer lines than any that a program writes into a header.
constexpr std::size_t kLongestHeaderLine = 4096;

using Texel = std::array<std::uint8_t, 4>;

vec3 decodeTexel(const Texel& t, float scale) {
  if (t[3] == 0) return vec3(0.0f);
  const float unit = std::ldexp(scale, int(t[3]) - 136);
  return vec3(float(t[0]), float(t[1]), float(t[2])) * unit;
}

/// Where the lines of the file run: along x or y, and which way.
struct Layout {
  int lines = 0;
  int lineLength = 0;
  bool linesAreColumns = false;
  bool linesFromEnd = false;   ///< The first line is the lowest row, or the right-most column.
  bool texelsFromEnd = false;  ///< A line starts at the right, or at the bottom.

  int width() const { return linesAreColumns ? lines : lineLength; }
  int height() const { return linesAreColumns ? lineLength : lines; }
  std::size_t indexOf(int line, int i) const {
    const int across = linesFromEnd ? lines - 1 - line : line;
    const int along = texelsFromEnd ? lineLength - 1 - i : i;
    const int x = linesAreColumns ? across : along, y = linesAreColumns ? along : across;
    return std::size_t(y) * std::size_t(width()) + std::size_t(x);
  }
};

class HdrReader {
 public:
  HdrReader(std::span<const std::byte> bytes, std::string_view subject)
      : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()), subject_(subject) {}

  Image read(std::uint64_t budgetBytes) {
    readHeader();
    layout_ = parseLayout(nextLine());
    const double needed = double(layout_.width()) * double(layout_.height()) * double(sizeof(vec3));
    if (needed > double(budgetBytes))
      fail(ErrorKind::kResources, subject_,
           "is a Radiance picture of {} x {} pixels, which takes {:.0f} bytes where {} are allowed",
           layout_.width(), layout_.height(), needed, budgetBytes);
    // The shortest that a line can be: nothing is allocated for pixels that the file cannot hold.
    if (double(layout_.lines) * double(shortestLine()) > double(text_.size() - position_))
      failInput(subject_, "declares {} x {} pixels but holds only {} bytes; the file is damaged or truncated",
                layout_.width(), layout_.height(), text_.size());
    Image image(layout_.width(), layout_.height());
    std::vector<Texel> line(std::size_t(layout_.lineLength));
    for (int i = 0; i < layout_.lines; ++i) {
      readLine(line);
      for (int k = 0; k < layout_.lineLength; ++k)
        image.pixels[layout_.indexOf(i, k)] = decodeTexel(line[std::size_t(k)], scale_);
    }
    return image;
  }

 private:
  [[noreturn]] void damaged() const { failInput(subject_, "is a damaged or truncated Radiance picture"); }

  std::string_view nextLine() {
    const std::size_t end = text_.find('\n', position_);
    if (end == std::string_view::npos || end - position_ > kLongestHeaderLine) damaged();
    std::string_view line = text_.substr(position_, end - position_);
    position_ = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  void readHeader() {
    nextLine();  // The signature.
    double exposure = 1.0;
    for (std::string_view line = nextLine(); !line.empty(); line = nextLine()) {
      if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
        failInput(subject_,
                  "holds Radiance pixels of another colour space ({}); only 32-bit_rle_rgbe can be read",
                  line.substr(7));
      // Each program that changes the exposure adds a line.
      if (line.starts_with("EXPOSURE="))
        exposure *= std::strtod(std::string(line.substr(9)).c_str(), nullptr);
    }
    if (!(exposure >= 1e-12 && exposure <= 1e12))
      failInput(subject_, "has an EXPOSURE of {:g}; it must be from 1e-12 to 1e12", exposure);
    scale_ = float(1.0 / exposure);
  }

  /// "-Y 512 +X 1024": which way the lines follow each other and how many there are, then the same of the
  /// texels in them.
  Layout parseLayout(std::string_view line) const {
    const auto word = [&] {
      const std::size_t end = std::min(line.find(' '), line.size());
      std::string result(line.substr(0, end));
      line.remove_prefix(std::min(end + 1, line.size()));
      return result;
    };
    const auto count = [&] {
      const std::string digits = word();
      char* end = nullptr;
      const long value = std::strtol(digits.c_str(), &end, 10);
      if (digits.empty() || *end != '\0' || value < 1 || value > kLargestSide)
        failInput(subject_, "has a side of {} pixels; from 1 to {} are possible",
                  digits.empty() ? "no" : digits.substr(0, 20), kLargestSide);
      return int(value);
    };
    Layout layout;
    const std::string outer = word();
    layout.lines = count();
    const std::string inner = word();
    layout.lineLength = count();
    const auto known = [](const std::string& axis) {
      return axis.size() == 2 && (axis[0] == '+' || axis[0] == '-') && (axis[1] == 'X' || axis[1] == 'Y');
    };
    if (!known(outer) || !known(inner) || outer[1] == inner[1] || !line.empty()) damaged();
    // Y grows upwards there, X to the right; rows here run from the top.
    const auto fromEnd = [](const std::string& axis) { return axis == "+Y" || axis == "-X"; };
    layout.linesAreColumns = outer[1] == 'X';
    layout.linesFromEnd = fromEnd(outer);
    layout.texelsFromEnd = fromEnd(inner);
    return layout;
  }

  bool mayBeLong() const {
    return layout_.lineLength >= kFirstLongLine && layout_.lineLength < kFirstTooLongLine;
  }

  std::size_t shortestLine() const { return layout_.lineLength > 1 ? 8 : 4; }

  std::uint8_t nextByte() {
    if (position_ >= text_.size()) damaged();
    return std::uint8_t(text_[position_++]);
  }

  Texel nextTexel() {
    Texel t;
    for (std::uint8_t& byte : t) byte = nextByte();
    return t;
  }

  void readLine(std::vector<Texel>& line) {
    if (!mayBeLong()) return readPlainLine(line, nextTexel());
    const Texel start = nextTexel();
    // No texel starts so, as one mantissa is at least 128: it announces a line of the newer kind.
    if (start[0] != 2 || start[1] != 2 || start[2] >= 128) return readPlainLine(line, start);
    if ((int(start[2]) << 8 | int(start[3])) != layout_.lineLength) damaged();
    for (std::size_t component = 0; component < 4; ++component) readComponent(line, component);
  }

  /// Runs of one value (a count above 128, less 128) and stretches of plain ones, which must fill the line.
  void readComponent(std::vector<Texel>& line, std::size_t component) {
    for (std::size_t i = 0; i < line.size();) {
      const std::uint8_t code = nextByte();
      const bool run = code > 128;
      const std::size_t count = run ? std::size_t(code) - 128 : code;
      if (count == 0 || count > line.size() - i) damaged();
      const std::uint8_t repeated = run ? nextByte() : std::uint8_t(0);
      for (std::size_t k = 0; k < count; ++k) line[i++][component] = run ? repeated : nextByte();
    }
  }

  /// Texels; (1, 1, 1, n) repeats the last one n times, and of several in a row each counts 256 times as
  /// much.
  void readPlainLine(std::vector<Texel>& line, Texel next) {
    int shift = 0;
    for (std::size_t i = 0;;) {
      if (next[0] == 1 && next[1] == 1 && next[2] == 1) {
        const std::uint64_t count = std::uint64_t(next[3]) << shift;
        if (i == 0 || shift > 16 || count > line.size() - i) damaged();
        for (std::uint64_t k = 0; k < count; ++k, ++i) line[i] = line[i - 1];
        shift += 8;
      } else {
        line[i++] = next;
        shift = 0;
      }
      if (i == line.size()) return;
      next = nextTexel();
    }
  }

  std::string_view text_;
  std::string_view subject_;
  std::size_t position_ = 0;
  float scale_ = 1.0f;
  Layout layout_;
};

}  // namespace

Image decodeHdr(std::span<const std::byte> bytes, std::string_view subject, std::uint64_t budgetBytes) {
  if (formatOf(bytes) != "Radiance HDR") failInput(subject, "is not a Radiance picture");
  return HdrReader(bytes, subject).read(budgetBytes);
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/decode.h"

#include "base/error.h"
#include "image/jpeg.h"
#include "image/png.h"
#include "image/tga.h"

namespace isophote {

namespace {

using namespace std::string_view_literals;

struct Signature {
  std::size_t offset;
  std::string_view magic;
  std::string_view format;
};

// Longer signatures come before shorter ones that they start with.
constexpr Signature kSignatures[] = {
    {0, "\x89PNG\r\n\x1a\n"sv, "PNG"sv},
    {0, "\xff\xd8\xff"sv, "JPEG"sv},
    {0, "\x76\x2f\x31\x01"sv, "OpenEXR"sv},
    {0, "\xabKTX 20\xbb"sv, "KTX2"sv},
    {0, "\xabKTX 11\xbb"sv, "KTX"sv},
    {0, "DDS "sv, "DDS"sv},
    {8, "WEBP"sv, "WebP"sv},
    {0, "GIF8"sv, "GIF"sv},
    {0, "BM"sv, "BMP"sv},
    {0, "II*\0"sv, "TIFF"sv},
    {0, "MM\0*"sv, "TIFF"sv},
    {0, "8BPS"sv, "Photoshop"sv},
    {0, "#?RADIANCE"sv, "Radiance HDR"sv},
    {0, "#?RGBE"sv, "Radiance HDR"sv},
    {4, "jP  \r\n"sv, "JPEG 2000"sv},
    {0, "\xff\x0a"sv, "JPEG XL"sv},
    {4, "JXL "sv, "JPEG XL"sv},
    {4, "ftypavif"sv, "AVIF"sv},
    {4, "ftypheic"sv, "HEIC"sv},
    {0, "sB\x13\0"sv, "Basis Universal"sv},
    {0, "<svg"sv, "SVG"sv},
    {0, "<?xml"sv, "XML"sv},
    {0, "<!DOCTYPE"sv, "HTML"sv},
    {0, "version https://git-lfs"sv, "Git LFS pointer"sv},
    {0, "P5"sv, "PGM"sv},
    {0, "P6"sv, "PPM"sv},
    {0, "PF"sv, "PFM"sv},
};

std::string_view asText(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// TGA has no signature in front: version 2 ends with one, older files are told by plausible header fields.
bool looksLikeTga(std::string_view text) {
  if (text.ends_with("TRUEVISION-XFILE.\0"sv)) return true;
  if (text.size() < 18) return false;
  const auto byteAt = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned mapped = byteAt(1), type = byteAt(2), bits = byteAt(16);
  const unsigned width = byteAt(12) + 256u * byteAt(13), height = byteAt(14) + 256u * byteAt(15);
  const bool typeKnown = (type >= 1 && type <= 3) || (type >= 9 && type <= 11);
  const bool bitsKnown = bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32;
  return mapped <= 1 && typeKnown && bitsKnown && width > 0 && height > 0;
}

}  // namespace

std::string_view formatOf(std::span<const std::byte> bytes) {
  const std::string_view text = asText(bytes);
  for (const Signature& s : kSignatures) {
    if (text.size() >= s.offset && text.substr(s.offset).starts_with(s.magic)) return s.format;
  }
  return looksLikeTga(text) ? "TGA"sv : ""sv;
}

DecodedImage decodeImage(std::span<const std::byte> bytes, std::string_view subject,
                         std::uint64_t budgetBytes) {
  if (bytes.empty()) failInput(subject, "is empty; a picture must be PNG, JPEG or TGA");
  const std::string_view format = formatOf(bytes);
  if (format == "PNG") return decodePng(bytes, subject, budgetBytes);
  if (format == "JPEG") return decodeJpeg(bytes, subject, budgetBytes);
  if (format == "TGA") return decodeTga(bytes, subject, budgetBytes);
  if (format == "Git LFS pointer") {
    failInput(subject, "is a Git LFS pointer, not the picture itself; run `git lfs pull` where it came from");
  }
  if (!format.empty())
    failInput(subject, "is a {} file, which is not supported here; convert it to PNG, JPEG or TGA", format);
  failInput(subject, "is not a picture of a known format; PNG, JPEG and TGA can be read");
}

}  // namespace isophote

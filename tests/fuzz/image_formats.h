// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/files.h"
#include "fuzz/format.h"
#include "image/decode.h"
#include "image/exr.h"
#include "image/hdr.h"
#include "image/tga.h"
#include "support/encoded_pictures.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <zlib.h>

#include <filesystem>

namespace isophote::fuzz {

inline std::span<const std::byte> asBytes(const std::string& text) { return std::as_bytes(std::span(text)); }

inline std::string asText(const auto& bytes) {
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

inline void readPicture(const std::string& bytes) { decodeImage(asBytes(bytes), "input", kBudgetBytes); }

inline std::uint32_t bigEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::uint8_t(bytes[at + i]);
  return value;
}

/// Computes the check sum of each chunk anew.
inline void repairPng(std::string& bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t length = bigEndian(bytes, at);
    if (length > bytes.size() - at - 12) return;
    const auto* begin = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    const auto sum = std::uint32_t(crc32(0, begin, uInt(length + 4)));
    for (std::size_t i = 0; i < 4; ++i) bytes[at + 8 + length + i] = char(sum >> (24 - 8 * i));
    at += length + 12;
  }
}

inline Format pngFormat() {
  using namespace std::string_literals;
  std::vector<std::vector<png_byte>> rows(9, std::vector<png_byte>(64, png_byte(77)));
  for (std::size_t y = 0; y < rows.size(); ++y)
    for (std::size_t x = 0; x < 64; ++x) rows[y][x] = png_byte(x * y);
  return {"png",
          {asText(makePng(7, rows, {})), asText(makePng(7, rows, {16, PNG_COLOR_TYPE_RGB_ALPHA})),
           asText(makePng(7, rows, {16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7})),
           asText(makePng(60, rows, {1, PNG_COLOR_TYPE_GRAY})),
           asText(makePng(9, rows,
                          {4,
                           PNG_COLOR_TYPE_PALETTE,
                           PNG_INTERLACE_ADAM7,
                           std::vector<png_color>(16, png_color{1, 2, 3}),
                           {0, 128}}))},
          {"IHDR"s, "PLTE"s, "IDAT"s, "IEND"s, "tRNS"s, "sBIT"s, "bKGD"s, "hIST"s, "iCCP"s, "zTXt"s, "iTXt"s,
           "pHYs"s, "acTL"s, "\0\0\0\0IEND\xae\x42\x60\x82"s, "\0\0\0\0IDAT\x35\xaf\x06\x1e"s},
          readPicture,
          repairPng};
}

inline Format jpegFormat() {
  using namespace std::string_literals;
  return {"jpeg",
          {asText(makeJpeg(24, 17, {200, 100, 50}, {})),
           asText(makeJpeg(24, 17, {200, 100, 50}, {JCS_RGB, 3, true})),
           asText(makeJpeg(24, 17, {90}, {JCS_GRAYSCALE, 1})),
           asText(makeJpeg(24, 17, {0, 51, 102, 128}, {JCS_CMYK, 4})),
           asText(makeJpeg(24, 17, {0, 51, 102, 128}, {JCS_CMYK, 4, true, false}))},
          {"\xff\xd8"s, "\xff\xd9"s, "\xff\xc0"s, "\xff\xc1"s, "\xff\xc2"s, "\xff\xc4"s, "\xff\xc9"s,
           "\xff\xca"s, "\xff\xcc"s, "\xff\xda"s, "\xff\xdb"s, "\xff\xdd"s, "\xff\xe0"s, "\xff\xee"s,
           "\xff\xfe"s, "\xff\xd0"s, "JFIF\0"s, "Adobe"s},
          readPicture,
          {}};
}

inline Format hdrFormat() {
  using namespace std::string_literals;
  const std::string plain = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 3\n";
  std::string texels, run = "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n+X 3 +Y 20\n", old = plain;
  for (int i = 0; i < 6; ++i) texels += {char(128 + i), char(64 - i), char(7), char(126 + i)};
  for (int line = 0; line < 3; ++line) {
    run += {2, 2, 0, 20};
    for (int component = 0; component < 4; ++component) run += "\x91"s + char(100 + component) + "\3abc";
  }
  old += "\1\2\3\x7f\1\1\1\2\5\6\7\x80\1\1\1\2"s;
  return {"hdr",
          {plain + texels, run, old},
          {"#?RADIANCE\n"s, "FORMAT=32-bit_rle_rgbe\n"s, "FORMAT=32-bit_rle_xyze\n"s, "EXPOSURE=1e-3\n"s,
           "GAMMA=2.2\n"s, "\n\n-Y 3 +X 20\n"s, "-X "s, "+Y "s, "99999"s, "\2\2\0\24"s, "\1\1\1\xff"s},
          [](const std::string& bytes) { decodeHdr(asBytes(bytes), "input", kBudgetBytes); }};
}

/// A TGA file: its header of 18 bytes from what differs, then the rest.
inline std::string tgaFile(int mapLength, int type, int bits, int origin, const std::string& rest) {
  std::string header(18, '\0');
  header[1] = char(mapLength > 0);
  header[2] = char(type);
  header[5] = char(mapLength);
  header[7] = char(mapLength > 0 ? 24 : 0);
  header[12] = 7;  // width
  header[14] = 5;  // height
  header[16] = char(bits);
  header[17] = char(origin);
  return header + rest;
}

inline Format tgaFormat() {
  using namespace std::string_literals;
  std::string texels;
  for (int i = 0; i < 7 * 5 * 4; ++i) texels += char(i);
  const std::string runs = "\x86\1\2\3\4\x8d\5\6\7\x08\6"s + texels.substr(0, 28) + "\x86\1\2\3\4"s;
  return {
      "tga",
      {tgaFile(0, 2, 24, 0, texels), tgaFile(0, 2, 32, 0x28, texels), tgaFile(0, 3, 8, 0x10, texels),
       tgaFile(4, 1, 8, 0x20, std::string(12, 'm') + std::string(35, '\2')), tgaFile(0, 2, 16, 0, texels),
       tgaFile(0, 10, 32, 8, runs + runs)},
      {"TRUEVISION-XFILE.\0"s, "\x0a"s, "\x0b"s, "\x09"s, "\x20"s, "\x10"s, "\xff\xff"s, "\x80"s, "\x7f"s},
      [](const std::string& bytes) { decodeTga(asBytes(bytes), "input", kBudgetBytes); }};
}

/// A small file of half and float channels as another program writes it.
inline std::string foreignExr(OPENEXR_IMF_NAMESPACE::Compression compression,
                              const std::filesystem::path& folder) {
  namespace imf = OPENEXR_IMF_NAMESPACE;
  constexpr int kWidth = 21, kHeight = 34;
  const std::filesystem::path file = folder / "seed.exr";
  {
    imf::Header header(kWidth, kHeight);
    header.compression() = compression;
    std::vector<float> values(kWidth * kHeight);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.1f * float(i % 50);
    imf::FrameBuffer frame;
    for (const char* name : {"R", "G", "B"}) {
      header.channels().insert(name, imf::Channel(imf::HALF));
      frame.insert(name, imf::Slice(imf::HALF, reinterpret_cast<char*>(values.data()), 4, 4 * kWidth));
    }
    header.channels().insert("depth.Z", imf::Channel(imf::FLOAT));
    frame.insert("depth.Z", imf::Slice(imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 4 * kWidth));
    imf::OutputFile output(file.c_str(), header, 0);
    output.setFrameBuffer(frame);
    output.writePixels(kHeight);
  }
  std::string bytes = readFile(file);
  std::filesystem::remove(file);
  return bytes;
}

inline Format exrFormat(const std::filesystem::path& folder) {
  namespace imf = OPENEXR_IMF_NAMESPACE;
  using namespace std::string_literals;
  Format format{
      "exr",
      {},
      {"channels\0chlist\0"s, "compression\0compression\0"s, "dataWindow\0box2i\0"s,
       "displayWindow\0box2i\0"s, "lineOrder\0lineOrder\0"s, "tiles\0tiledesc\0"s, "type\0string\0"s,
       "preview\0preview\0"s, "isophote.seed\0string\0"s, "chromaticities\0chromaticities\0"s,
       "R\0\2\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0"s, "\0\0\0\0"s, "\1\0\0\0"s, "\xff\xff\xff\xff"s},
      [](const std::string& bytes) { decodeExr(asBytes(bytes), "input", kBudgetBytes); },
      {}};
  Film film;
  film.colour = Image(9, 21, vec3(0.5f));
  film.layers["normal"] = Image(9, 21, vec3(0.0f, 1.0f, 0.0f));
  film.layers["depth"] = Image(9, 21, vec3(3.0f));
  film.metadata = {{"frame.seed", "7"}};
  format.seeds.push_back(asText(encodeExr(film)));
  for (const imf::Compression compression :
       {imf::NO_COMPRESSION, imf::RLE_COMPRESSION, imf::ZIPS_COMPRESSION, imf::ZIP_COMPRESSION,
        imf::PIZ_COMPRESSION, imf::PXR24_COMPRESSION, imf::B44_COMPRESSION, imf::B44A_COMPRESSION,
        imf::DWAA_COMPRESSION, imf::DWAB_COMPRESSION})
    format.seeds.push_back(foreignExr(compression, folder));
  return format;
}

}  // namespace isophote::fuzz

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// libpng leaves on an error by longjmp, which must not skip C++ destructors. Hence every function below that
// calls setjmp holds nothing but plain values, and everything that owns memory lives in its caller.
#include "image/png.h"

#include "base/error.h"

#include <cassert>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <new>

#include <png.h>

namespace isophote {

namespace {

/// DEFLATE expands at most 1032 times: a file cannot describe more bytes of rows than this.
constexpr std::uint64_t kMaxExpansion = 1032;
/// Most that one ancillary chunk may take when it is unpacked [bytes].
constexpr png_alloc_size_t kMaxChunkBytes = 4u << 20;

struct Message {
  char text[160] = "the data is damaged";
};

[[noreturn]] void onError(png_structp png, png_const_charp text) {
  auto* message = static_cast<Message*>(png_get_error_ptr(png));
  std::snprintf(message->text, sizeof(message->text), "%s", text);
  png_longjmp(png, 1);
}

void onWarning(png_structp, png_const_charp) {}

void readBytes(png_structp png, png_bytep to, png_size_t count) {
  auto& rest = *static_cast<std::span<const std::byte>*>(png_get_io_ptr(png));
  if (count > rest.size()) png_error(png, "the file is truncated");
  std::memcpy(to, rest.data(), count);
  rest = rest.subspan(count);
}

struct Reader {
  Message message;
  std::span<const std::byte> rest;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit Reader(std::span<const std::byte> bytes) : rest(bytes) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, onError, onWarning);
    if (png) info = png_create_info_struct(png);
    if (!info) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
};

struct Header {
  png_uint_32 width;
  png_uint_32 height;
  std::uint64_t rowBytes;  ///< As stored, unpacked
};

/// False after an error, whose text is in reader.message.
bool readHeader(Reader& reader, Header& header) {
  png_structp png = reader.png;
  if (setjmp(png_jmpbuf(png))) return false;
  // Colour management, texts and the like change no pixel here, and unpacking them is only a risk.
  static constexpr png_byte kIgnored[] =
      "gAMA\0cHRM\0sRGB\0iCCP\0tEXt\0zTXt\0iTXt\0eXIf\0sPLT\0hIST\0bKGD\0tIME";
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, kIgnored, int(sizeof(kIgnored) / 5));
  png_set_chunk_malloc_max(png, kMaxChunkBytes);
  png_set_read_fn(png, &reader.rest, readBytes);
  png_read_info(png, reader.info);
  header.width = png_get_image_width(png, reader.info);
  header.height = png_get_image_height(png, reader.info);
  header.rowBytes = png_get_rowbytes(png, reader.info);
  return true;
}

/// Writes 4 * width * height bytes to `rgba`; false after an error, whose text is in reader.message.
bool readPixels(Reader& reader, const Header& header, std::uint8_t* rgba) {
  png_structp png = reader.png;
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_scale_16(png);
  png_set_expand(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xff, PNG_FILLER_AFTER);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, reader.info);
  const std::size_t stride = std::size_t(header.width) * 4;
  if (png_get_rowbytes(png, reader.info) != stride) png_error(png, "the pixel format is unknown");
  for (int pass = 0; pass < passes; ++pass) {
    for (png_uint_32 y = 0; y < header.height; ++y) png_read_row(png, rgba + y * stride, nullptr);
  }
  return true;
}

}  // namespace

DecodedImage decodePng(std::span<const std::byte> bytes, std::string_view subject,
                       std::uint64_t budgetBytes) {
  Reader reader(bytes);
  Header header{};
  if (!readHeader(reader, header)) failInput(subject, "is not a readable PNG: {}", reader.message.text);
  if (header.rowBytes * header.height > kMaxExpansion * bytes.size()) {
    failInput(subject, "is a PNG of {} x {} pixels but holds only {} bytes; the file is damaged or truncated",
              header.width, header.height, bytes.size());
  }
  const std::uint64_t needed = std::uint64_t(header.width) * header.height * 4;
  if (needed > budgetBytes) {
    fail(ErrorKind::kResources, subject,
         "is a PNG of {} x {} pixels, which takes {} bytes where {} are allowed", header.width, header.height,
         needed, budgetBytes);
  }
  DecodedImage image{int(header.width), int(header.height), LargeVector<std::uint8_t>(std::size_t(needed))};
  if (!readPixels(reader, header, image.rgba.data())) {
    failInput(subject, "is not a readable PNG: {}", reader.message.text);
  }
  return image;
}

namespace {

struct Writer {
  Message message;
  std::vector<std::uint8_t> bytes;
  bool outOfMemory = false;
  png_structp png = nullptr;
  png_infop info = nullptr;

  Writer() {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, onError, onWarning);
    if (png) info = png_create_info_struct(png);
    if (!info) {
      png_destroy_write_struct(&png, nullptr);
      throw std::bad_alloc();
    }
  }
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// An exception must not pass through libpng either: false says that memory ran out.
  bool append(const png_byte* from, std::size_t count) noexcept {
    try {
      bytes.insert(bytes.end(), from, from + count);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }
};

void writeBytes(png_structp png, png_bytep from, png_size_t count) {
  auto* writer = static_cast<Writer*>(png_get_io_ptr(png));
  if (writer->append(from, count)) return;
  writer->outOfMemory = true;
  png_error(png, "out of memory");
}

void flushNothing(png_structp) {}

bool writePixels(Writer& writer, int width, int height, const std::uint8_t* rgb) {
  png_structp png = writer.png;
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, &writer, writeBytes, flushNothing);
  png_set_IHDR(png, writer.info, png_uint_32(width), png_uint_32(height), 8, PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, writer.info);
  const std::size_t stride = std::size_t(width) * 3;
  for (int y = 0; y < height; ++y) png_write_row(png, rgb + std::size_t(y) * stride);
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::vector<std::uint8_t> encodePng(int width, int height, std::span<const std::uint8_t> rgb) {
  assert(width > 0 && height > 0 && rgb.size() == std::size_t(width) * std::size_t(height) * 3);
  Writer writer;
  if (!writePixels(writer, width, height, rgb.data())) {
    if (writer.outOfMemory) throw std::bad_alloc();
    fail(ErrorKind::kInternal, "", "a PNG of {} x {} pixels could not be encoded: {}", width, height,
         writer.message.text);
  }
  return std::move(writer.bytes);
}

}  // namespace isophote

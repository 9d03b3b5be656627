// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// libjpeg's error handler must not return, and it leaves by longjmp, which must not skip C++ destructors.
// Hence every function below that calls setjmp holds nothing but plain values, and everything that owns
// memory lives in its caller.
#include "image/jpeg.h"

#include "base/error.h"

#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>
// Needs jpeglib.h and cstdio before it.
#include <jerror.h>

namespace isophote {

namespace {

/// Huffman coding spends at least one bit on a block of 8 x 8 pixels: no file describes more pixels than this
/// a byte.
constexpr std::uint64_t kMaxPixelsPerByte = 8 * 64;
/// Each scan of a progressive file costs a walk over all pixels, and a few bytes can start one. Encoders
/// write about ten.
constexpr int kMaxScans = 200;

/// What libjpeg's callbacks know of: jpeg_error_mgr and jpeg_progress_mgr come back to us as pointers to
/// their own part.
struct ErrorManager : jpeg_error_mgr {
  std::jmp_buf jump;
  char text[JMSG_LENGTH_MAX] = "the data is damaged";
};

[[noreturn]] void onError(j_common_ptr jpeg) {
  auto* errors = static_cast<ErrorManager*>(jpeg->err);
  errors->format_message(jpeg, errors->text);
  std::longjmp(errors->jump, 1);
}

/// libjpeg calls the end of the file a warning and paints the rest grey. Other warnings are of the kind that
/// every viewer lives with.
void onMessage(j_common_ptr jpeg, int level) {
  if (level < 0 && jpeg->err->msg_code == JWRN_JPEG_EOF) onError(jpeg);
}

void onText(j_common_ptr) {}

void onProgress(j_common_ptr jpeg) {
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMaxScans) return;
  auto* errors = static_cast<ErrorManager*>(jpeg->err);
  std::snprintf(errors->text, sizeof(errors->text), "it has more than %d scans", kMaxScans);
  std::longjmp(errors->jump, 1);
}

struct Reader {
  ErrorManager errors{};
  jpeg_progress_mgr progress{};
  jpeg_decompress_struct jpeg{};

  Reader() {
    jpeg.err = jpeg_std_error(&errors);
    errors.error_exit = onError;
    errors.emit_message = onMessage;
    errors.output_message = onText;
    progress.progress_monitor = onProgress;
  }
  ~Reader() { jpeg_destroy_decompress(&jpeg); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
};

/// False after an error, whose text is in reader.errors.
bool readHeader(Reader& reader, std::span<const std::byte> bytes) {
  if (setjmp(reader.errors.jump)) return false;
  jpeg_create_decompress(&reader.jpeg);
  reader.jpeg.progress = &reader.progress;
  jpeg_mem_src(&reader.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&reader.jpeg, TRUE);
  return true;
}

/// Bytes that decoding allocates: the result, and for files of several scans the coefficients of all
/// components.
std::uint64_t bytesToDecode(jpeg_decompress_struct& jpeg) {
  const std::uint64_t pixels = std::uint64_t(jpeg.image_width) * jpeg.image_height;
  const std::uint64_t coefficients =
      jpeg_has_multiple_scans(&jpeg) ? std::uint64_t(jpeg.num_components) * 2 : 0;
  return pixels * (4 + coefficients);
}

/// Turns a row of CMYK into RGBA where it lies. Adobe's programs write the inks inverted, and say who wrote
/// the file.
void inkToColour(std::uint8_t* row, JDIMENSION width, bool inverted) {
  const std::uint8_t flip = inverted ? 0 : 255;
  for (JDIMENSION x = 0; x < width; ++x, row += 4) {
    const int white = row[3] ^ flip;
    for (int c = 0; c < 3; ++c) row[c] = std::uint8_t(((row[c] ^ flip) * white + 127) / 255);
    row[3] = 255;
  }
}

/// Writes 4 * width * height bytes to `rgba`; false after an error, whose text is in reader.errors.
bool readPixels(Reader& reader, std::uint8_t* rgba) {
  jpeg_decompress_struct& jpeg = reader.jpeg;
  if (setjmp(reader.errors.jump)) return false;
  const bool inks = jpeg.jpeg_color_space == JCS_CMYK || jpeg.jpeg_color_space == JCS_YCCK;
  jpeg.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
  jpeg_start_decompress(&jpeg);
  const std::size_t stride = std::size_t(jpeg.output_width) * 4;
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = rgba + jpeg.output_scanline * stride;
    jpeg_read_scanlines(&jpeg, &row, 1);
    if (inks) inkToColour(row, jpeg.output_width, jpeg.saw_Adobe_marker);
  }
  return true;
}

}  // namespace

DecodedImage decodeJpeg(std::span<const std::byte> bytes, std::string_view subject,
                        std::uint64_t budgetBytes) {
  Reader reader;
  if (!readHeader(reader, bytes)) failInput(subject, "is not a readable JPEG: {}", reader.errors.text);
  const std::uint64_t pixels = std::uint64_t(reader.jpeg.image_width) * reader.jpeg.image_height;
  if (!reader.jpeg.arith_code && pixels > kMaxPixelsPerByte * bytes.size()) {
    failInput(subject,
              "is a JPEG of {} x {} pixels but holds only {} bytes; the file is damaged or truncated",
              reader.jpeg.image_width, reader.jpeg.image_height, bytes.size());
  }
  const std::uint64_t needed = bytesToDecode(reader.jpeg);
  if (needed > budgetBytes) {
    fail(ErrorKind::kResources, subject,
         "is a JPEG of {} x {} pixels, which takes {} bytes where {} are allowed", reader.jpeg.image_width,
         reader.jpeg.image_height, needed, budgetBytes);
  }
  DecodedImage image{int(reader.jpeg.image_width), int(reader.jpeg.image_height),
                     LargeVector<std::uint8_t>(std::size_t(pixels) * 4)};
  if (!readPixels(reader, image.rgba.data())) {
    failInput(subject, "is not a readable JPEG: {}", reader.errors.text);
  }
  return image;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/files.h"

#include "base/error.h"
#include "base/files.h"
#include "image/decode.h"
#include "image/hdr.h"
#include "image/png.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace isophote {

namespace {

std::string endingOf(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

Image linearImage(const DecodedImage& decoded) {
  const auto& linear = linearFromSrgb8();
  Image image(decoded.width, decoded.height);
  const std::uint8_t* rgba = decoded.rgba.data();
  for (vec3& pixel : image.pixels) {
    pixel = vec3(linear[rgba[0]], linear[rgba[1]], linear[rgba[2]]);
    rgba += 4;
  }
  return image;
}

}  // namespace

Film readFilm(const std::filesystem::path& path, std::uint64_t budgetBytes) {
  const std::string content = readFile(path, budgetBytes);
  const auto bytes = std::as_bytes(std::span(content));
  if (formatOf(bytes) == "OpenEXR") return decodeExr(bytes, path.string(), budgetBytes);
  if (formatOf(bytes) == "Radiance HDR") {
    Film film;
    film.colour = decodeHdr(bytes, path.string(), budgetBytes);
    return film;
  }
  // A linear pixel takes three times the memory of an encoded one, which is released only afterwards.
  const DecodedImage decoded = decodeImage(bytes, path.string(), budgetBytes / 4);
  Film film;
  film.colour = linearImage(decoded);
  return film;
}

FilmFormat filmFormat(const std::filesystem::path& path) {
  const std::string ending = endingOf(path);
  if (ending == ".exr") return FilmFormat::kExr;
  if (ending == ".png") return FilmFormat::kPng;
  failUsage(path.string(), "{} is not a format that can be written; end the name in .exr or .png",
            ending.empty() ? "a name without an ending" : fmt::format("\"{}\"", ending));
}

void requireFilmFormat(const std::filesystem::path& path) { filmFormat(path); }

bool holdsLayers(const std::filesystem::path& path) { return filmFormat(path) == FilmFormat::kExr; }

void writeFilm(const std::filesystem::path& path, const Film& film, const DisplayOptions& display) {
  const FilmFormat format = filmFormat(path);
  const Image& colour = film.colour;
  if (format == FilmFormat::kExr) return writeFileAtomically(path, encodeExr(film));
  if (colour.width <= 0 || colour.height <= 0)
    fail(ErrorKind::kInternal, "", "a film without pixels cannot be saved");
  writeFileAtomically(path, encodePng(colour.width, colour.height, displayedBytes(colour, display)));
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/radiance.h"

#include "base/error.h"
#include "image/decode.h"
#include "image/exr.h"
#include "image/hdr.h"

#include <algorithm>
#include <cmath>

namespace isophote {

namespace {

constexpr float kBrightest = 1e9f;
constexpr float kLargestHalf = 65504.0f;

float usable(float value) {
  if (std::isinf(value)) return value > 0.0f ? kLargestHalf : 0.0f;
  return value > 0.0f ? std::min(value, kBrightest) : 0.0f;  // NaN is not greater either
}

}  // namespace

bool holdsRadiance(std::span<const std::byte> bytes) {
  const std::string_view format = formatOf(bytes);
  return format == "OpenEXR" || format == "Radiance HDR";
}

Image decodeRadiance(std::span<const std::byte> bytes, std::string_view subject, std::uint64_t budgetBytes) {
  const std::string_view format = formatOf(bytes);
  Image image;
  if (format == "OpenEXR")
    image = decodeExr(bytes, subject, budgetBytes).colour;
  else if (format == "Radiance HDR")
    image = decodeHdr(bytes, subject, budgetBytes);
  else
    failInput(subject, "is {}; a picture of radiance must be OpenEXR or Radiance HDR",
              format.empty() ? "not a picture of a known format" : fmt::format("a {} file", format));
  for (vec3& texel : image.pixels) texel = {usable(texel.x), usable(texel.y), usable(texel.z)};
  return image;
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace isophote {

/// A picture in linear Rec.709, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<vec3> pixels;  ///< width * height

  Image() = default;
  Image(int w, int h, vec3 fill = vec3(0.0f))
      : width(w), height(h), pixels(std::size_t(w) * std::size_t(h), fill) {}
  vec3& at(int x, int y) { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
  vec3 at(int x, int y) const { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

/// What a render returns: the picture, its named layers of the same size, and facts about how it was made.
/// Layers: "direct", "indirect", "emitted", "albedo", "normal" (world space), "depth" (distance from the eye
/// in x) [m], "density" (photons a square metre in x).
struct Film {
  Image colour;  ///< Radiance [W/(m^2 sr)]
  std::map<std::string, Image> layers;
  std::vector<std::pair<std::string, std::string>> metadata;
};

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// How linear radiance becomes a PNG: times 2^exposureEv, tone-mapped, clamped to [0, 1], sRGB curve.
struct Display {
  float exposureEv = 0;
  bool autoExposure = false;     ///< Adds the exposure that brings the average to middle grey.
  std::string toneMap = "none";  ///< "none", "aces" or "reinhard".
};

/// A rendered picture: linear radiance [W/(m^2 sr)] and named layers of the same size. Immutable and cheap to
/// copy.
class Picture {
 public:
  int width() const;
  int height() const;
  /// Red, green, blue of each pixel, rows from the top: 3 * width * height numbers, valid as long as a copy
  /// of this picture is.
  std::span<const float> pixels() const;
  /// "direct", "indirect", "emitted", "albedo", "normal" (world space), "depth" (distance from the eye in red
  /// [m]), ...
  std::vector<std::string> layerNames() const;
  /// As pixels(). Throws Error(kBadUsage) that lists the names.
  std::span<const float> layer(std::string_view name) const;
  /// What the render measured: engine, milliseconds by stage, photons, bytes, ... as JSON.
  const std::string& statsJson() const;

  /// Writes the whole file or nothing: .exr (linear, with layers and settings) or .png. Throws Error.
  void save(const std::filesystem::path& file, const Display& display = {}) const;
  /// 8-bit sRGB, 3 * width * height bytes.
  std::vector<unsigned char> bytes(const Display& display = {}) const;

  struct Content;  ///< The library's own.
  explicit Picture(std::shared_ptr<const Content> content) : content_(std::move(content)) {}

 private:
  std::shared_ptr<const Content> content_;
};

}  // namespace isophote

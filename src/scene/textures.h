// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace isophote {

/// What the numbers of a picture are, where our materials read others.
enum class TextureMeaning : std::uint8_t {
  kAsRead,
  kHeights,    ///< normalsFromHeights()
  kExponents,  ///< roughnessFromExponents()
};

/// How a texture's texels are read.
struct TextureUse {
  bool srgb = true;
  Wrap wrapU = Wrap::kRepeat;
  Wrap wrapV = Wrap::kRepeat;
  bool nearest = false;
  bool emission = false;  ///< Values above 1 count: of a picture of floats they are kept.
  TextureMeaning meaning = TextureMeaning::kAsRead;
  float meaningScale = 1;  ///< Of heights, or of exponents.
};

/// Collects the images that one model asks for, then decodes them all in parallel. The same image asked for
/// twice with the same use is stored once.
class TextureSet {
 public:
  /// `model` is the file that asks: errors name it. Textures are appended to `scene`, which must outlive
  /// this.
  TextureSet(Scene& scene, std::string model) : scene_(scene), model_(std::move(model)) {}

  /// Index in scene.textures of a PNG, JPEG, TGA, OpenEXR or Radiance HDR file. The latter two hold linear
  /// values whatever the use says; but for emission they are clamped to [0, 1] and stored in 8 bits. Where
  /// `alphaFile` is given, its red channel becomes the alpha.
  int addFile(const std::filesystem::path& file, const TextureUse& use,
              const std::filesystem::path& alphaFile = {});
  /// The same for an image in memory, which must stay until decode() has returned. `name` tells it apart from
  /// others.
  int addEncoded(std::span<const std::byte> bytes, const std::string& name, const TextureUse& use);
  /// Fills scene.textures. Throws Error(kBadInput) for the first image that is missing or broken.
  void decode(const Job& job);

 private:
  struct Source {
    int texture;
    TextureUse use;
    std::filesystem::path file;  ///< Empty: `bytes`.
    std::filesystem::path alphaFile;
    std::span<const std::byte> bytes;
  };
  int add(Source source, const std::string& key, const std::string& name, const TextureUse& use);
  Texture decodeOne(const Source& source, std::uint64_t budgetBytes) const;

  Scene& scene_;
  std::string model_;
  std::vector<Source> sources_;
  std::map<std::string, int> known_;
};

}  // namespace isophote

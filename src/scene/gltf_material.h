// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/gltf_document.h"
#include "scene/textures.h"

#include <map>
#include <optional>
#include <vector>

namespace isophote {

/// Which texture coordinates a material reads, and how it moves them (KHR_texture_transform); a primitive
/// bakes this into its uvs. uv' = offset + rotation * (scale * uv).
struct GltfUvSource {
  std::uint64_t set = 0;  ///< TEXCOORD_<set>
  vec2 offset{0};
  vec2 scale{1};
  float rotation = 0;  ///< Counter-clockwise [radians].

  bool operator==(const GltfUvSource&) const = default;
  vec2 apply(vec2 uv) const;
  /// The coordinates' directions are other than the file's.
  bool turns() const { return rotation != 0.0f || scale.x < 0.0f || scale.y < 0.0f; }
};

/// Turns glTF materials into the scene's, each once and only those that are asked for, with the textures that
/// they read.
class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, Scene& scene, const Job& job)
      : document_(document), scene_(scene), job_(job), textures_(scene, document.file()) {}

  struct Use {
    std::uint32_t material;
    std::optional<GltfUvSource> uvs;  ///< Absent: no texture is read.
    bool normalMapped = false;
  };
  /// `index` in the document's materials; absent: a primitive that names none, which is matte grey.
  const Use& use(std::optional<std::size_t> index);
  void decodeTextures() { textures_.decode(job_); }

 private:
  struct Reader;

  GltfDocument& document_;
  Scene& scene_;
  const Job& job_;
  TextureSet textures_;
  std::map<std::optional<std::size_t>, Use> uses_;
  std::map<std::size_t, std::span<const std::byte>> dataUris_;  ///< By image.
};

}  // namespace isophote

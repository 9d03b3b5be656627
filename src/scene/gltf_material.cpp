// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_material.h"

#include <cmath>

namespace isophote {

namespace {

constexpr double kAnyLargest = 1e30;

vec3 factorColour(const JsonValue& object, std::string_view key, vec3 fallback) {
  const std::optional<JsonValue> member = object.find(key);
  return member ? member->colour() : fallback;
}

Wrap wrapOf(const JsonValue& sampler, std::string_view key) {
  const std::uint64_t mode = wholeNumber(sampler, key, 10497);
  if (mode == 10497) return Wrap::kRepeat;
  if (mode == 33071) return Wrap::kClamp;
  if (mode == 33648) return Wrap::kMirror;
  sampler.at(key).fail("{} is none of glTF's wrap modes 10497, 33071 and 33648", mode);
}

GltfUvSource uvSourceOf(const JsonValue& textureInfo) {
  GltfUvSource source;
  source.set = wholeNumber(textureInfo, "texCoord", 0);
  const std::optional<JsonValue> transform = findExtension(textureInfo, "KHR_texture_transform");
  if (!transform) return source;
  source.set = wholeNumber(*transform, "texCoord", source.set);
  source.rotation = numberOr(*transform, "rotation", 0.0f, -kAnyLargest, kAnyLargest);
  const auto pair = [&](std::string_view key, vec2 fallback) {
    const std::optional<JsonValue> member = transform->find(key);
    if (!member) return fallback;
    const std::vector<float> v = member->numbers(2);
    return vec2(v[0], v[1]);
  };
  source.offset = pair("offset", source.offset);
  source.scale = pair("scale", source.scale);
  return source;
}

}  // namespace

vec2 GltfUvSource::apply(vec2 uv) const {
  const vec2 scaled = uv * scale;
  const float c = std::cos(rotation);
  const float s = std::sin(rotation);
  return offset + vec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

/// Reads one material.
struct GltfMaterials::Reader {
  GltfMaterials& owner;
  const JsonValue& json;
  NamedMaterial material;
  std::optional<GltfUvSource> uvs;

  void readAll() {
    readSurface();
    readTransmission();
    readEmission();
    readAlpha();
    const std::optional<JsonValue> doubleSided = json.find("doubleSided");
    if (doubleSided && doubleSided->boolean()) material.flags |= kMaterialDoubleSided;
  }

  void readSurface() {
    material.metallic = 1.0f;
    if (const std::optional<JsonValue> pbr = json.find("pbrMetallicRoughness")) {
      if (const std::optional<JsonValue> factor = pbr->find("baseColorFactor")) {
        const std::vector<float> v = factor->numbers(4, 0.0);
        material.baseColour = vec3(v[0], v[1], v[2]);
        material.alpha = v[3];
      }
      material.metallic = numberOr(*pbr, "metallicFactor", 1.0f, 0.0, kAnyLargest);
      material.roughness = numberOr(*pbr, "roughnessFactor", 1.0f, 0.0, kAnyLargest);
      material.baseColourTexture = texture(*pbr, "baseColorTexture", true);
      if (material.metallic > 0.0f || material.roughness > 0.0f)
        material.metallicRoughnessTexture = texture(*pbr, "metallicRoughnessTexture", false);
    }
    if (const std::optional<JsonValue> ior = findExtension(json, "KHR_materials_ior")) {
      // Zero stands for a surface that reflects everything (for files from the specular-glossiness model).
      const float value = numberOr(*ior, "ior", 1.5f, 0.0, kAnyLargest);
      material.ior = value == 0.0f ? 100.0f : value;
    }
    if (const std::optional<JsonValue> specular = findExtension(json, "KHR_materials_specular")) {
      material.specular = numberOr(*specular, "specularFactor", 1.0f, 0.0, kAnyLargest);
      material.specularColour = factorColour(*specular, "specularColorFactor", vec3(1.0f));
      material.specularTexture = texture(*specular, "specularTexture", false);
      material.specularColourTexture = texture(*specular, "specularColorTexture", true);
    }
    material.normalTexture = texture(json, "normalTexture", false);
    if (material.normalTexture >= 0)
      material.normalScale = numberOr(json.at("normalTexture"), "scale", 1.0f, -kAnyLargest, kAnyLargest);
    if (findExtension(json, "KHR_materials_unlit")) material.flags |= kMaterialUnlit;
  }

  void readTransmission() {
    const std::optional<JsonValue> transmission = findExtension(json, "KHR_materials_transmission");
    if (!transmission) return;
    material.transmission = numberOr(*transmission, "transmissionFactor", 0.0f, 0.0, kAnyLargest);
    if (material.transmission == 0.0f) return;
    material.transmissionTexture = texture(*transmission, "transmissionTexture", false);
    const std::optional<JsonValue> volume = findExtension(json, "KHR_materials_volume");
    const bool solid = volume && numberOr(*volume, "thicknessFactor", 0.0f, 0.0, kAnyLargest) > 0.0f;
    if (!solid) material.flags |= kMaterialThinWalled;
    if (solid) readAbsorption(*volume);
  }

  /// What of white light is left after the distance; without one, nothing is absorbed.
  void readAbsorption(const JsonValue& volume) {
    if (!volume.has("attenuationDistance")) return;
    const float distance = volume.at("attenuationDistance").positive();
    material.absorption = absorptionOf(factorColour(volume, "attenuationColor", vec3(1.0f)), distance);
  }

  void readEmission() {
    material.emission = factorColour(json, "emissiveFactor", vec3(0.0f));
    if ((material.flags & kMaterialUnlit) != 0u) material.emission = vec3(0.0f);
    if (material.emission == vec3(0.0f)) return;
    if (const std::optional<JsonValue> strength = findExtension(json, "KHR_materials_emissive_strength"))
      material.emission *= numberOr(*strength, "emissiveStrength", 1.0f, 0.0, kAnyLargest);
    material.emissionTexture = texture(json, "emissiveTexture", true);
  }

  void readAlpha() {
    const std::optional<JsonValue> mode = json.find("alphaMode");
    const std::string name = mode ? mode->string() : "OPAQUE";
    if (name == "OPAQUE") {
      material.alpha = 1.0f;
      return;
    }
    if (name != "MASK" && name != "BLEND") mode->fail("\"{}\" is none of OPAQUE, MASK and BLEND", name);
    material.flags |= name == "MASK" ? kMaterialAlphaMask : kMaterialAlphaBlend;
    if (name == "MASK") material.alphaCutoff = numberOr(json, "alphaCutoff", 0.5f, 0.0, kAnyLargest);
  }

  /// Index in the scene's textures of the one that object[key] names, or -1.
  int texture(const JsonValue& object, std::string_view key, bool srgb) {
    const std::optional<JsonValue> info = object.find(key);
    if (!info) return -1;
    const std::optional<std::size_t> index = findIndex(owner.document_, *info, "index", "textures");
    if (!index) info->fail("the key \"index\" is missing");
    const JsonValue& textureJson = owner.document_.array("textures")[*index];
    const std::optional<std::size_t> image = findIndex(owner.document_, textureJson, "source", "images");
    if (!image) {
      owner.job_.warn(fmt::format("{}: {} has no PNG or JPEG image and is left out", owner.document_.file(),
                                  textureJson.place()));
      return -1;
    }
    const GltfUvSource source = uvSourceOf(*info);
    if (!uvs) uvs = source;
    if (*uvs != source)
      owner.job_.warn(fmt::format("{}: {} places its textures differently; all follow the first",
                                  owner.document_.file(), json.place()));
    return addImage(*image, useOf(textureJson, srgb));
  }

  TextureUse useOf(const JsonValue& textureJson, bool srgb) const {
    TextureUse use;
    use.srgb = srgb;
    const std::optional<std::size_t> sampler = findIndex(owner.document_, textureJson, "sampler", "samplers");
    if (!sampler) return use;
    const JsonValue& samplerJson = owner.document_.array("samplers")[*sampler];
    use.wrapU = wrapOf(samplerJson, "wrapS");
    use.wrapV = wrapOf(samplerJson, "wrapT");
    use.nearest = wholeNumber(samplerJson, "magFilter", 9729) == 9728;
    return use;
  }

  int addImage(std::size_t index, const TextureUse& use) {
    GltfDocument& document = owner.document_;
    const JsonValue& image = document.array("images")[index];
    const std::string name = nameOf(image, fmt::format("images[{}]", index));
    const std::string key = fmt::format("images[{}] \"{}\"", index, name);
    if (const std::optional<std::size_t> view = findIndex(document, image, "bufferView", "bufferViews"))
      return owner.textures_.addEncoded(document.viewBytes(document.array("bufferViews")[*view]), key, use);
    const JsonValue uri = image.at("uri");
    if (!isDataUri(uri.string())) return owner.textures_.addFile(document.fileOf(uri), use);
    if (!owner.dataUris_.contains(index)) owner.dataUris_[index] = document.dataUriBytes(uri);
    return owner.textures_.addEncoded(owner.dataUris_[index], key, use);
  }
};

const GltfMaterials::Use& GltfMaterials::use(std::optional<std::size_t> index) {
  const auto known = uses_.find(index);
  if (known != uses_.end()) return known->second;
  const auto material = std::uint32_t(scene_.materials.size());
  std::optional<GltfUvSource> uvs;
  if (index) {
    const JsonValue& json = document_.array("materials")[*index];
    Reader reader{*this, json, {makeMaterial(), nameOf(json, json.place())}, std::nullopt};
    reader.readAll();
    uvs = reader.uvs;
    scene_.materials.push_back(std::move(reader.material));
  } else {
    // glTF's default would be a white metal, which hardly anyone means who leaves the material out.
    NamedMaterial matte{makeMaterial(), "default"};
    matte.baseColour = vec3(0.8f);
    matte.specular = 0.0f;
    scene_.materials.push_back(std::move(matte));
  }
  const bool normalMapped = scene_.materials[material].normalTexture >= 0;
  return uses_.emplace(index, Use{material, uvs, normalMapped}).first->second;
}

}  // namespace isophote

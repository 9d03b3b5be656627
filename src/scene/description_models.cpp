// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/description_parts.h"
#include "settings/suggest.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>

namespace isophote {

namespace {

void setFlag(Material& material, uint flag, bool on) {
  material.flags = on ? material.flags | flag : material.flags & ~flag;
}

void overrideMetallicRoughness(Material& m, const JsonValue& value) {
  value.expectKeys({"baseColorFactor", "metallicFactor", "roughnessFactor"});
  if (const auto colour = value.find("baseColorFactor")) {
    const bool withAlpha = colour->json().is_array() && colour->json().size() == 4;
    const std::vector<float> c = colour->numbers(withAlpha ? 4 : 3, 0.0, 1.0);
    m.baseColour = vec3(c[0], c[1], c[2]);
    if (withAlpha) m.alpha = c[3];
  }
  if (const auto metallic = value.find("metallicFactor")) m.metallic = metallic->number(0.0, 1.0);
  if (const auto roughness = value.find("roughnessFactor")) m.roughness = roughness->number(0.0, 1.0);
}

void overrideExtensions(Material& m, const JsonValue& value) {
  value.expectKeys({"KHR_materials_transmission", "KHR_materials_ior", "KHR_materials_specular",
                    "KHR_materials_volume", "KHR_materials_emissive_strength", "KHR_materials_unlit"});
  if (const auto transmission = value.find("KHR_materials_transmission")) {
    transmission->expectKeys({"transmissionFactor"});
    m.transmission = transmission->at("transmissionFactor").number(0.0, 1.0);
  }
  if (const auto ior = value.find("KHR_materials_ior")) {
    ior->expectKeys({"ior"});
    m.ior = ior->at("ior").number(1.0);
  }
  if (const auto specular = value.find("KHR_materials_specular")) {
    specular->expectKeys({"specularFactor", "specularColorFactor"});
    if (const auto factor = specular->find("specularFactor")) m.specular = factor->number(0.0, 1.0);
    if (const auto colour = specular->find("specularColorFactor")) m.specularColour = colour->colour();
  }
  if (const auto volume = value.find("KHR_materials_volume")) {
    volume->expectKeys({"thicknessFactor", "attenuationColor", "attenuationDistance"});
    if (const auto thickness = volume->find("thicknessFactor"))
      setFlag(m, kMaterialThinWalled, thickness->number(0.0) == 0.0f);
    const auto colour = volume->find("attenuationColor");
    if (const auto distance = volume->find("attenuationDistance"))
      m.absorption = absorptionOf(colour ? colour->colour(1.0) : vec3(1.0f), distance->positive());
    else if (colour)
      volume->fail("has an attenuationColor, but no attenuationDistance after which it is left");
  }
  if (const auto unlit = value.find("KHR_materials_unlit")) {
    unlit->expectKeys({});
    m.flags |= kMaterialUnlit;
  }
  if (const auto strength = value.find("KHR_materials_emissive_strength")) {
    strength->expectKeys({"emissiveStrength"});
    m.emission *= strength->at("emissiveStrength").number(0.0);
  }
}

void overrideAlphaMode(Material& m, const JsonValue& value) {
  const std::string mode = value.string();
  constexpr std::array<std::string_view, 3> kModes = {"OPAQUE", "MASK", "BLEND"};
  if (std::find(kModes.begin(), kModes.end(), mode) == kModes.end()) {
    value.fail("there is no alpha mode \"{}\"{}; there are {}", mode,
               suggestion(mode, std::span<const std::string_view>(kModes)), fmt::join(kModes, ", "));
  }
  setFlag(m, kMaterialAlphaMask, mode == "MASK");
  setFlag(m, kMaterialAlphaBlend, mode == "BLEND");
}

}  // namespace

void overrideMaterial(Material& m, const JsonValue& value) {
  value.expectKeys(
      {"pbrMetallicRoughness", "emissiveFactor", "doubleSided", "alphaMode", "alphaCutoff", "extensions"});
  if (const auto pbr = value.find("pbrMetallicRoughness")) overrideMetallicRoughness(m, *pbr);
  if (const auto emissive = value.find("emissiveFactor")) m.emission = emissive->colour();
  if (const auto doubleSided = value.find("doubleSided"))
    setFlag(m, kMaterialDoubleSided, doubleSided->boolean());
  if (const auto mode = value.find("alphaMode")) overrideAlphaMode(m, *mode);
  if (const auto cutoff = value.find("alphaCutoff")) m.alphaCutoff = cutoff->number(0.0);
  if (const auto extensions = value.find("extensions")) overrideExtensions(m, *extensions);
}

mat4x3 readTransform(const JsonValue& model) {
  vec3 scale(1.0f);
  if (const auto value = model.find("scale")) {
    scale = value->json().is_number() ? vec3(value->number()) : value->vector();
    if (scale.x * scale.y * scale.z == 0.0f) value->fail("must not be 0: the model would have no extent");
  }
  glm::quat rotation(1.0f, 0.0f, 0.0f, 0.0f);
  if (const auto value = model.find("rotation")) {
    const std::vector<float> q = value->numbers(4);
    rotation = glm::quat(q[3], q[0], q[1], q[2]);
    if (std::abs(glm::length(rotation) - 1.0f) > 1e-3f) {
      value->fail("must be a unit quaternion [x, y, z, w], but its length is {}", glm::length(rotation));
    }
    rotation = glm::normalize(rotation);
  }
  const mat3 axes = glm::mat3_cast(rotation);
  const vec3 translation = model.has("translation") ? model.at("translation").vector() : vec3(0.0f);
  return mat4x3(axes[0] * scale.x, axes[1] * scale.y, axes[2] * scale.z, translation);
}

}  // namespace isophote

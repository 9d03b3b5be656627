// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#ifndef ISOPHOTE_PHYSICS_MATERIAL_SHARED_H
#define ISOPHOTE_PHYSICS_MATERIAL_SHARED_H

#include "math/shared.h"

SHARED_BEGIN

SHARED_CONST uint kMaterialDoubleSided = 1u;  ///< Emits from both sides. Shading is two-sided always.
SHARED_CONST uint kMaterialAlphaMask = 2u;    ///< Where alpha < alphaCutoff the surface is not there.
SHARED_CONST uint kMaterialThinWalled =
    4u;  ///< Transmits without refraction: a pane, not the skin of a solid.
/// Covers what lies behind it by its alpha alone: the part 1 - alpha of all light passes, which is neither a
/// hit nor an event.
SHARED_CONST uint kMaterialAlphaBlend = 8u;
/// Shows its base colour as emitted radiance and scatters nothing (KHR_materials_unlit). Not a light: what it
/// shows is seen by the eye, in mirrors and through glass alone.
SHARED_CONST uint kMaterialUnlit = 16u;

/// Roughness (glTF's, before squaring) up to which reflection counts as a perfect mirror.
SHARED_CONST float kMirrorRoughness = 0.03f;

/// A surface as scene files describe it: glTF's metallic-roughness model with the extensions
/// KHR_materials_transmission, _volume, _ior, _specular, _emissive_strength and _unlit. Texture indices are
/// -1 for none; a texture multiplies its factor. The default glTF material is makeMaterial(). 112 bytes.
struct Material {
  vec3 baseColour;  ///< Linear Rec.709 reflectance [0, 1].
  float metallic;   ///< [0, 1]
  vec3 emission;    ///< Emitted radiance, strength multiplied in [W/(m^2 sr)].
  float roughness;  ///< Perceptual [0, 1]; GGX alpha is its square. At most kMirrorRoughness: perfect mirror.
  float transmission;  ///< Part of the light entering the dielectric that passes through [0, 1].
  float ior;           ///< Index of refraction relative to the outside.
  float specular;      ///< Weight of the dielectric's reflection [0, 1]; 0 leaves a pure Lambertian surface.
  float alpha;         ///< Opacity factor [0, 1] for mask (and blend).
  float alphaCutoff;
  uint flags;  ///< kMaterial... bits.
  int baseColourTexture;
  int metallicRoughnessTexture;  ///< G roughness, B metallic.
  int emissionTexture;
  int normalTexture;
  float normalScale;
  int transmissionTexture;  ///< R.
  vec3 specularColour;  ///< Multiplies the dielectric's reflectance at normal incidence, which is at most 1.
  int specularTexture;  ///< A.
  vec3 absorption;      ///< What a solid that transmits takes of the light inside it, by its length [1/m].
  int specularColourTexture;
};

SHARED_FN Material makeMaterial() {
  Material m;
  m.baseColour = vec3(1.0f);
  m.metallic = 0.0f;
  m.emission = vec3(0.0f);
  m.roughness = 1.0f;
  m.transmission = 0.0f;
  m.ior = 1.5f;
  m.specular = 1.0f;
  m.alpha = 1.0f;
  m.alphaCutoff = 0.5f;
  m.flags = 0u;
  m.baseColourTexture = -1;
  m.metallicRoughnessTexture = -1;
  m.emissionTexture = -1;
  m.normalTexture = -1;
  m.normalScale = 1.0f;
  m.transmissionTexture = -1;
  m.specularColour = vec3(1.0f);
  m.specularTexture = -1;
  m.absorption = vec3(0.0f);
  m.specularColourTexture = -1;
  return m;
}

/// Absorption [1/m] of a solid that leaves the part `colour` of white light over `distance` [m].
SHARED_FN vec3 absorptionOf(vec3 colour, float distance) {
  return -log(clamp(colour, vec3(1e-12f), vec3(1.0f))) / distance;
}

/// Part of the light that is left after that way [m] through a solid (Beer and Lambert).
SHARED_FN vec3 transmittanceOver(vec3 absorption, float distance) { return exp(-absorption * distance); }

SHARED_END

#endif

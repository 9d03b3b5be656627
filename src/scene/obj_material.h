// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "physics/material.shared.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

struct MtlTexture {
  std::string file;  ///< As written; empty for none.
  bool clamp = false;
  float bump = 1;  ///< -bm: multiplies heights.
};

/// One newmtl of an .mtl file as it stands; what it does not say is empty.
struct MtlMaterial {
  std::string name;
  std::optional<vec3> kd;
  std::optional<vec3> ks;
  std::optional<vec3> ke;
  std::optional<vec3> tf;
  std::optional<float> ns;
  std::optional<float> ni;
  std::optional<float> d;  ///< Tr is read as 1 - d; d wins where both stand.
  std::optional<int> illum;
  MtlTexture mapKd;
  MtlTexture mapD;
  MtlTexture mapKe;
  MtlTexture mapKs;
  MtlTexture mapNs;
  MtlTexture bump;  ///< map_Bump, map_bump or bump.
  MtlTexture norm;
};

/// Parses the text of an .mtl file; `subject` names it in errors and warnings. Numbers are finite and not
/// negative.
std::vector<MtlMaterial> parseMtl(std::string_view text, const std::string& subject, const Job& job = {});

/// Reads MTL's Phong terms as a metallic-roughness Material, without textures:
/// - Kd is the base colour (white where a map_Kd stands alone or with Kd 0), Ke the emitted radiance.
/// - Ns becomes GGX alpha = sqrt(2 / (Ns + 2)), the lobe of like width: roughness = sqrt(alpha).
/// - illum 0 and 1, and illum 2 with Ks 0: a pure Lambertian surface (specular = 0).
/// - illum 2 with Ks: a diffuse surface under a clear coat that reflects the mean of Ks at normal incidence;
/// the
///   index of refraction is the one that gives this reflectance (Ni, which tells how glass refracts, does not
///   count).
/// - illum 3, 5 and 8 reflect as metals do: metallic is the share of Ks in Kd + Ks, the base colour Kd + Ks.
/// With Kd
///   near 0 it is a metal of reflectance Ks. illum 5, and the others with Ns missing or at least 10000, are
///   mirrors.
/// - illum 4, 6, 7 and 9, and any other with d < 1 and an Ni other than 1: smooth glass of index Ni (1.5
/// where it is
///   missing), tinted by Tf at each surface (white where it is missing or 0).
/// - d < 1 without refraction: a thin film that lets the part 1 - d through, tinted by Kd, and reflects
/// nothing. Surfaces are double-sided, since OBJ knows no sides; but what emits does so only to its front,
/// the side that sees its corners counter-clockwise: lamps are drawn as quads just under a ceiling, which
/// they are not to light.
Material materialFromMtl(const MtlMaterial& mtl);

/// What faces without a known material get: matt grey of reflectance 0.5, double-sided.
Material defaultObjMaterial();

}  // namespace isophote

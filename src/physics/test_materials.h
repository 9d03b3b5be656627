// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The materials and directions that the tests of the BSDF run over.
#pragma once

#include "physics/bsdf.shared.h"
#include "support/statistics.h"

#include <string>
#include <vector>

namespace isophote {

struct NamedBsdf {
  std::string name;
  Bsdf bsdf;
};

struct MaterialChoice {
  float roughness = 1;
  float metallic = 0;
  float specular = 1;
  float ior = 1.5f;
  float transmission = 0;
  vec3 baseColour{1.0f};
  uint flags = 0;
};

inline NamedBsdf bsdfOf(const MaterialChoice& c) {
  Material m = makeMaterial();
  m.specular = c.specular;
  m.ior = c.ior;
  m.flags = c.flags;
  return {fmt::format("roughness {} metallic {} specular {} ior {} transmission {} base {}{}", c.roughness,
                      c.metallic, c.specular, c.ior, c.transmission, c.baseColour.x,
                      c.flags == kMaterialThinWalled ? " thin" : ""),
          bsdfFromMaterial(m, c.baseColour, c.metallic, c.roughness, c.transmission)};
}

/// White ones, which show every gain of energy.
inline std::vector<NamedBsdf> whiteMaterials() {
  std::vector<NamedBsdf> list;
  for (const float roughness : {0.0f, 0.04f, 0.2f, 0.4f, 0.6f, 1.0f})
    for (const float metallic : {0.0f, 0.5f, 1.0f})
      for (const float transmission : {0.0f, 0.5f, 1.0f})
        for (const float specular : {0.0f, 1.0f})
          for (const float ior : {1.0f, 1.5f, 2.4f})
            for (const uint flags : {0u, kMaterialThinWalled}) {
              if (flags != 0u && transmission == 0.0f) continue;
              list.push_back(bsdfOf({roughness, metallic, specular, ior, transmission, vec3(1.0f), flags}));
            }
  return list;
}

inline NamedBsdf randomMaterial(std::uint32_t i) {
  const vec3 a = randomTriple(100, i), b = randomTriple(101, i);
  return bsdfOf(
      {a.x, i % 3 == 0 ? a.y : 0.0f, a.z, 1.0f + b.x, i % 4 == 0 ? b.y : 0.0f, randomTriple(102, i)});
}

/// Unit, at that cosine off +z and turned about it.
inline vec3 directionAt(float cosine, float turns) { return detail::onSphere(double(cosine), double(turns)); }

/// Uniform in the half space of n.
inline vec3 directionAbove(vec3 n, vec3 u) {
  const vec3 w = sampleSphere(vec2(u.x, u.y));
  return dot(w, n) < 0.0f ? -w : w;
}

inline const vec3 kUp{0, 0, 1};

}  // namespace isophote

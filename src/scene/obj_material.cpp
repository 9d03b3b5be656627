// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/obj_material.h"

#include "scene/text_lines.h"
#include "scene/texture_convert.h"

#include <algorithm>
#include <set>

namespace isophote {

namespace {

/// Reflectance below which Kd counts as a modeller's "black": 0.01 is common beside mirrors.
constexpr float kBlack = 0.02f;
/// Phong exponent from which a reflecting surface is a perfect mirror.
constexpr float kMirrorExponent = 10000.0f;
/// Highest reflectance at normal incidence given to a dielectric (index 199).
constexpr float kMostCoatReflectance = 0.98f;

float meanOf(vec3 c) { return (c.x + c.y + c.z) / 3.0f; }

class MtlParser {
 public:
  MtlParser(std::string_view text, const std::string& subject, const Job& job)
      : lines_(subject, text), job_(job) {}

  std::vector<MtlMaterial> parse() {
    while (lines_.next()) {
      const std::string_view key = lines_.word();
      if (key == "newmtl") {
        materials_.emplace_back();
        materials_.back().name = lines_.rest();
        hasD_ = false;
      } else if (materials_.empty()) {
        lines_.fail("\"{}\" stands before the first newmtl", key.substr(0, 40));
      } else {
        parseTerm(key, materials_.back());
      }
    }
    if (!ignored_.empty()) {
      job_.warn(
          fmt::format("{}: not supported and ignored: {}", lines_.subject(), fmt::join(ignored_, ", ")));
    }
    return std::move(materials_);
  }

 private:
  void parseTerm(std::string_view key, MtlMaterial& m) {
    if (key == "Kd") {
      readColour(key, m.kd);
    } else if (key == "Ks") {
      readColour(key, m.ks);
    } else if (key == "Ke") {
      readColour(key, m.ke);
    } else if (key == "Tf" || key == "Kt") {
      readColour(key, m.tf);
    } else if (key == "Ns") {
      m.ns = notNegative(key, lines_.number(key));
    } else if (key == "Ni") {
      m.ni = notNegative(key, lines_.number(key));
    } else if (key == "d") {
      m.d = readDissolve();
      hasD_ = true;
    } else if (key == "Tr") {
      const float d = 1.0f - notNegative(key, lines_.number(key));
      if (!hasD_) m.d = std::max(d, 0.0f);
    } else if (key == "illum") {
      const float value = lines_.number(key);
      if (value < 0 || value > 10 || value != float(int(value)))
        lines_.fail("illum must be a whole number, 0 to 10");
      m.illum = int(value);
    } else if (key == "map_Kd") {
      m.mapKd = readTexture(key);
    } else if (key == "map_d") {
      m.mapD = readTexture(key);
    } else if (key == "map_Ke") {
      m.mapKe = readTexture(key);
    } else if (key == "map_Ks") {
      m.mapKs = readTexture(key);
    } else if (key == "map_Ns") {
      m.mapNs = readTexture(key);
    } else if (key == "map_Bump" || key == "map_bump" || key == "bump") {
      m.bump = readTexture(key);
    } else if (key == "norm" || key == "map_Kn") {
      m.norm = readTexture(key);
    } else if (key != "Ka" && key != "map_Ka") {  // Ambient light stands for what a renderer computes.
      ignored_.emplace(key.substr(0, 40));
    }
  }

  float notNegative(std::string_view key, float value) {
    if (value < 0) lines_.fail("{} must not be negative, but is {}", key, value);
    return value;
  }

  /// "r g b", or "r" for grey. Colours as a spectrum or in CIE XYZ are not supported.
  void readColour(std::string_view key, std::optional<vec3>& colour) {
    TextLines look = lines_;
    const std::string_view first = look.word();
    if (first == "spectral" || first == "xyz") {
      ignored_.emplace(fmt::format("{} {}", key, first));
      return;
    }
    const float r = notNegative(key, lines_.number(key));
    const std::optional<float> g = lines_.optionalNumber(key);
    colour = vec3(r, r, r);
    if (g) colour = vec3(r, notNegative(key, *g), notNegative(key, lines_.number(key)));
  }

  float readDissolve() {
    TextLines look = lines_;
    if (look.word() == "-halo") {
      ignored_.emplace("d -halo");
      lines_.word();
    }
    return std::min(notNegative("d", lines_.number("d")), 1.0f);
  }

  /// "[-option values ...] file name": the name may hold blanks.
  MtlTexture readTexture(std::string_view key) {
    MtlTexture texture;
    for (TextLines look = lines_; look.word().starts_with('-'); look = lines_) {
      const std::string_view option = lines_.word();
      if (option == "-clamp") {
        texture.clamp = lines_.word() == "on";
        continue;
      }
      if (option == "-bm") {
        texture.bump = lines_.number(option);
        continue;
      }
      const bool vector = option == "-o" || option == "-s" || option == "-t";
      const bool pair = option == "-mm";
      if (option == "-s" || option == "-o" || option == "-mm")
        ignored_.emplace(fmt::format("{} {}", key, option));
      // -o, -s and -t take one to three numbers, -mm two, every other option one word.
      for (int i = 0; i < (vector ? 3 : pair ? 2 : 1); ++i) {
        TextLines ahead = lines_;
        if (vector && !parseNumber(ahead.word())) break;
        lines_.word();
      }
    }
    texture.file = lines_.rest();
    if (texture.file.size() > 1 && texture.file.front() == '"' && texture.file.back() == '"') {
      texture.file = texture.file.substr(1, texture.file.size() - 2);
    }
    if (texture.file.empty()) lines_.fail("{} names no file", key);
    return texture;
  }

  TextLines lines_;
  const Job& job_;
  std::vector<MtlMaterial> materials_;
  bool hasD_ = false;  ///< Of the material in hand.
  std::set<std::string> ignored_;
};

void setGlass(Material& m, const MtlMaterial& mtl) {
  const vec3 tint = min(mtl.tf.value_or(vec3(1.0f)), vec3(1.0f));
  m.baseColour = tint == vec3(0.0f) ? vec3(1.0f) : tint;
  m.transmission = 1.0f;
  m.ior = mtl.ni.value_or(0.0f) > 0.0f ? *mtl.ni : 1.5f;
  m.roughness = 0.0f;
}

void setMetal(Material& m, const MtlMaterial& mtl, int illum) {
  const vec3 kd = mtl.kd.value_or(vec3(0.0f));
  const bool blackBase = meanOf(kd) <= kBlack && mtl.mapKd.file.empty();
  const vec3 ks = min(mtl.ks.value_or(vec3(blackBase ? 1.0f : 0.0f)), vec3(1.0f));
  if (blackBase) {
    m.baseColour = ks;
    m.metallic = 1.0f;
  } else {
    const float sum = meanOf(kd) + meanOf(ks);
    m.metallic = sum > 0.0f ? meanOf(ks) / sum : 0.0f;
    m.baseColour = mtl.mapKd.file.empty() ? min(kd + ks, vec3(1.0f)) : m.baseColour;
    m.specular = 0.0f;
  }
  const float ns = mtl.ns.value_or(kMirrorExponent);
  m.roughness = illum == 5 || ns >= kMirrorExponent ? 0.0f : roughnessFromExponent(ns);
}

void setCoat(Material& m, const MtlMaterial& mtl, float reflectance) {
  const float root = sqrt(min(reflectance, kMostCoatReflectance));
  m.ior = (1.0f + root) / (1.0f - root);
  m.roughness = roughnessFromExponent(mtl.ns.value_or(0.0f));
}

void setFilm(Material& m, float d) {
  m.transmission = 1.0f - d;
  m.ior = 1.0f;
  m.specular = 0.0f;
  m.roughness = 0.0f;
  m.flags |= kMaterialThinWalled;
}

}  // namespace

std::vector<MtlMaterial> parseMtl(std::string_view text, const std::string& subject, const Job& job) {
  return MtlParser(text, subject, job).parse();
}

Material materialFromMtl(const MtlMaterial& mtl) {
  const float coat = meanOf(mtl.ks.value_or(vec3(mtl.mapKs.file.empty() ? 0.0f : 1.0f)));
  const int illum = mtl.illum.value_or(coat > 0.0f ? 2 : 1);
  const float ni = mtl.ni.value_or(1.0f);
  const float d = mtl.d.value_or(1.0f);
  const bool refracts = illum == 4 || illum == 6 || illum == 7 || illum == 9;
  Material m = makeMaterial();
  m.flags = kMaterialDoubleSided;
  m.baseColour = min(mtl.kd.value_or(vec3(mtl.mapKd.file.empty() ? 0.5f : 1.0f)), vec3(1.0f));
  if (!mtl.mapKd.file.empty() && m.baseColour == vec3(0.0f)) m.baseColour = vec3(1.0f);
  if (refracts || (d < 1.0f && ni > 0.0f && ni != 1.0f)) {
    setGlass(m, mtl);
  } else if (illum == 3 || illum == 5 || illum == 8) {
    setMetal(m, mtl, illum);
  } else if (d < 1.0f) {
    setFilm(m, d);
  } else if (illum == 2 && coat > 0.0f) {
    setCoat(m, mtl, coat);
  } else {
    m.specular = 0.0f;
  }
  m.emission = mtl.ke.value_or(vec3(mtl.mapKe.file.empty() ? 0.0f : 1.0f));
  if (!mtl.mapKe.file.empty() && m.emission == vec3(0.0f)) m.emission = vec3(1.0f);
  if (m.emission != vec3(0.0f)) m.flags &= ~kMaterialDoubleSided;
  return m;
}

Material defaultObjMaterial() {
  Material m = makeMaterial();
  m.baseColour = vec3(0.5f);
  m.specular = 0.0f;
  m.flags = kMaterialDoubleSided;
  return m;
}

}  // namespace isophote

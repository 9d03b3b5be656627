// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/obj_geometry.h"
#include "scene/text_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <tuple>

namespace isophote {

namespace {

struct Counts {
  std::size_t positions = 0;
  std::size_t uvs = 0;
  std::size_t normals = 0;
};

/// How many v, vt and vn lines there are. Faces may use lines below their own, so this is known before the
/// first face.
Counts countElements(std::string_view text) {
  Counts counts;
  TextLines lines("", text);
  while (lines.next()) {
    const std::string_view key = lines.word();
    if (key == "v") ++counts.positions;
    if (key == "vt") ++counts.uvs;
    if (key == "vn") ++counts.normals;
  }
  return counts;
}

/// Lines that say nothing about surfaces, or how a modeller splits and smooths them.
constexpr std::array<std::string_view, 11> kIgnoredKeys = {
    "s", "l", "p", "vp", "lod", "mg", "shadow_obj", "trace_obj", "bevel", "c_interp", "d_interp"};

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& subject, const std::string& name, const Job& job)
      : lines_(subject, text), counts_(countElements(text)), objectName_(name), job_(job) {
    if (counts_.positions >= kObjNone || counts_.uvs >= kObjNone || counts_.normals >= kObjNone) {
      failInput(subject, "has more than {} vertices", kObjNone - 1);
    }
    data_.positions.reserve(counts_.positions);
    data_.uvs.reserve(counts_.uvs);
    data_.normals.reserve(counts_.normals);
  }

  ObjGeometry parse() {
    for (std::size_t i = 0; lines_.next(); ++i) {
      if (i % 16384 == 0) job_.throwIfStopped();
      parseLine(lines_.word());
    }
    return std::move(data_);
  }

 private:
  void parseLine(std::string_view key) {
    if (key == "v") {
      // A fourth number is the weight of a rational curve, six are a colour: neither changes the surface.
      data_.positions.push_back(readVec3("a coordinate of v"));
    } else if (key == "vn") {
      data_.normals.push_back(readVec3("a coordinate of vn"));
    } else if (key == "vt") {
      const float u = lines_.number("the first coordinate of vt");
      data_.uvs.emplace_back(u, lines_.optionalNumber("the second coordinate of vt").value_or(0.0f));
    } else if (key == "f" || key == "fo") {
      parseFace();
    } else if (key == "usemtl") {
      materialName_ = lines_.rest();
      forgetGroups();
    } else if (key == "o" || key == "g") {
      objectName_ = lines_.rest();
      forgetGroups();
    } else if (key == "mtllib") {
      data_.libraries.emplace_back(lines_.rest());
    } else if (std::find(kIgnoredKeys.begin(), kIgnoredKeys.end(), key) == kIgnoredKeys.end()) {
      warnIgnored(key);
    }
  }

  vec3 readVec3(std::string_view what) {
    const float x = lines_.number(what);
    const float y = lines_.number(what);
    return vec3(x, y, lines_.number(what));
  }

  void warnIgnored(std::string_view key) {
    if (warned_) return;
    warned_ = true;
    job_.warn(fmt::format("{}: line {}: \"{}\" is not supported and ignored, like every other such line",
                          lines_.subject(), lines_.line(), key.substr(0, 40)));
  }

  void parseFace() {
    face_.clear();
    for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
      face_.push_back(parseCorner(word));
    }
    if (face_.size() < 3) lines_.fail("a face needs at least 3 corners, not {}", face_.size());
    const bool normals =
        std::all_of(face_.begin(), face_.end(), [](ObjCorner c) { return c.normal != kObjNone; });
    ObjGroup& group = groupOf(normals);
    for (ObjCorner corner : face_) {
      if (!normals) corner.normal = kObjNone;
      group.hasUvs = group.hasUvs || corner.uv != kObjNone;
      group.corners.push_back(corner);
    }
    group.faceSizes.push_back(std::uint32_t(face_.size()));
    // Two characters of text can become a corner here and a triangle in the mesh.
    cornerCount_ += face_.size();
    const std::uint64_t bytes = cornerCount_ * 2 * sizeof(ObjCorner);
    if (bytes > job_.memoryBudgetBytes) {
      fail(ErrorKind::kResources, lines_.subject(), "needs more than the memory budget of {} bytes",
           job_.memoryBudgetBytes);
    }
  }

  /// "v", "v/vt", "v//vn" or "v/vt/vn".
  ObjCorner parseCorner(std::string_view word) {
    std::array<std::string_view, 3> parts;
    std::string_view left = word;
    std::size_t count = 0;
    for (; count < 3; ++count) {
      const std::size_t slash = left.find('/');
      parts[count] = left.substr(0, slash);
      left = slash == std::string_view::npos ? std::string_view() : left.substr(slash + 1);
      if (slash == std::string_view::npos) break;
    }
    if (count == 3)
      lines_.fail("\"{}\" is no corner: v, v/vt, v//vn or v/vt/vn is expected", word.substr(0, 40));
    return {.position = parseIndex(parts[0], "v", data_.positions.size(), counts_.positions),
            .uv = parts[1].empty() ? kObjNone : parseIndex(parts[1], "vt", data_.uvs.size(), counts_.uvs),
            .normal = parts[2].empty() ? kObjNone
                                       : parseIndex(parts[2], "vn", data_.normals.size(), counts_.normals)};
  }

  /// An index counts from 1, or from -1 backwards from the lines above.
  std::uint32_t parseIndex(std::string_view text, std::string_view key, std::size_t above,
                           std::size_t total) {
    std::string_view digits = text;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    std::int64_t value = 0;
    const char* end = digits.data() + digits.size();
    const auto result = std::from_chars(digits.data(), end, value);
    if (result.ec == std::errc::result_out_of_range) value = 0;
    if (result.ec == std::errc::invalid_argument || result.ptr != end) {
      lines_.fail("\"{}\" is no index: whole numbers as in v, v/vt, v//vn or v/vt/vn are expected",
                  text.substr(0, 40));
    }
    const std::int64_t index = value < 0 ? std::int64_t(above) + value : value - 1;
    if (value == 0 || index < 0 || index >= std::int64_t(total)) {
      lines_.fail("the face refers to {} {}, but the file has {} {} lines{}", key, text.substr(0, 40), total,
                  key, value < 0 ? fmt::format(", {} of them above", above) : std::string());
    }
    return std::uint32_t(index);
  }

  void forgetGroups() { current_ = {kNoGroup, kNoGroup}; }

  ObjGroup& groupOf(bool normals) {
    std::size_t& current = current_[normals ? 1 : 0];
    if (current == kNoGroup) {
      const auto [material, newMaterial] =
          materials_.try_emplace(materialName_, std::uint32_t(data_.materialNames.size()));
      if (newMaterial) data_.materialNames.push_back(materialName_);
      const auto [entry, newGroup] =
          groups_.try_emplace({objectName_, material->second, normals}, data_.groups.size());
      if (newGroup) {
        data_.groups.emplace_back();
        data_.groups.back().name = objectName_;
        data_.groups.back().material = material->second;
        data_.groups.back().hasNormals = normals;
      }
      current = entry->second;
    }
    return data_.groups[current];
  }

  static constexpr std::size_t kNoGroup = ~std::size_t(0);

  TextLines lines_;
  Counts counts_;
  std::string objectName_;
  std::string materialName_;
  const Job& job_;
  ObjGeometry data_;
  std::vector<ObjCorner> face_;
  std::uint64_t cornerCount_ = 0;
  bool warned_ = false;
  std::map<std::string, std::uint32_t> materials_;
  std::map<std::tuple<std::string, std::uint32_t, bool>, std::size_t> groups_;
  std::array<std::size_t, 2> current_ = {kNoGroup, kNoGroup};  ///< Without and with normals.
};

}  // namespace

ObjGeometry parseObj(std::string_view text, const std::string& subject, const std::string& name,
                     const Job& job) {
  return ObjParser(text, subject, name, job).parse();
}

}  // namespace isophote

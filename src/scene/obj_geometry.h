// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "math/shared.h"
#include "scene/scene.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// One corner of a face: indices from 0 into the file's v, vt and vn lines; kObjNone where the face gives
/// none.
struct ObjCorner {
  std::uint32_t position;
  std::uint32_t uv;
  std::uint32_t normal;
  bool operator==(const ObjCorner&) const = default;
};
inline constexpr std::uint32_t kObjNone = 0xffffffffu;

/// Faces of one object (o or g) and one material, either all with normals or all without.
struct ObjGroup {
  std::string name;
  std::uint32_t material = 0;  ///< Index into ObjGeometry::materialNames.
  bool hasNormals = false;
  bool hasUvs = false;  ///< At least one corner has.
  std::vector<ObjCorner> corners;
  std::vector<std::uint32_t> faceSizes;  ///< Corners of each face, at least 3.
};

/// An .obj file as it stands. Every index of every corner is in range.
struct ObjGeometry {
  std::vector<vec3> positions;
  std::vector<vec3> normals;  ///< As written: of any length.
  std::vector<vec2> uvs;      ///< v grows upwards, as in the file.
  std::vector<ObjGroup> groups;
  std::vector<std::string> materialNames;  ///< In order of first use; "" stands for faces before any usemtl.
  std::vector<std::string> libraries;      ///< mtllib lines as written.
};

/// Parses the text of an .obj file. `subject` names it in errors, `name` is that of faces outside any object.
ObjGeometry parseObj(std::string_view text, const std::string& subject, const std::string& name,
                     const Job& job = {});

/// Triangles of a group with its corners' distinct vertices. Material and name are the group's. Normals keep
/// the length that the file gives them: finishScene() makes them unit and replaces those without direction.
Mesh buildObjMesh(const ObjGeometry& geometry, const ObjGroup& group, const Job& job = {});

}  // namespace isophote

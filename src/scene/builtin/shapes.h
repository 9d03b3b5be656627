// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <functional>
#include <span>

namespace isophote {

// Shapes that are appended to a mesh. All in metres, front faces counter-clockwise seen from outside, unit
// normals that agree with the winding. Texture coordinates are metres along the surface, v downwards;
// scaleUvs() turns them into repeats of a texture. One mesh may hold several shapes.

/// The rectangle corner + [0, 1] edgeU + [0, 1] edgeV; its front is where cross(edgeU, edgeV) points. 2
/// triangles.
void addQuad(Mesh& mesh, vec3 corner, vec3 edgeU, vec3 edgeV);

/// A flat triangle; its front is where a, b, c run counter-clockwise.
void addTriangle(Mesh& mesh, vec3 a, vec3 b, vec3 c);

/// Closed axis-aligned box with sharp edges. 12 triangles.
void addBox(Mesh& mesh, vec3 lower, vec3 upper);

/// The same box seen from inside: a room. 12 triangles.
void addRoom(Mesh& mesh, vec3 lower, vec3 upper);

/// Closed latitude-longitude sphere with exact smooth normals. 2 * slices * (stacks - 1) triangles.
void addSphere(Mesh& mesh, vec3 centre, float radius, int slices, int stacks);

/// A patch of (columns + 1) x (rows + 1) points with smooth normals; its front is where
/// cross(d surface / d column, d surface / d row) points. Patches whose last column or row meets their first
/// are smooth across that seam when `closedColumns` or `closedRows` says so. Triangles without area are left
/// out.
struct Patch {
  int columns = 1;
  int rows = 1;
  bool closedColumns = false;
  bool closedRows = false;
};
void addPatch(Mesh& mesh, const Patch& patch, const std::function<vec3(int column, int row)>& surface);

/// A point of a profile that turns around the y axis.
struct ProfilePoint {
  float radius = 0;      ///< [m]
  float height = 0;      ///< [m]
  float squareness = 0;  ///< 0: circle; 1: the square around that circle, sides along x and z.
};

/// Draws a profile along a path: `surface` gives where a profile's point lies at step 0 ... columns of the
/// path. A point given twice in a row is a sharp edge; elsewhere the normals are smooth. Front as for
/// addPatch(), rows along the profile.
void addSweep(Mesh& mesh, std::span<const ProfilePoint> profile, int columns, bool closed,
              const std::function<vec3(int column, const ProfilePoint& point)>& surface);

/// Turns a profile around the y axis. The profile runs so that the outside lies to its right: upwards for a
/// column, whose radius is its distance from the axis. Sharp edges as for addSweep().
void addLathe(Mesh& mesh, std::span<const ProfilePoint> profile, int slices);

/// Draws a profile around the rectangle with corners (+-half.x, +-half.y) in x and z, mitred at the corners:
/// `radius` is how far it stands out. `inwards`: the rectangle is a yard, and the moulding stands out into
/// it.
void addMoulding(Mesh& mesh, std::span<const ProfilePoint> profile, vec2 half, bool inwards = false);

/// Adds all of `part`, which has normals and texture coordinates.
void append(Mesh& mesh, const Mesh& part);

/// Swaps front and back of everything in the mesh.
void flip(Mesh& mesh);

/// Moves the whole mesh; the matrix may turn and scale uniformly, but not mirror.
void transform(Mesh& mesh, const mat4x3& to);

/// Divides all texture coordinates, so that a texture repeats every `metres`.
void scaleUvs(Mesh& mesh, float metres);

/// Turn by `degrees` about the y axis (from z towards x), then move.
mat4x3 turnedAndMoved(float degrees, vec3 to);

/// A pure Lambertian material: no specular reflection at all.
NamedMaterial lambert(std::string name, vec3 albedo);

/// Each returns the index of what it added to the scene; addObject() adds a mesh and one instance of it in
/// place.
std::uint32_t addMaterial(Scene& scene, NamedMaterial material);
std::uint32_t addMesh(Scene& scene, std::string name, std::uint32_t material, Mesh mesh);
std::uint32_t addObject(Scene& scene, std::string name, std::uint32_t material, Mesh mesh);
void addInstance(Scene& scene, std::string name, std::uint32_t mesh, const mat4x3& worldFromObject);

}  // namespace isophote

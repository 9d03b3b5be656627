// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#ifndef ISOPHOTE_PHYSICS_LIGHT_SHARED_H
#define ISOPHOTE_PHYSICS_LIGHT_SHARED_H

#include "math/shared.h"

SHARED_BEGIN

SHARED_CONST uint kLightPoint = 0u;        ///< Isotropic; a sphere where radius > 0.
SHARED_CONST uint kLightSpot = 1u;         ///< glTF's smooth falloff between the two cone angles.
SHARED_CONST uint kLightDirectional = 2u;  ///< Parallel rays from infinity.
SHARED_CONST uint kLightRectangle = 3u;    ///< One-sided diffuse emitter.
SHARED_CONST uint kLightMesh =
    4u;  ///< All emissive triangles of one mesh instance (Scene::emissiveTriangles).
SHARED_CONST uint kLightEnvironment = 5u;  ///< Radiance from everywhere outside the scene.

/// One light in world space. What `colour` means depends on the type:
/// point, spot: radiant intensity on the axis [W/sr]; directional: irradiance on a surface facing it [W/m^2];
/// rectangle, environment: emitted radiance [W/(m^2 sr)], by which the map of an environment that has one is
/// multiplied; mesh: 1, radiance lies in the triangles. 96 bytes.
struct Light {
  vec3 position;   ///< Point, spot: centre. Rectangle: its corner. [m]
  uint type;       ///< kLight...
  vec3 direction;  ///< Unit, of travel: spot's axis, directional's direction, rectangle's emitting normal.
  float radius;    ///< Point: radius of the emitting sphere, 0 for a true point [m].
  vec3 colour;
  float area;      ///< Rectangle, mesh: emitting area [m^2].
  vec3 edgeU;      ///< Rectangle: position + u * edgeU + v * edgeV, u and v in [0, 1]; direction = normalised
                   ///< cross(edgeU, edgeV). Environment with a map: unit, what is right of the map's
                   ///< middle...
  float cosInner;  ///< Spot.
  vec3 edgeV;      ///< ...and what is at its top.
  float cosOuter;  ///< Spot.
  uint firstTriangle;  ///< Mesh: range in Scene::emissiveTriangles.
  uint triangleCount;
  float
      power;  ///< Total emitted power, mean of RGB [W]; directional, environment: through the scene's bounds.
  uint mapped;  ///< Environment: 1 where Scene::environment is its map.
};

/// A triangle that emits from its front (both sides when its material is double-sided). World space. Those of
/// a light are in the order of their mesh; triangles without area are left out.
struct EmissiveTriangle {
  vec3 v0;
  uint instance;
  vec3 edge1;         ///< v1 - v0
  uint triangle;      ///< Index in its mesh.
  vec3 edge2;         ///< v2 - v0
  float probability;  ///< Its part of its light's power.
  vec3 radiance;      ///< [W/(m^2 sr)]; the mean over the triangle where a texture decides.
  uint doubleSided;
};

/// Which triangle of n a uniform number u in [0, 1) picks, each by its probability: slot floor(u n) where the
/// fraction of u n is below `own`, else `other` (an alias table).
struct AliasSlot {
  float own;
  uint other;  ///< Within the light's range.
};

SHARED_END

#endif

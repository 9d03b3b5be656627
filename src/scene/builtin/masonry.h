// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/builtin/shapes.h"

namespace isophote {

// Parts of a building, each appended to a mesh about the origin: x along the wall, y up, z towards the
// onlooker.

/// Points of an arc from one angle to another (0 degrees: outwards, 90: upwards), both ends included and
/// doubled: sharp edges towards what comes before and after.
void addArc(std::vector<ProfilePoint>& profile, vec2 centre, float radius, float fromDegrees, float toDegrees,
            int steps);

/// A column that stands on y = 0: square plinth, Attic base, tapered shaft, capital that turns from round to
/// square, abacus.
struct Column {
  float height = 3;     ///< With plinth and abacus [m].
  float radius = 0.2f;  ///< At the foot of the shaft [m].
  float abacus = 0.3f;  ///< Half the side of the square that carries the load [m].
  int slices = 24;
  int arcSteps = 4;  ///< Facets across the base's largest roll.
};
void addColumn(Mesh& mesh, const Column& column);

/// A piece of wall over a round arch, z in [-depth / 2, depth / 2]. Ends at x = +-width / 2 and the foot are
/// left open: they meet neighbours and capitals.
struct ArchWall {
  float width = 3;         ///< [m]
  float radius = 1;        ///< Of the opening [m].
  float springing = 3;     ///< Height at which the arch begins [m].
  float top = 5;           ///< [m]
  float depth = 0.6f;      ///< [m]
  float archivolt = 0.2f;  ///< Width of the moulded band around the arch on the front [m].
  int segments = 24;
};
void addArchWall(Mesh& mesh, const ArchWall& wall);

/// A square groin vault seen from below: two round barrels of `radius` that cross, over x, z in [-radius,
/// radius].
void addGroinVault(Mesh& mesh, float radius, float springing, int segments);

/// A band under a vault: a half ring in the plane x = 0 around z = 0, of rectangular section.
struct TransverseArch {
  float radius = 1.4f;     ///< Inner [m].
  float thickness = 0.1f;  ///< Radially [m].
  float width = 0.3f;      ///< Along x [m].
  float springing = 3;     ///< [m]
  int segments = 24;
};
void addTransverseArch(Mesh& mesh, const TransverseArch& arch);

/// A balustrade from x = -length / 2 to length / 2 on y = 0: a foot, balusters, a rail.
struct Balustrade {
  float length = 1;     ///< [m]
  float height = 0.9f;  ///< [m]
  int balusters = 4;
  int slices = 8;
};
void addBalustrade(Mesh& mesh, const Balustrade& balustrade);

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#ifndef ISOPHOTE_STAGES_PHOTON_ESTIMATE_PHOTON_ELLIPSOID_SHARED_H
#define ISOPHOTE_STAGES_PHOTON_ESTIMATE_PHOTON_ELLIPSOID_SHARED_H

#include "physics/photon.shared.h"
#include "physics/photon_differential.shared.h"

SHARED_BEGIN

/// The ellipsoid of three unequal axes in which one photon is felt, unpacked for the inner loop: t^2 = d^T Q
/// d of an offset d from the photon. 64 bytes.
struct PhotonEllipsoid {
  vec3 position;
  float xx;        ///< Of Q [1/m^2].
  vec3 direction;  ///< Towards where the photon came from.
  float yy;
  vec3 weightedPower;  ///< Power times the kernel's normalisation [W/m^2].
  float zz;
  float xy;  ///< Twice that of Q, as are the next two.
  float xz;
  float yz;
  float reserved;
};

/// Squared distance from the photon in units of its ellipsoid.
SHARED_FN float ellipsoidDistance2(PhotonEllipsoid p, vec3 position) {
  vec3 d = position - p.position;
  return d.x * (p.xx * d.x + p.xy * d.y + p.xz * d.z) + d.y * (p.yy * d.y + p.yz * d.z) + p.zz * d.z * d.z;
}

/// Semi-axes of a footprint, perpendicular to each other: unit vectors in the plane and lengths [m].
struct FootprintAxes {
  vec3 major;
  float majorRadius;
  vec3 minor;
  float minorRadius;
};

/// The same ellipse as that of the footprint's own axes, which need not be perpendicular. n: unit, of the
/// plane.
SHARED_FN FootprintAxes footprintAxes(PhotonFootprint f, vec3 n) {
  float xx = dot(f.axisX, f.axisX);
  float xy = dot(f.axisX, f.axisY);
  float yy = dot(f.axisY, f.axisY);
  float halfDifference = 0.5f * (xx - yy);
  float larger2 = 0.5f * (xx + yy) + sqrt(halfDifference * halfDifference + xy * xy);
  // An eigenvector, by the row of the matrix that is farther from 0.
  float alongX = xx >= yy ? larger2 - yy : xy;
  float alongY = xx >= yy ? xy : larger2 - xx;
  vec3 major = f.axisX * alongX + f.axisY * alongY;
  float length2 = dot(major, major);
  FootprintAxes a;
  mat3 any = basisAround(n);
  // Round ones have no longer axis.
  a.major = length2 > 1e-24f * larger2 * larger2 * larger2 && length2 > 0.0f ? major * inversesqrt(length2)
                                                                             : any[0];
  a.major = a.major - n * dot(a.major, n);
  a.major = a.major * inversesqrt(max(dot(a.major, a.major), 1e-30f));
  a.minor = cross(n, a.major);
  a.majorRadius = sqrt(larger2);
  vec3 across = cross(f.axisX, f.axisY);
  a.minorRadius = sqrt(dot(across, across)) / max(a.majorRadius, 1e-30f);
  return a;
}

/// What becomes of a semi-axis of that length before its limits (IGPM 4.3): those of scattered photons are
/// compressed, in units of a length and of the spacing of directions.
struct FootprintSmoothing {
  float scattered;        ///< Factor of those that a diffuse surface has scattered,
  float caustic;          ///< and of the others.
  float compression;      ///< Exponent: a length l becomes one in proportion to l^(1 - compression).
  float referenceLength;  ///< At which, times the spacing, nothing is compressed [m].
};

SHARED_FN float smoothedRadius(FootprintSmoothing s, float radius, float spacing, uint scattered) {
  float unit = spacing * s.referenceLength;
  float units = max(radius / unit, 1e-12f);
  // The paper's value has no need of the slow function.
  float compressed = unit * (s.compression == 0.75f ? sqrt(sqrt(units)) : pow(units, 1.0f - s.compression));
  return scattered != 0u ? s.scattered * compressed : s.caustic * radius;
}

/// Ellipsoid of those semi-axes; flatness = height / minor radius. Over the photon's tangent plane the kernel
/// integrates to 1: it is normalised by the area of the section there.
SHARED_FN PhotonEllipsoid photonEllipsoid(Photon p, uint kernel, FootprintAxes a, vec3 n, float flatness) {
  vec3 u = a.major / a.majorRadius;
  vec3 v = a.minor / a.minorRadius;
  vec3 w = n / (flatness * a.minorRadius);
  PhotonEllipsoid e;
  e.position = p.position;
  e.xx = u.x * u.x + v.x * v.x + w.x * w.x;
  e.yy = u.y * u.y + v.y * v.y + w.y * w.y;
  e.zz = u.z * u.z + v.z * v.z + w.z * w.z;
  e.xy = 2.0f * (u.x * u.y + v.x * v.y + w.x * w.y);
  e.xz = 2.0f * (u.x * u.z + v.x * v.z + w.x * w.z);
  e.yz = 2.0f * (u.y * u.z + v.y * v.z + w.y * w.z);
  e.direction = unpackDirection(p.direction);
  e.weightedPower = p.power * kernelNormalisation(kernel, sqrt(a.majorRadius * a.minorRadius));
  e.reserved = 0.0f;
  return e;
}

/// Half the sides of the box around that ellipsoid.
SHARED_FN vec3 ellipsoidReach(FootprintAxes a, vec3 n, float flatness) {
  vec3 u = a.major * a.majorRadius;
  vec3 v = a.minor * a.minorRadius;
  vec3 w = n * (flatness * a.minorRadius);
  return sqrt(u * u + v * v + w * w);
}

SHARED_END

#endif

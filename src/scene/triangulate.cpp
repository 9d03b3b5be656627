// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/triangulate.h"

#include <cstddef>
#include <numeric>

namespace isophote {

namespace {

using Point = glm::dvec2;

/// Above this the quadratic search for ears gives way to a fan.
constexpr std::size_t kMostEarCorners = 256;

/// Twice the signed area of triangle abc.
double cross2(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// The polygon in the coordinate plane that shows most of it, counter-clockwise.
std::vector<Point> projected(std::span<const vec3> corners) {
  glm::dvec3 normal(0.0);  // Newell's: the sum over edges, relative to the first corner for precision.
  const glm::dvec3 origin(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal +=
        glm::cross(glm::dvec3(corners[i]) - origin, glm::dvec3(corners[(i + 1) % corners.size()]) - origin);
  }
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const double flip = normal[axis] < 0 ? -1.0 : 1.0;
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const vec3& corner : corners) {
    const glm::dvec3 p = glm::dvec3(corner) - origin;
    points.emplace_back(flip * p[u], p[v]);
  }
  return points;
}

bool isConvex(std::span<const Point> points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (cross2(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
  }
  return true;
}

/// Whether the corner at `ring[i]` can be cut off: it is convex and holds no other corner.
bool isEar(std::span<const Point> points, std::span<const uint> ring, std::size_t i) {
  const std::size_t n = ring.size();
  const Point a = points[ring[(i + n - 1) % n]];
  const Point b = points[ring[i]];
  const Point c = points[ring[(i + 1) % n]];
  if (cross2(a, b, c) <= 0) return false;
  for (std::size_t k = 2; k + 1 < n; ++k) {
    const Point p = points[ring[(i + k) % n]];
    if (p == a || p == b || p == c) continue;
    if (cross2(a, b, p) >= 0 && cross2(b, c, p) >= 0 && cross2(c, a, p) >= 0) return false;
  }
  return true;
}

void appendFan(std::span<const uint> ring, std::vector<uvec3>& triangles) {
  for (std::size_t i = 2; i < ring.size(); ++i) triangles.emplace_back(ring[0], ring[i - 1], ring[i]);
}

}  // namespace

void triangulatePolygon(std::span<const vec3> corners, std::vector<uvec3>& triangles) {
  if (corners.size() < 3) return;
  std::vector<uint> ring(corners.size());
  std::iota(ring.begin(), ring.end(), 0u);
  if (corners.size() > 3 && corners.size() <= kMostEarCorners) {
    const std::vector<Point> points = projected(corners);
    if (!isConvex(points)) {
      std::size_t i = 0;
      for (std::size_t misses = 0; ring.size() > 3 && misses < ring.size();) {
        const std::size_t n = ring.size();
        if (!isEar(points, ring, i)) {
          i = (i + 1) % n;
          ++misses;
          continue;
        }
        triangles.emplace_back(ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
        ring.erase(ring.begin() + std::ptrdiff_t(i));
        i %= ring.size();
        misses = 0;
      }
    }
  }
  appendFan(ring, triangles);
}

}  // namespace isophote

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isophote {
namespace {

/// Vector areas of the triangles: their sum is the polygon's, and each points where it does.
std::vector<vec3> areasOf(const std::vector<vec3>& corners) {
  std::vector<uvec3> triangles;
  triangulatePolygon(corners, triangles);
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  std::vector<vec3> areas;
  for (const uvec3& t : triangles) {
    areas.push_back(0.5f * cross(corners[t.y] - corners[t.x], corners[t.z] - corners[t.x]));
  }
  return areas;
}

void expectCovers(const std::vector<vec3>& corners, vec3 area) {
  vec3 sum(0.0f);
  for (const vec3& part : areasOf(corners)) {
    sum += part;
    EXPECT_GT(dot(part, area), 0.0f) << "a triangle lies outside of the polygon or is turned round";
  }
  EXPECT_NEAR(length(sum - area), 0.0f, 1e-5f * length(area));
}

TEST(Triangulate, FansConvexPolygons) {
  std::vector<uvec3> triangles;
  triangulatePolygon(std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 2, 0}}, triangles);
  EXPECT_EQ(triangles, (std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(Triangulate, CutsEarsOffConcavePolygons) {
  expectCovers({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 1, 0}}, vec3(0, 0, 4));   // A dart.
  expectCovers({{0, 0, 0}, {3, 1, 0}, {4, 4, 0}, {4, 0, 0}}, vec3(0, 0, -4));  // Clockwise.
  expectCovers({{0, 0, 0}, {0, 0, 3}, {0, 1, 3}, {0, 1, 1}, {0, 3, 1}, {0, 3, 0}},
               vec3(-5, 0, 0));  // An L in x = 0.
}

TEST(Triangulate, CutsEarsOffAStar) {
  std::vector<vec3> star;
  double area = 0;
  for (int i = 0; i < 40; ++i) {
    const double radius = i % 2 == 0 ? 2.0 : 1.0;
    star.emplace_back(radius * std::cos(i * M_PI / 20), 7.0, -radius * std::sin(i * M_PI / 20));
    area += 0.5 * 2.0 * 1.0 * std::sin(M_PI / 20);
  }
  expectCovers(star, vec3(0, float(area), 0));
}

TEST(Triangulate, AlwaysGivesTheSameNumber) {
  EXPECT_EQ(areasOf({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);  // A bow tie.
  EXPECT_EQ(areasOf(std::vector<vec3>(9, vec3(1.0f))).size(), 7u);              // A point.
  std::vector<vec3> zigzag;
  for (int i = 0; i < 5000; ++i) zigzag.emplace_back(float(i), float(i % 2), 0.0f);
  EXPECT_EQ(areasOf(zigzag).size(), 4998u);
}

}  // namespace
}  // namespace isophote

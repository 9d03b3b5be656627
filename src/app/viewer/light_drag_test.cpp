// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/light_drag.h"
#include "scene/scene.h"

#include <gtest/gtest.h>

#include <array>

namespace isophote::viewer {
namespace {

PictureView viewFrom(vec3 eye, vec3 target, float orthographicHeight = 0) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.orthographicHeight = orthographicHeight;
  return {cameraRays(camera, 640, 360), vec2(640, 360)};
}

TEST(LightDrag, PixelsAreThoseOfTheCamerasRays) {
  for (const float orthographic : {0.0f, 3.0f}) {
    const PictureView view = viewFrom({1, 2, 5}, {0, 1, -1}, orthographic);
    const vec2 pixel(123.5f, 77.25f);
    const vec2 p = imagePlaneFromPixel(pixel, view.size);
    const vec3 point = cameraRayOrigin(view.rays, p) + cameraRayDirection(view.rays, p) * 4.0f;
    const std::optional<vec2> seen = pixelOf(view, point);
    ASSERT_TRUE(seen);
    EXPECT_LT(length(*seen - pixel), 1e-2f);
    EXPECT_FALSE(pixelOf(view, view.rays.eye - view.rays.forward)) << "behind the eye";
  }
}

TEST(LightDrag, PicksTheNearestMarkerInReach) {
  const std::array<std::optional<vec2>, 4> markers{vec2(10, 10), std::nullopt, vec2(16, 10), vec2(300, 200)};
  EXPECT_EQ(markerAt(markers, vec2(14, 10), 12), 2u);
  EXPECT_EQ(markerAt(markers, vec2(11, 10), 12), 0u);
  EXPECT_EQ(markerAt(markers, vec2(100, 100), 12), std::nullopt);
}

TEST(LightDrag, StaysBeneathThePointer) {
  for (const float orthographic : {0.0f, 3.0f}) {
    const PictureView view = viewFrom({1, 2, 5}, {0, 1, -1}, orthographic);
    const vec3 light(0.3f, 1.2f, -2);
    const vec2 from = *pixelOf(view, light), to(500, 90);
    const vec3 moved = draggedInPlane(view, light, from, to);
    EXPECT_LT(length(*pixelOf(view, moved) - to), 2e-2f);
    EXPECT_NEAR(dot(moved - light, view.rays.forward), 0.0f, 1e-5f) << "parallel to the picture";
  }
}

TEST(LightDrag, GoesAlongAnAxis) {
  const PictureView view = viewFrom({0, 0, 5}, {0, 0, 0});
  const vec3 light(0.0f);
  const vec2 from = *pixelOf(view, light);
  const vec3 moved = draggedAlong(view, light, vec3(1, 0, 0), from, from + vec2(50, 400));
  EXPECT_LT(length(*pixelOf(view, moved) - (from + vec2(50, 0))), 0.1f) << "only as far as along the axis";
  EXPECT_EQ(moved.y, 0.0f);
  EXPECT_EQ(moved.z, 0.0f);
  EXPECT_EQ(draggedAlong(view, light, vec3(0, 0, 1), from, from + vec2(50, 40)), light) << "seen end on";
}

TEST(LightDrag, TurnsADirection) {
  const PictureView view = viewFrom({0, 0, 5}, {0, 0, 0});
  const vec2 start(100, 100);
  const vec3 down = turnedDirection(view, vec3(0, 0, -1), start, start + vec2(0, -90));
  EXPECT_LT(length(down - vec3(0, -sqrt(0.5f), -sqrt(0.5f))), 1e-5f)
      << "a quarter of the height is 45 degrees";
  EXPECT_NEAR(length(turnedDirection(view, vec3(0, 0, -1), start, vec2(7, 300))), 1.0f, 1e-5f);
}

}  // namespace
}  // namespace isophote::viewer

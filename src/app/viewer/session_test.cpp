// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/session.h"
#include "base/error.h"
#include "scene/light_place.h"

#include <gmock/gmock.h>

namespace isophote::viewer {
namespace {

/// The Cornell box under a point light, a sun and a spot.
Scene litScene() {
  Scene scene = loadScene("cornell-box");
  Light light{};
  light.type = kLightPoint;
  light.position = scene.bounds.centre();
  light.direction = {0, -1, 0};
  light.colour = vec3(1.0f);
  scene.lights = {light};
  light.type = kLightDirectional;
  scene.lights.push_back(light);
  light.type = kLightSpot;
  light.position += vec3(0.2f, 0.2f, 0);
  light.cosInner = 0.9f;
  light.cosOuter = 0.8f;
  scene.lights.push_back(light);
  finishScene(scene, "test");
  return scene;
}

class ViewerSession : public testing::Test {
 protected:
  ViewerSession()
      : scene(litScene()), session(scene, scene.cameras.front(), {}, "", [](std::string_view name) {
          return name.empty() ? RenderSettings{} : presetSettings(name);
        }) {
    session.setPictureSize(640, 360);
    session.request();
  }

  void press(std::string_view key) { session.pressKey(parseKey(key).value()); }

  Scene scene;
  Session session;
};

TEST_F(ViewerSession, AsksAgainOnlyForWhatHasChanged) {
  EXPECT_FALSE(session.request());
  session.movePointer({3, 3});
  session.tick(0.1f);
  EXPECT_FALSE(session.request());
  press("F");
  const auto framed = session.request();
  ASSERT_TRUE(framed);
  EXPECT_FALSE(framed->moving);
  EXPECT_EQ(framed->settings.frame.width, 640u);
  session.set("view.scale", "0.5");
  EXPECT_EQ(session.request()->settings.frame.height, 180u);
}

TEST_F(ViewerSession, FliesWhileAKeyIsHeld) {
  const vec3 eye = session.camera().camera().eye;
  press("W");
  EXPECT_TRUE(session.flies());
  session.tick(0.1f);
  const auto flying = session.request();
  ASSERT_TRUE(flying);
  EXPECT_TRUE(flying->moving);
  const float slow = length(flying->camera.eye - eye);
  EXPECT_GT(slow, 0.0f);
  session.releaseKey('W');
  session.tick(0.1f);
  const auto rested = session.request();
  ASSERT_TRUE(rested) << "the motion has ended";
  EXPECT_FALSE(rested->moving);
  EXPECT_EQ(rested->camera.eye, flying->camera.eye);
  press("Shift+W");
  session.tick(0.1f);
  EXPECT_NEAR(length(session.camera().camera().eye - rested->camera.eye), 5 * slow, 1e-3f * slow);
  session.releaseAll();
  EXPECT_FALSE(session.flies());
}

TEST_F(ViewerSession, ALightIsPickedByItsMarkerAndDragged) {
  const vec2 marker = session.markers()[0].value();
  EXPECT_FALSE(session.markers()[1]) << "a sun is nowhere";
  session.pressButton(MouseButton::kLeft, marker + vec2(3, -2), false, false);
  EXPECT_EQ(session.selected(), 0u);
  session.movePointer(marker + vec2(43, -22));
  const auto dragged = session.request();
  ASSERT_TRUE(dragged);
  EXPECT_TRUE(dragged->moving);
  EXPECT_NE(dragged->lights[0].position, scene.lights[0].position);
  EXPECT_EQ(dragged->camera.eye, scene.cameras.front().eye) << "the camera stays";
  EXPECT_LT(length(session.markers()[0].value() - (marker + vec2(40, -20))), 0.1f);
  const vec3 before = session.lights()[0].position;
  press("Y");
  session.movePointer(marker + vec2(60, -60));
  EXPECT_EQ(session.lights()[0].position.x, before.x) << "along y alone";
  EXPECT_GT(session.lights()[0].position.y, before.y);
  session.releaseButton(MouseButton::kLeft);
  EXPECT_FALSE(session.request()->moving);
  press("Shift+R");
  EXPECT_EQ(session.lights()[0].position, scene.lights[0].position);
}

TEST_F(ViewerSession, ASunIsTurned) {
  press("L");
  press("L");
  EXPECT_EQ(session.selected(), 1u);
  session.pressButton(MouseButton::kLeft, {5, 5}, false, true);
  session.movePointer({5, 60});
  EXPECT_NE(session.lights()[1].direction, scene.lights[1].direction);
  EXPECT_EQ(session.camera().camera().target, scene.cameras.front().target);
  press("Escape");
  EXPECT_FALSE(session.selected());
}

TEST_F(ViewerSession, TheMouseTurnsAndPansElsewhere) {
  session.pressButton(MouseButton::kRight, session.markers()[0].value(), false, false);
  session.movePointer({10, 10});
  EXPECT_NE(session.camera().camera().target, scene.cameras.front().target);
  EXPECT_EQ(session.camera().camera().eye, scene.cameras.front().eye);
  session.releaseButton(MouseButton::kRight);
  press("R");
  EXPECT_EQ(session.camera().camera().target, scene.cameras.front().target);
  session.pressButton(MouseButton::kLeft, {5, 5}, true, false);
  session.movePointer({50, 5});
  EXPECT_NE(session.camera().camera().eye, scene.cameras.front().eye);
}

TEST_F(ViewerSession, KeysDoWhatTheirHelpSays) {
  press("1");
  EXPECT_EQ(session.preset(), presets().front().name);
  EXPECT_EQ(session.request()->settings.photonKdtree.nearest,
            presetSettings(presets().front().name).photonKdtree.nearest);
  press("0");
  EXPECT_EQ(session.preset(), "");
  press("=");
  press("T");
  press("G");
  EXPECT_NEAR(session.settings().display.exposureEv, 1.0f / 3.0f, 1e-6f);
  EXPECT_EQ(session.settings().display.toneMap, ToneMap::kAces);
  EXPECT_TRUE(session.settings().display.autoExposure);
  press("Shift+P");
  press("P");
  EXPECT_THAT(session.screenshots, testing::ElementsAre(".exr", ".png"));
  press("H");
  press("Tab");
  EXPECT_TRUE(session.helpShown);
  EXPECT_FALSE(session.panelShown);
  press("Q");
  EXPECT_FALSE(session.closed) << "flies down";
  press("Ctrl+Q");
  EXPECT_TRUE(session.closed);
}

TEST_F(ViewerSession, RefusesWhatIsNotThere) {
  EXPECT_THROW(session.moveLight(3, vec3(0.0f)), Error);
  EXPECT_THROW(session.moveLight(1, vec3(0.0f)), Error);
  EXPECT_THROW(session.set("photon_trace.photon", "3"), Error);
  EXPECT_THROW(session.set("view.scale", "7"), Error);
  EXPECT_EQ(session.settings().view.scale, 1.0f);
}

}  // namespace
}  // namespace isophote::viewer

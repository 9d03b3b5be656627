// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/render_loop.h"
#include "base/error.h"
#include "render/cpu_frame.h"
#include "scene/light_place.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

namespace isophote::viewer {
namespace {

/// A loop over the Cornell box, and what it has shown.
class Loop {
 public:
  explicit Loop(const std::string& scene = "cornell-box") : scene_(loadScene(scene)), trace_(scene_) {
    request.settings.frame.width = 48;
    request.settings.frame.height = 36;
    request.settings.frame.layers = false;
    request.settings.photonTrace.photons = 4000;
    request.camera = scene_.cameras.front();
    request.lights.assign(trace_.lights().begin(), trace_.lights().end());
    loop_.emplace(trace_, Job{}, [this] {
      const std::lock_guard lock(mutex_);
      ++events_;
      came_.notify_one();
    });
  }

  RenderLoop& loop() { return *loop_; }
  const Scene& scene() const { return scene_; }
  std::uint64_t show() { return loop_->show(request); }

  /// Waits for pictures until one satisfies `good`; false where none comes for a minute.
  bool waitFor(const std::function<bool(const RenderedPicture&)>& good) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (std::chrono::steady_clock::now() < end) {
      if (loop_->take(picture) && good(picture)) return true;
      std::unique_lock lock(mutex_);
      came_.wait_for(lock, std::chrono::milliseconds(20), [&] { return events_ > 0; });
      events_ = 0;
    }
    return false;
  }
  bool waitForNumber(std::uint64_t number) {
    return waitFor([&](const RenderedPicture& p) { return p.number == number; });
  }
  bool waitUntilIdle() {
    for (int i = 0; i < 3000 && !loop_->idle(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return loop_->idle();
  }
  bool waitForError() {
    for (int i = 0; i < 3000 && loop_->error().empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return !loop_->error().empty();
  }

  RenderRequest request;
  RenderedPicture picture;

 private:
  Scene scene_;
  TraceScene trace_;
  std::mutex mutex_;
  std::condition_variable came_;
  int events_ = 0;
  std::optional<RenderLoop> loop_;
};

/// Settings whose frame takes minutes, if nobody breaks it off.
RenderSettings endless(RenderSettings settings) {
  settings.frame.width = settings.frame.height = 512;
  settings.frame.aa = 65536;
  return settings;
}

TEST(RenderLoop, ShowsWhatRenderGives) {
  Loop loop;
  loop.request.view.refine = false;
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  Stats stats;
  const Film film = renderCpu(loop.scene(), loop.request.camera, loop.request.settings, stats);
  EXPECT_EQ(loop.picture.film->colour.pixels, film.colour.pixels);
  EXPECT_EQ(loop.picture.film->metadata, film.metadata);
  EXPECT_EQ(loop.picture.passes, 1u);
  EXPECT_GT(loop.picture.stats.stageMilliseconds("photon_trace"), 0.0);
  EXPECT_TRUE(loop.waitUntilIdle());
}

TEST(RenderLoop, AMovedLightLightsFromThere) {
  Loop loop("colour-bleed");
  loop.request.view.refine = false;
  loop.request.moving = true;
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  Light& lamp = loop.request.lights.front();
  lamp = movedLight(lamp, lightPosition(lamp).value() + vec3(0.1f, -0.1f, 0.1f));
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  Scene there = loadScene("colour-bleed");
  there.lights = loop.request.lights;
  Stats stats;
  const Film film = renderCpu(there, loop.request.camera, loop.request.settings, stats);
  EXPECT_EQ(loop.picture.film->colour.pixels, film.colour.pixels);
}

TEST(RenderLoop, PassesGoOnWhileNothingMoves) {
  Loop loop;
  loop.request.view.refinePasses = 5;
  loop.show();
  ASSERT_TRUE(loop.waitFor([](const RenderedPicture& p) { return p.passes == 5; }));
  EXPECT_TRUE(loop.waitUntilIdle()) << "five were asked for";
  const std::vector<vec3> five = loop.picture.film->colour.pixels;
  // Goes on from the picture that is there.
  loop.request.view.refinePasses = 7;
  loop.show();
  ASSERT_TRUE(loop.waitFor([](const RenderedPicture& p) { return p.passes == 7; }));
  // Another view starts anew, and the first one again gives the same bytes.
  const Camera camera = loop.request.camera;
  loop.request.camera.eye.x += 0.1f;
  loop.request.moving = true;
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  EXPECT_EQ(loop.picture.passes, 1u);
  loop.request.camera = camera;
  loop.request.moving = false;
  loop.request.view.refinePasses = 5;
  const std::uint64_t again = loop.show();
  ASSERT_TRUE(loop.waitFor([&](const RenderedPicture& p) { return p.number == again && p.passes == 5; }));
  EXPECT_EQ(loop.picture.film->colour.pixels, five);
}

TEST(RenderLoop, ComesToRestOnThePictureOfTheMotion) {
  Loop loop;
  loop.request.view.refinePasses = 2;
  loop.request.moving = true;
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  const std::shared_ptr<const Film> moving = loop.picture.film;
  loop.request.moving = false;
  const std::uint64_t still = loop.show();
  ASSERT_TRUE(loop.waitForNumber(still));
  EXPECT_EQ(loop.picture.passes, 2u) << "the first was there";
  EXPECT_NE(loop.picture.film->colour.pixels, moving->colour.pixels);
}

TEST(RenderLoop, TheLatestRequestWinsAndBreaksOffOthers) {
  Loop loop;
  const RenderSettings quick = loop.request.settings;
  loop.request.settings = endless(quick);
  loop.show();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  loop.show();  // The same again breaks nothing off.
  loop.request.settings = quick;
  loop.request.view.refine = false;
  const std::uint64_t last = loop.show();
  ASSERT_TRUE(loop.waitFor([](const RenderedPicture&) { return true; }));
  EXPECT_EQ(loop.picture.number, last) << "no other was ever done";
  EXPECT_EQ(loop.picture.film->colour.width, 48);
  EXPECT_EQ(loop.loop().error(), "");
}

TEST(RenderLoop, EndsWhileItRenders) {
  Loop loop;
  loop.request.settings = endless(loop.request.settings);
  loop.show();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

TEST(RenderLoop, SaysWhyThereIsNoPictureAndGoesOn) {
  Loop loop;
  RenderSettings& settings = loop.request.settings;
  settings.frame.firstBounce = FirstBounce::kMap;
  settings.photonTrace.photonsStored = 1000;
  loop.show();
  ASSERT_TRUE(loop.waitForError());
  EXPECT_THAT(loop.loop().error(), testing::HasSubstr("photonsStored"));
  settings.photonTrace.photonsStored = 0;
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  EXPECT_EQ(loop.loop().error(), "");
}

TEST(RenderLoop, DraftsAreSmallerOnlyWhereNeedBe) {
  EXPECT_EQ(draftDivisor(0, 100), 1) << "nothing is known yet";
  EXPECT_EQ(draftDivisor(100, 100), 1);
  EXPECT_EQ(draftDivisor(101, 100), 2);
  EXPECT_EQ(draftDivisor(500, 100), 3);
  EXPECT_EQ(draftDivisor(1e6, 100), 4);
  EXPECT_EQ(draftDivisor(1e6, 0), 1) << "never";

  Loop loop;
  loop.request.view.refine = false;
  loop.request.view.draftMilliseconds = 1e-3f;
  loop.request.moving = true;
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  EXPECT_EQ(loop.picture.divisor, 1);
  loop.request.camera.eye.x += 0.01f;
  ASSERT_TRUE(loop.waitForNumber(loop.show()));
  EXPECT_EQ(loop.picture.divisor, 4);
  EXPECT_EQ(loop.picture.film->colour.width, 12);
  loop.request.moving = false;
  ASSERT_TRUE(loop.waitForNumber(loop.show())) << "at rest, the whole picture";
  EXPECT_EQ(loop.picture.divisor, 1);
  EXPECT_EQ(loop.picture.film->colour.width, 48);
}

}  // namespace
}  // namespace isophote::viewer

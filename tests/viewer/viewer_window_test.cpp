// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The whole viewer, played by scripts on an X server without a screen.
#include "image/files.h"
#include "support/display_server.h"
#include "support/files.h"
#include "support/program.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

namespace isophote {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

constexpr const char* kSmall = " --photons 2000 --width 96 --height 72 --threads 2";

class ViewerWindow : public testing::Test {
 protected:
  static void SetUpTestSuite() { server_ = std::make_unique<DisplayServer>(); }
  static void TearDownTestSuite() { server_.reset(); }

  void SetUp() override {
    if (server_->name().empty()) GTEST_SKIP() << "there is no Xvfb to show a window on (package xvfb)";
  }

  /// On the server's display. OpenGL drivers leave memory behind and are unloaded before the leak checker
  /// could name them, so that it is off in the program; it is on in the other tests.
  static std::string onDisplay() {
    return "env -u WAYLAND_DISPLAY DISPLAY=" + server_->name() + " ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0";
  }

  /// Plays a script in the test's folder; five minutes are far more than any needs, with sanitizers as well.
  ProgramRun play(const std::string& arguments, const std::string& script) const {
    folder.write("script.txt", script);
    return runIsophote(folder.path(), "view " + arguments + " --script script.txt",
                       onDisplay() + " timeout -k 1 300");
  }

  /// The states that a script has printed.
  static std::vector<Json> statesOf(const ProgramRun& run) {
    std::vector<Json> states;
    std::istringstream lines(run.output);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("{")) states.push_back(Json::parse(line));
    return states;
  }

  static vec3 vectorOf(const Json& json) { return {json[0], json[1], json[2]}; }

  TestFolder folder;
  static std::unique_ptr<DisplayServer> server_;
};
std::unique_ptr<DisplayServer> ViewerWindow::server_;

TEST_F(ViewerWindow, ShowsWhatRenderWrites) {
  const ProgramRun run = play(std::string("cornell-box --set view.refine=false") + kSmall,
                              "wait 1\nscreenshot shown.png\nscreenshot shown.exr\n");
  ASSERT_EQ(run.code, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  ASSERT_EQ(runIsophote(folder.path(), std::string("render cornell-box -o rendered.png") + kSmall).code, 0);
  EXPECT_EQ(readFile(folder.path() / "shown.png"), readFile(folder.path() / "rendered.png"));
  EXPECT_EQ(readFilm(folder.path() / "shown.exr").colour.width, 96);
}

/// The window's pixels against those of the file, whose tone map and exposure the processor applies.
TEST_F(ViewerWindow, TheGraphicsCardShowsColoursAsFilesHoldThem) {
  std::string script = "wait 1\nset display.exposureEv=1.5\n";
  for (const char* curve : {"none", "aces", "reinhard"})
    script +=
        fmt::format("set display.toneMap={0}\nscreenshot {0}.png\nscreenshot window {0}-window.png\n", curve);
  const ProgramRun run = play(std::string("cornell-box --set view.refine=false") + kSmall, script);
  ASSERT_EQ(run.code, 0) << run.errors;
  for (const std::string curve : {"none", "aces", "reinhard"}) {
    const Image file = readFilm(folder.path() / (curve + ".png")).colour;
    const Image window = readFilm(folder.path() / (curve + "-window.png")).colour;
    ASSERT_GT(window.width, file.width) << "the panel is beside the picture";
    float worst = 0;
    for (int y = 0; y < file.height; ++y)
      for (int x = 0; x < file.width; ++x)
        for (int k = 0; k < 3; ++k)
          worst = std::max(worst,
                           std::abs(srgbFromLinear(file.at(x, y)[k]) - srgbFromLinear(window.at(x, y)[k])));
    EXPECT_LT(worst, 1.5f / 255.0f) << curve << ": they may round differently";
  }
}

TEST_F(ViewerWindow, KeysAndMouseMoveTheCamera) {
  const ProgramRun run = play(std::string("cornell-box") + kSmall,
                              "wait 1\nprint state\nhold W 0.5\nprint state\n"
                              "key O\nkey 2\nmouse 30 30\npress right\nmouse 50 30\nrelease right\nwheel 1\n"
                              "wait 1\nprint state\n"
                              "key R\nkey =\nkey Tab\nwait 1\nprint state\n");
  ASSERT_EQ(run.code, 0) << run.errors;
  const std::vector<Json> states = statesOf(run);
  ASSERT_EQ(states.size(), 4u);
  const vec3 start = vectorOf(states[0]["eye"]), flown = vectorOf(states[1]["eye"]);
  // Half a second at a quarter of the box's radius a second.
  EXPECT_NEAR(start.z - flown.z, 0.5f * 0.25f * std::sqrt(3.0f), 0.01f);
  EXPECT_EQ(states[2]["mode"], "orbit");
  EXPECT_EQ(states[2]["preset"], "ispm");
  EXPECT_EQ(vectorOf(states[2]["target"]), vectorOf(states[1]["target"]));
  const float before = length(flown - vectorOf(states[1]["target"]));
  EXPECT_NEAR(length(vectorOf(states[2]["eye"]) - vectorOf(states[2]["target"])), before / 1.2f, 1e-3f);
  EXPECT_LT(vectorOf(states[2]["eye"]).x, start.x);
  EXPECT_EQ(states[3]["eye"], states[0]["eye"]);
  EXPECT_NEAR(states[3]["exposureEv"].get<double>(), 1.0 / 3.0, 1e-6);
  EXPECT_EQ(states[3]["picture"], states[3]["window"]) << "the panel is hidden";
}

TEST_F(ViewerWindow, ALightIsDraggedByItsMarker) {
  // What the camera looks at is in the middle.
  const ProgramRun where = play(std::string("colour-bleed") + kSmall, "print state\n");
  ASSERT_EQ(where.code, 0) << where.errors;
  const vec3 target = vectorOf(statesOf(where).at(0)["target"]);
  const ProgramRun run = play(std::string("colour-bleed") + kSmall,
                              fmt::format("light 0 {} {} {}\nwait 1\nprint state\n"
                                          "mouse 48 36\npress left\nmouse 58 36\nmouse 68 36\nrelease left\n"
                                          "wait 1\nprint state\npasses 3\nprint state\n",
                                          target.x, target.y, target.z));
  ASSERT_EQ(run.code, 0) << run.errors;
  const std::vector<Json> states = statesOf(run);
  ASSERT_EQ(states.size(), 3u);
  EXPECT_EQ(states[1]["selected"], 0);
  EXPECT_EQ(states[1]["eye"], states[0]["eye"]);
  EXPECT_EQ(states[1]["target"], states[0]["target"]);
  EXPECT_GT(length(vectorOf(states[1]["lights"][0]) - target), 0.01f);
  EXPECT_EQ(states[2]["lights"], states[1]["lights"]);
  EXPECT_GE(states[2]["passes"].get<int>(), 3) << "at rest the picture is refined";
}

TEST_F(ViewerWindow, KeepsPicturesUnderNewNames) {
  const ProgramRun run =
      play(std::string("cornell-box") + kSmall, "wait 1\nkey P\nkey P\nkey Shift+P\nwait 2\n");
  ASSERT_EQ(run.code, 0) << run.errors;
  for (const char* name : {"cornell-box-0001.png", "cornell-box-0002.png", "cornell-box-0001.exr"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
}

TEST_F(ViewerWindow, ResizesAndShowsEveryPanel) {
  const ProgramRun run =
      play(std::string("atrium --preset ispm") + kSmall,
           "wait 1\nkey H\nkey L\nresize 160 120\nprint state\nscreenshot window whole.png\n"
           "set view.scale=0.5\nset view.draftMilliseconds=0\nprint state\nbenchmark 0 0 3 0 5\nquit\n");
  ASSERT_EQ(run.code, 0) << run.errors;
  const std::vector<Json> states = statesOf(run);
  ASSERT_EQ(states.size(), 2u);
  EXPECT_EQ(states[0]["picture"], Json::parse("[160,120]"));
  EXPECT_EQ(states[1]["picture"], Json::parse("[80,60]"));
  const Image whole = readFilm(folder.path() / "whole.png").colour;
  EXPECT_EQ(Json(std::vector<int>{whole.width, whole.height}), states[0]["window"]);
  EXPECT_THAT(run.output, HasSubstr("5 pictures of 80 x 60 with light 0 moving"));
}

TEST_F(ViewerWindow, ItsKeysAreThoseOfTheManual) {
  const ProgramRun run = play(std::string("cornell-box") + kSmall, "print keys\n");
  ASSERT_EQ(run.code, 0) << run.errors;
  const std::string manual = readFile(ISOPHOTE_SOURCE_DIR "/docs/viewer.md");
  std::istringstream lines(run.output);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("| Preset ") != std::string::npos) continue;  // The manual names those in one line.
    ++count;
    EXPECT_THAT(manual, HasSubstr(line + "\n")) << "write what the script's `print keys` prints into it";
  }
  EXPECT_GT(count, 20);
}

TEST_F(ViewerWindow, SaysWhichLineOfAScriptIsWrong) {
  ProgramRun run = play(std::string("cornell-box") + kSmall, "wait 1\nset view.scael=2\n");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.errors, HasSubstr("script.txt: line 2: there is no setting \"view.scael\""));
  run = play(std::string("cornell-box") + kSmall, "light 7 0 0 0\n");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.errors, HasSubstr("line 1: there is no light 7"));
  run = play(std::string("cornell-box --passes 2") + kSmall, "passes 3\n");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.errors, HasSubstr("line 1: no further picture comes"));
  run = play(std::string("cornell-box --preset ispm") + kSmall, "set photon_trace.photonsStored=9\nwait 1\n");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.errors, HasSubstr("line 2: photon_trace.photonsStored: ")) << "what the renderer refuses";
  run = play("no-such-scene", "wait 1\nwiat 1\n");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.errors, HasSubstr("line 2: there is no command \"wiat\"")) << "before the scene is read";
}

TEST_F(ViewerWindow, EndsWhenInterrupted) {
  folder.write("script.txt", "hold W 1000\n");
  const ProgramRun run =
      runIsophote(folder.path(), std::string("view cornell-box --script script.txt") + kSmall,
                  onDisplay() + " timeout --preserve-status -s INT -k 60 3");
  EXPECT_EQ(run.code, 130) << run.errors;
}

TEST(ViewerWithoutDisplay, SaysSoInOneSentence) {
  const TestFolder folder;
  const ProgramRun run =
      runIsophote(folder.path(), "view no-such-scene", "env -u DISPLAY -u WAYLAND_DISPLAY");
  EXPECT_EQ(run.code, 1);
  EXPECT_EQ(run.output, "");
  EXPECT_THAT(run.errors,
              testing::MatchesRegex("isophote: no window can be opened: [^\n]*isophote render needs "
                                    "none\n"));
}

TEST(ViewerWithoutDisplay, RefusesMistakesFirst) {
  const TestFolder folder;
  const ProgramRun run =
      runIsophote(folder.path(), "view cornell-box --photons many", "env -u DISPLAY -u WAYLAND_DISPLAY");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.errors, HasSubstr("--photons"));
}

}  // namespace
}  // namespace isophote

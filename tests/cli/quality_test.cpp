// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// --quality: what it sets, and what holds over it.
#include "render/quality.h"

#include "base/files.h"
#include "image/files.h"
#include "render/settings.h"
#include "support/program.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>
#include <string>

namespace isophote {
namespace {

class QualityOption : public testing::Test {
 protected:
  TestFolder folder_;

  /// The settings that a small picture was made with, as its file tells them.
  std::map<std::string, std::string> settingsOf(const std::string& arguments,
                                                const std::string& scene = "furnace-box") {
    SCOPED_TRACE(arguments);
    const ProgramRun result = runIsophote(
        folder_.path(), fmt::format("render {} --width 16 --height 16 -o a.exr {}", scene, arguments));
    EXPECT_EQ(result.code, 0) << result.errors;
    std::map<std::string, std::string> settings;
    for (const auto& [key, value] : readFilm(folder_.path() / "a.exr").metadata) settings[key] = value;
    return settings;
  }
};

TEST_F(QualityOption, SetsPhotonsPixelsAndPasses) {
  std::map<std::string, std::string> settings = settingsOf("--quality draft");
  EXPECT_EQ(settings["photon_trace.photons"], "20000");
  EXPECT_EQ(settings["frame.subsample"], "8");
  EXPECT_EQ(settings["frame.passes"], "1");
  settings = settingsOf("--quality preview");
  EXPECT_EQ(settings["photon_trace.photons"], "50000");
  EXPECT_EQ(settings["frame.passes"], "8");
  EXPECT_EQ(settings["frame.passRadius"], "0.75");
  settings = settingsOf("--quality final --photons 1000");
  EXPECT_EQ(settings["frame.passes"], "256");
  EXPECT_EQ(settings["frame.passRadius"], "0.5");
}

TEST_F(QualityOption, GivesWayToWhatIsSetBesides) {
  std::map<std::string, std::string> settings = settingsOf("--photons 1000 --passes 1 --quality preview");
  EXPECT_EQ(settings["photon_trace.photons"], "1000");
  EXPECT_EQ(settings["frame.passes"], "1");
  EXPECT_EQ(settings["frame.subsample"], "8");
  folder_.write("s.json", R"({"frame": {"passes": 3, "subsample": 2}})");
  settings = settingsOf("--quality final --settings s.json --photons 1000 --set frame.subsample=1");
  EXPECT_EQ(settings["frame.passes"], "3");
  EXPECT_EQ(settings["frame.subsample"], "1");
  // A time alone decides on the passes.
  settings = settingsOf("--quality preview --time 0.1");
  EXPECT_EQ(settings["frame.passes"], "1");
  EXPECT_EQ(settings["frame.seconds"], "0.1");
}

TEST_F(QualityOption, HoldsOverTheScenesOwnSettings) {
  folder_.write("scene.json", R"({"isophote": 1, "models": [{"file": "furnace-box"}],
    "settings": {"photon_trace.photons": 777, "frame.bounces": 1}})");
  EXPECT_EQ(settingsOf("", "scene.json")["photon_trace.photons"], "777");
  std::map<std::string, std::string> settings = settingsOf("--quality draft", "scene.json");
  EXPECT_EQ(settings["photon_trace.photons"], "20000");
  EXPECT_EQ(settings["frame.bounces"], "1");
}

TEST_F(QualityOption, LeavesTheWayToThePreset) {
  for (const PresetInfo& preset : presets())
    for (const Quality& quality : qualities()) {
      RenderSettings expected = presetSettings(preset.name);
      const std::map<std::string, std::string> settings = settingsOf(
          fmt::format("--preset {} --quality {} --photons 1000 --passes 2", preset.name, quality.name));
      for (const char* const key : {"frame.estimator", "frame.firstBounce", "direct.shadows"})
        for (const auto& [name, value] : metadataOf(expected))
          if (name == key) {
            EXPECT_EQ(settings.at(key), value) << preset.name << " " << quality.name;
          }
    }
}

TEST_F(QualityOption, RefusesWhatThereIsNot) {
  const ProgramRun result = runIsophote(folder_.path(), "render furnace -o a.png --quality finall");
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.errors, testing::HasSubstr("--quality: there is no quality \"finall\" (did you mean "
                                                "\"final\"?); there is draft, preview, final"));
}

}  // namespace
}  // namespace isophote

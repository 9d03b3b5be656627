// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
// `isophote bench` as a person or a script meets it.
#include "base/files.h"
#include "support/program.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace isophote {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class Bench : public testing::Test {
 protected:
  TestFolder folder_;
  ProgramRun run(const std::string& arguments) {
    return runIsophote(folder_.path(), "bench quality --width 32 --height 32 --spp 64 " + arguments);
  }
  nlohmann::json json(const std::string& file) const {
    return nlohmann::json::parse(readFile(folder_.path() / file));
  }
};

TEST_F(Bench, QualityTellsHowPicturesConverge) {
  const ProgramRun result = run("--scene cornell-box --scene colour-bleed --time 0.2 --json b.json");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("cornell-box, 32 x 32 pixels, beside 64 paths a pixel"));
  const nlohmann::json bench = json("b.json");
  EXPECT_EQ(bench["suite"], "quality");
  ASSERT_EQ(bench["scenes"].size(), 2u);
  for (const nlohmann::json& scene : bench["scenes"]) {
    EXPECT_GE(scene["ways"].size(), 4u);
    for (const nlohmann::json& way : scene["ways"]) {
      EXPECT_THAT(result.output, HasSubstr(way["name"].get<std::string>()));
      const nlohmann::json& passes = way["passes"];
      EXPECT_GT(passes.front()["psnr"], 15.0) << way["name"];
      EXPECT_GE(passes.back()["seconds"], 0.2) << way["name"];
      for (std::size_t i = 0; i < passes.size(); ++i) EXPECT_EQ(passes[i]["passes"], i + 1);
    }
  }
}

TEST_F(Bench, QualityTakesSettingsAndKeepsReferences) {
  const std::string command =
      "--scene cornell-box --time 0.01 --references . --set photon_trace.photons=1000 --json b.json";
  ASSERT_EQ(run(command).code, 0);
  const std::filesystem::path kept = folder_.path() / "cornell-box-32x32-3bounces-64spp.exr";
  const std::string reference = readFile(kept);
  const nlohmann::json first = json("b.json")["scenes"][0]["ways"];
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0]["settings"], nlohmann::json({"photon_trace.photons=1000"}));
  ASSERT_EQ(run(command).code, 0);
  EXPECT_EQ(readFile(kept), reference);
  EXPECT_EQ(json("b.json")["scenes"][0]["ways"][0]["passes"][0]["psnr"], first[0]["passes"][0]["psnr"]);
  writeFileAtomically(kept, std::string_view("no picture"));
  const ProgramRun damaged = run(command);
  EXPECT_EQ(damaged.code, 1);
  EXPECT_THAT(damaged.errors, HasSubstr(kept.filename().string()));
}

TEST_F(Bench, RefusesWhatCannotBeMeasuredBeforeTheWork) {
  const ProgramRun suite = runIsophote(folder_.path(), "bench qualty");
  EXPECT_EQ(suite.code, 2);
  EXPECT_THAT(suite.errors, HasSubstr("did you mean \"quality\"?"));
  const ProgramRun setting = run("--set photon_trace.photns=3");
  EXPECT_EQ(setting.code, 2);
  EXPECT_THAT(setting.errors, HasSubstr("did you mean \"photon_trace.photons\"?"));
  const ProgramRun references = run("--references nowhere");
  EXPECT_EQ(references.code, 1);
  EXPECT_THAT(references.errors, HasSubstr("nowhere"));
  EXPECT_EQ(run("--scene nowhere.glb").code, 1);
  EXPECT_THAT(setting.output + references.output, IsEmpty());
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace isophote

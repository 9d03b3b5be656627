// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/script.h"
#include "base/error.h"

#include <gmock/gmock.h>

namespace isophote::viewer {
namespace {

using testing::HasSubstr;

TEST(Script, ReadsEveryCommand) {
  const std::vector<ScriptCommand> commands = parseScript(
      "# a comment\n"
      "wait 3\n"
      "\n"
      "passes 16   # another\r\n"
      "key Shift+P\n"
      "hold w 0.5\n"
      "mouse 10 20.5\n"
      "press left\n"
      "release middle\n"
      "wheel -2\n"
      "light 1 0.5 -1 2e1\n"
      "set photon_trace.photons=1e5\n"
      "resize 640 360\n"
      "screenshot a.exr\n"
      "screenshot window b.png\n"
      "benchmark 0 1 2 3 100\n"
      "print state\n"
      "\tquit",
      "test.txt");
  ASSERT_EQ(commands.size(), 16u);
  EXPECT_EQ(commands[0].line, 2u);
  EXPECT_EQ(std::get<script::Wait>(commands[0].what).pictures, 3u);
  EXPECT_EQ(std::get<script::WaitPasses>(commands[1].what).passes, 16u);
  EXPECT_EQ(std::get<script::PressKey>(commands[2].what).press, (KeyPress{'P', true}));
  EXPECT_EQ(std::get<script::HoldKey>(commands[3].what).seconds, 0.5f);
  EXPECT_EQ(std::get<script::MovePointer>(commands[4].what).place, vec2(10, 20.5f));
  EXPECT_TRUE(std::get<script::PressButton>(commands[5].what).down);
  EXPECT_EQ(std::get<script::PressButton>(commands[6].what).button, MouseButton::kMiddle);
  EXPECT_EQ(std::get<script::TurnWheel>(commands[7].what).notches, -2.0f);
  EXPECT_EQ(std::get<script::MoveLight>(commands[8].what).position, vec3(0.5f, -1, 20));
  EXPECT_EQ(std::get<script::Set>(commands[9].what).value, "1e5");
  EXPECT_EQ(std::get<script::Resize>(commands[10].what).height, 360);
  EXPECT_FALSE(std::get<script::Screenshot>(commands[11].what).window);
  EXPECT_TRUE(std::get<script::Screenshot>(commands[12].what).window);
  EXPECT_EQ(std::get<script::Benchmark>(commands[13].what).pictures, 100u);
  EXPECT_EQ(std::get<script::Print>(commands[14].what).what, script::Print::kState);
  EXPECT_TRUE(std::holds_alternative<script::Quit>(commands[15].what));
  EXPECT_TRUE(parseScript("", "test.txt").empty());
}

TEST(Script, NamesTheLineThatIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {
      {"wiat 3", "there is no command \"wiat\" (did you mean \"wait\"?)"},
      {"wait", "there is a word missing; write \"wait PICTURES\""},
      {"wait 0", "\"0\" is not a whole number from 1"},
      {"wait 3 4", "\"4\" is one word too many"},
      {"wait 3x", "\"3x\" is not a whole number"},
      {"light 0 1 2 nan", "\"nan\" is not a number"},
      {"key Alt+X", "there is no key \"Alt+X\""},
      {"press up", "there is no button \"up\""},
      {"set view.scale", "write \"set KEY=VALUE\""},
      {"screenshot a.tiff", "a.tiff"},
      {"screenshot window a.exr", "as .png alone"},
      {"print nothing", "\"nothing\" cannot be printed"},
      {"resize 0 5", "from 1 to 16384"},
  };
  for (const auto& [text, sentence] : wrong) {
    try {
      parseScript(std::string("quit\n\n") + text, "test.txt");
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << text;
      EXPECT_THAT(error.what(), HasSubstr("test.txt: line 3: ")) << text;
      EXPECT_THAT(error.what(), HasSubstr(sentence)) << text;
    }
  }
}

}  // namespace
}  // namespace isophote::viewer

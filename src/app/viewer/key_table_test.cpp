// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/key_table.h"
#include "base/error.h"

#include <gtest/gtest.h>

namespace isophote::viewer {
namespace {

TEST(KeyTable, NamesAreReadBack) {
  for (const KeyPress press :
       {KeyPress{'W'}, KeyPress{'P', true}, KeyPress{'Q', false, true}, KeyPress{'7'}, KeyPress{kKeySpace},
        KeyPress{kKeyTab, true, true}, KeyPress{kKeyEscape}, KeyPress{kKeyMinus}, KeyPress{kKeyEqual}})
    EXPECT_EQ(parseKey(keyName(press)), press) << keyName(press);
  EXPECT_EQ(parseKey("shift+p"), (KeyPress{'P', true}));
  for (const char* wrong : {"", "Alt+P", "WW", "#", "Shift+", "+"})
    EXPECT_EQ(parseKey(wrong), std::nullopt) << wrong;
}

TEST(KeyTable, FindsWhatAPressDoes) {
  int pressed = 0;
  KeyTable table;
  table.add({{'P'}, "Once", [&] { ++pressed; }});
  table.add({{'P', true}, "Ten times", [&] { pressed += 10; }});
  table.add({.press = {'W'}, .help = "Forward", .action = {}, .way = vec3(0, 0, 1)});
  table.find({'P'})->action();
  table.find({'P', true})->action();
  EXPECT_EQ(pressed, 11);
  EXPECT_EQ(table.find({'P', false, true}), nullptr);
  ASSERT_NE(table.find({'W', true}), nullptr) << "held keys count with shift, too";
  EXPECT_EQ(table.find({'W', false, true}), nullptr);
  EXPECT_THROW(table.add({{'W', true}, "Faster", [] {}}), Error) << "two things";
  EXPECT_NE(table.markdown().find("| Shift+P | Ten times |"), std::string::npos);
}

}  // namespace
}  // namespace isophote::viewer

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/key_table.h"
#include "app/viewer/session.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace isophote::viewer {

/// What a script may say, a line each; docs/viewer.md describes them to people.
namespace script {
struct Wait {  ///< Until so many more pictures have come.
  std::uint32_t pictures;
};
struct WaitPasses {  ///< Until the picture is the mean of so many passes.
  std::uint32_t passes;
};
struct PressKey {
  KeyPress press;
};
struct HoldKey {
  KeyPress press;
  float seconds;
};
struct MovePointer {
  vec2 place;  ///< In the window [pixels].
};
struct PressButton {
  MouseButton button;
  bool down;
};
struct TurnWheel {
  float notches;
};
struct MoveLight {
  std::size_t light;
  vec3 position;
};
struct Set {
  std::string key, value;
};
struct Resize {  ///< The picture.
  int width, height;
};
struct Screenshot {
  std::filesystem::path file;
  bool window;  ///< With its panels; otherwise the picture alone.
};
struct Benchmark {  ///< A light goes there and back while so many pictures are shown.
  std::size_t light;
  vec3 to;
  std::uint32_t pictures;
};
struct Print {
  enum What { kState, kKeys } what;
};
struct Quit {};
}  // namespace script

struct ScriptCommand {
  std::size_t line;  ///< Counted from 1.
  std::variant<script::Wait, script::WaitPasses, script::PressKey, script::HoldKey, script::MovePointer,
               script::PressButton, script::TurnWheel, script::MoveLight, script::Set, script::Resize,
               script::Screenshot, script::Benchmark, script::Print, script::Quit>
      what;
};

/// Reads a script: a command a line, `#` begins a comment. Throws Error(kBadInput, subject) that names the
/// line.
std::vector<ScriptCommand> parseScript(std::string_view text, const std::string& subject);

}  // namespace isophote::viewer

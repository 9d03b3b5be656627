// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/script.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace isophote::viewer {

class Window;

/// What a script player sees of the viewer, and what it asks of it.
struct Stage {
  Session& session;
  Window& window;
  const RenderedPicture& picture;
  bool idle = false;     ///< No picture will come but for a change.
  bool current = false;  ///< The picture is one of what was asked for last.
  std::string error{};   ///< Why there is none.
  /// Has Embree alone trace the primary rays of a picture of that size (render/yardstick.h).
  std::function<void(int width, int height)> primaryRays{};
  /// Files to be written of what is on the screen once it has been drawn.
  std::vector<script::Screenshot>& screenshots;
};

/// How a benchmark goes.
struct BenchmarkRun {
  std::uint32_t shown = 0;
  std::chrono::steady_clock::time_point start{};
  double renderMilliseconds = 0;
  double processorSeconds = 0;  ///< Of this process, when it began.
  vec3 from{0};
  Stats stats{};
};

/// Plays a script against the window and the session, step by step between frames.
class ScriptPlayer {
 public:
  ScriptPlayer(std::vector<ScriptCommand> commands, std::filesystem::path file)
      : commands_(std::move(commands)), file_(std::move(file)) {}

  /// Goes on as far as it can now. Throws Error(kBadInput) that names the line. `newPicture`: one has come
  /// since the last time.
  void step(Stage& stage, bool newPicture);
  bool done() const { return next_ == commands_.size(); }
  /// The time that goes by in the session with each step [s]; 0: none.
  float stepSeconds() const { return ticks_ ? kStep : 0.0f; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr float kStep = 1.0f / 60.0f;

  /// Whether a command is over.
  bool play(Stage& stage, const ScriptCommand& command, bool newPicture);
  bool wait(Stage& stage, bool newPicture, std::uint32_t pictures);
  bool hold(Stage& stage, const script::HoldKey& hold);
  void report(const Stage& stage, const script::Benchmark& what) const;
  bool benchmark(Stage& stage, const script::Benchmark& what, bool newPicture);
  void requireMore(const Stage& stage) const;

  std::vector<ScriptCommand> commands_;
  std::filesystem::path file_;
  std::size_t next_ = 0;
  bool begun_ = false;  ///< commands_[next_] has.
  std::uint32_t waited_ = 0;
  float holding_ = 0;
  bool ticks_ = false;
  std::optional<BenchmarkRun> run_;
};

}  // namespace isophote::viewer

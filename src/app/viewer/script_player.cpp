// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/script_player.h"

#include "app/viewer/panels.h"
#include "app/viewer/window.h"
#include "base/error.h"
#include "scene/light_place.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <ctime>

namespace isophote::viewer {

namespace {

/// Steps in which the desktop has to give a window its size.
constexpr std::uint32_t kResizeSteps = 600;

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

nlohmann::ordered_json numbers(vec3 v) { return {double(v.x), double(v.y), double(v.z)}; }

double processorSeconds() { return double(std::clock()) / double(CLOCKS_PER_SEC); }

/// What is on the screen, as a line of JSON.
void printState(const Stage& stage) {
  using Json = nlohmann::ordered_json;
  const Session& session = stage.session;
  const Camera& camera = session.camera().camera();
  Json lights = Json::array();
  for (const Light& light : session.lights())
    lights.push_back(numbers(lightPosition(light).value_or(light.direction)));
  const Image& image = stage.picture.film->colour;
  const Json state = {{"eye", numbers(camera.eye)},
                      {"target", numbers(camera.target)},
                      {"mode", session.camera().mode() == CameraMode::kFly ? "fly" : "orbit"},
                      {"lights", lights},
                      {"selected", session.selected() ? Json(*session.selected()) : Json()},
                      {"preset", session.preset()},
                      {"window", {stage.window.size().x, stage.window.size().y}},
                      {"picture", {image.width, image.height}},
                      {"passes", stage.picture.passes},
                      {"exposureEv", double(session.settings().display.exposureEv)},
                      {"openGl", stage.window.renderer()}};
  std::printf("%s\n", state.dump().c_str());
  std::fflush(stdout);
}

}  // namespace

void ScriptPlayer::step(Stage& stage, bool newPicture) {
  while (!done()) {
    const ScriptCommand& command = commands_[next_];
    try {
      if (!play(stage, command, newPicture)) return;
    } catch (const Error& error) {
      failInput(file_.string(), "line {}: {}", command.line, error.what());
    }
    newPicture = false;  // One picture serves one command.
    ++next_;
    begun_ = false;
    // What a command has changed is asked for before the next one looks at pictures.
    return;
  }
}

bool ScriptPlayer::play(Stage& stage, const ScriptCommand& command, bool newPicture) {
  const bool first = !std::exchange(begun_, true);
  if (!stage.error.empty()) failUsage("", "{}", stage.error);
  const auto inject = [&](const InputEvent& event) {
    stage.window.inject(event);
    return true;
  };
  return std::visit(
      Overloaded{
          [&](const script::Wait& wanted) {
            if (first) waited_ = 0;
            return wait(stage, newPicture, wanted.pictures);
          },
          [&](const script::WaitPasses& wanted) {
            if (first) return false;
            if (stage.current && stage.picture.passes >= wanted.passes) return true;
            requireMore(stage);
            return false;
          },
          [&](const script::PressKey& key) {
            inject(KeyEvent{key.press, true});
            return inject(KeyEvent{key.press, false});
          },
          [&](const script::HoldKey& wanted) {
            if (first) {
              holding_ = wanted.seconds;
              inject(KeyEvent{wanted.press, true});
            }
            return hold(stage, wanted);
          },
          [&](const script::MovePointer& to) { return inject(PointerEvent{to.place}); },
          [&](const script::PressButton& what) {
            return inject(ButtonEvent{what.button, what.down, false, false});
          },
          [&](const script::TurnWheel& what) { return inject(WheelEvent{what.notches}); },
          [&](const script::MoveLight& to) {
            stage.session.moveLight(to.light, to.position);
            return true;
          },
          [&](const script::Set& what) {
            stage.session.set(what.key, what.value);
            return true;
          },
          [&](const script::Resize& to) {
            const int panel = stage.session.panelShown ? panelWidth(stage.window.pixelScale()) : 0;
            if (first) {
              waited_ = 0;
              stage.window.resize(to.width + panel, to.height);
            }
            if (++waited_ > kResizeSteps)
              failUsage("", "the desktop does not let the window show {} x {} pixels", to.width, to.height);
            return !first && stage.session.pictureSize() == ivec2(to.width, to.height);
          },
          [&](const script::Screenshot& what) {
            if (first || !stage.current) {
              waited_ = 0;
              return false;
            }
            if (waited_++ == 0) stage.screenshots.push_back(what);
            return stage.screenshots.empty();
          },
          [&](const script::Benchmark& what) { return benchmark(stage, what, newPicture); },
          [&](const script::Print& what) {
            if (what.what == script::Print::kState) {
              if (first || !stage.current) return false;
              printState(stage);
            } else {
              std::fputs(stage.session.keys().markdown().c_str(), stdout);
            }
            return true;
          },
          [&](const script::Quit&) {
            stage.session.closed = true;
            return true;
          },
      },
      command.what);
}

void ScriptPlayer::requireMore(const Stage& stage) const {
  if (stage.idle)
    failUsage("", "no further picture comes: the last one has all its passes, and nothing changes");
}

bool ScriptPlayer::wait(Stage& stage, bool newPicture, std::uint32_t pictures) {
  if (newPicture && ++waited_ >= pictures) return true;
  if (!newPicture) requireMore(stage);
  return false;
}

bool ScriptPlayer::hold(Stage& stage, const script::HoldKey& held) {
  ticks_ = holding_ > 0.5f * kStep;
  holding_ -= kStep;
  if (ticks_) return false;
  stage.window.inject(KeyEvent{held.press, false});
  return true;
}

/// Everything by the clock, and by the time that processors worked for this process: a busy machine slows
/// down the one, but hardly the other.
void ScriptPlayer::report(const Stage& stage, const script::Benchmark& what) const {
  constexpr int kYardsticks = 5;
  const double seconds = std::chrono::duration<double>(Clock::now() - run_->start).count();
  const double worked = processorSeconds() - run_->processorSeconds;
  const double pictures = run_->shown;
  const Image& image = stage.picture.film->colour;
  const double before = processorSeconds();
  for (int i = 0; i < kYardsticks; ++i) stage.primaryRays(image.width, image.height);
  const double rays = (processorSeconds() - before) / kYardsticks;
  std::printf("%u pictures of %d x %d with light %zu moving: %.2f s, %.1f a second\n", run_->shown,
              image.width, image.height, what.light, seconds, pictures / seconds);
  std::printf(
      "processor time of a picture and its display: %.1f ms, %.1f times that of its primary rays (%.1f ms)\n",
      1e3 * worked / pictures, worked / pictures / rays, 1e3 * rays);
  std::printf("rendering one: %.1f ms", run_->renderMilliseconds / pictures);
  for (const auto& [name, milliseconds] : run_->stats.stages())
    std::printf(", %s %.1f", name.c_str(), milliseconds / pictures);
  std::printf("\n");
  std::fflush(stdout);
}

bool ScriptPlayer::benchmark(Stage& stage, const script::Benchmark& what, bool newPicture) {
  Session& session = stage.session;
  // There and back; no two places that follow each other are the same, which would ask for no picture.
  const auto placeAt = [&](double part) {
    return mix(run_->from, what.to, float(0.5 - 0.5 * std::cos(2.0 * double(kPi) * part)));
  };
  if (!run_) {
    // The first picture, whose renderer allocates, is not counted.
    session.moveLight(what.light, session.lights().at(what.light).position);
    run_.emplace();
    run_->from = lightPosition(session.lights()[what.light]).value();
    session.animated = true;
    session.moveLight(what.light, placeAt(0.25 / what.pictures));
    return false;
  }
  if (!newPicture) return false;
  if (run_->start == Clock::time_point()) {
    run_->start = Clock::now();
    run_->processorSeconds = processorSeconds();
  } else {
    ++run_->shown;
    run_->renderMilliseconds += stage.picture.milliseconds;
    for (const auto& [name, milliseconds] : stage.picture.stats.stages())
      run_->stats.addStage(name, milliseconds);
  }
  if (run_->shown < what.pictures) {
    session.moveLight(what.light, placeAt((run_->shown + 1.25) / what.pictures));
    return false;
  }
  report(stage, what);
  session.animated = false;
  session.moveLight(what.light, run_->from);
  run_.reset();
  return true;
}

}  // namespace isophote::viewer

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/viewer.h"

#include "app/viewer/film_texture.h"
#include "app/viewer/panels.h"
#include "app/viewer/screenshot.h"
#include "app/viewer/script_player.h"
#include "app/viewer/window.h"
#include "base/error.h"
#include "base/files.h"
#include "image/files.h"
#include "image/png.h"
#include "render/yardstick.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace isophote::viewer {

namespace {

using Clock = std::chrono::steady_clock;

/// How long a wait may last, so that a request to stop is noticed [s].
constexpr double kLongestWait = 0.1;
/// Between two steps of a motion [s].
constexpr double kMotionStep = 1.0 / 60.0;

/// How many pictures a second come, over the last few.
class Pace {
 public:
  void pictureCame() {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    // After a pause the pace is counted anew.
    mean_ = mean_ > 0 && seconds < 2 ? 0.8 * mean_ + 0.2 * seconds : seconds;
    last_ = now;
  }
  double perSecond() const { return mean_ > 0 ? 1.0 / mean_ : 0.0; }

 private:
  Clock::time_point last_ = Clock::now();
  double mean_ = 0;
};

/// One run: the window, the loop that renders, and what is between them.
class Run {
 public:
  Run(const std::string& scene, Window& window, Session& session, TraceScene& trace, const Job& job,
      ScriptPlayer* script)
      : sceneName_(scene),
        window_(window),
        session_(session),
        script_(script),
        trace_(trace),
        texture_(window.gl()),
        loop_(trace, job, [] { Window::wake(); }),
        job_(job) {}

  void untilClosed() {
    window_.setTitle("isophote: " + sceneName_);
    const ivec2 picture = session_.pictureSize();
    window_.resize(picture.x + panel(), picture.y);
    while (!session_.closed && !window_.closed()) {
      job_.throwIfStopped();
      window_.wait(waitSeconds());
      frame();
      if (script_ && script_->done() && screenshots_.empty()) return;
    }
  }

 private:
  int panel() const { return session_.panelShown ? panelWidth(window_.pixelScale()) : 0; }

  double waitSeconds() const {
    if (drawAgain_ > 0) return 0;
    return session_.flies() || script_ ? kMotionStep : kLongestWait;
  }

  void frame() {
    const bool newPicture = loop_.take(picture_);
    if (newPicture) showPicture();
    const std::vector<InputEvent> events = takeInput(newPicture);
    // Panels answer to input one frame later, and settle in another.
    if (newPicture) drawAgain_ = std::max(drawAgain_, 1);
    if (!events.empty()) drawAgain_ = 3;
    const auto now = Clock::now();
    const float seconds =
        script_ ? script_->stepSeconds() : std::chrono::duration<float>(now - ticked_).count();
    ticked_ = now;
    session_.tick(std::min(seconds, 0.1f));
    const ivec2 size = window_.size();
    session_.setPictureSize(size.x - panel(), size.y);
    // Asked for before drawing: the next picture is rendered meanwhile.
    if (auto request = session_.request(busy_)) {
      asked_ = loop_.show(std::move(*request));
      drawAgain_ = std::max(drawAgain_, 1);
    }
    if (drawAgain_ > 0 || loop_.error() != shownError_) draw();
    keepPictures();
  }

  void showPicture() {
    texture_.setFilm(picture_.film);
    pace_.pictureCame();
    metered_ = false;
  }

  std::vector<InputEvent> takeInput(bool newPicture) {
    if (script_) {
      const bool idle = asked_ > 0 && loop_.idle();
      Stage stage{session_,
                  window_,
                  picture_,
                  idle,
                  idle || (asked_ > 0 && picture_.number == asked_),
                  loop_.error(),
                  [this](int width, int height) {
                    tracePrimaryRays(trace_, cameraRays(session_.camera().camera(), width, height), width,
                                     height);
                  },
                  screenshots_};
      script_->step(stage, newPicture);
    }
    std::vector<InputEvent> events = window_.takeEvents();
    for (const InputEvent& event : events) hand(event);
    return events;
  }

  /// What the panels do not want is for the picture; what ends is for both.
  void hand(const InputEvent& event) {
    if (const auto* key = std::get_if<KeyEvent>(&event)) {
      if (!key->down)
        session_.releaseKey(key->press.key);
      else if (!panelsWantKeys())
        session_.pressKey(key->press);
    } else if (const auto* button = std::get_if<ButtonEvent>(&event)) {
      if (!button->down)
        session_.releaseButton(button->button);
      else if (!panelsWantPointer() && inPicture())
        session_.pressButton(button->button, pointer_, button->shift, button->control);
    } else if (const auto* moved = std::get_if<PointerEvent>(&event)) {
      pointer_ = moved->place;
      session_.movePointer(pointer_);
    } else if (const auto* wheel = std::get_if<WheelEvent>(&event)) {
      if (!panelsWantPointer() && inPicture()) session_.turnWheel(wheel->notches);
    } else {
      session_.releaseAll();
    }
  }

  bool inPicture() const {
    const ivec2 size = session_.pictureSize();
    return pointer_.x >= 0 && pointer_.y >= 0 && pointer_.x < float(size.x) && pointer_.y < float(size.y);
  }

  void draw() {
    drawAgain_ = std::max(drawAgain_ - 1, 0);
    window_.beginFrame();
    const ivec2 size = session_.pictureSize();
    const DisplayOptions& display = session_.settings().display;
    window_.gl().Viewport(0, window_.size().y - size.y, size.x, size.y);
    if (display.autoExposure && picture_.film && !std::exchange(metered_, true))
      autoEv_ = autoExposureEv(picture_.film->colour);
    texture_.draw(display.exposureEv + (display.autoExposure ? autoEv_ : 0.0f), display.toneMap);
    shownError_ = loop_.error();
    busy_ = drawPanels(session_, {picture_, pace_.perSecond(), shownError_, loop_.warnings(), notice_},
                       window_.pixelScale());
    const auto wanted =
        std::ranges::find_if(screenshots_, [](const script::Screenshot& s) { return s.window; });
    std::vector<std::uint8_t> pixels;
    window_.endFrame(wanted != screenshots_.end() ? &pixels : nullptr);
    if (wanted == screenshots_.end()) return;
    const ivec2 whole = window_.size();
    writeFileAtomically(wanted->file, encodePng(whole.x, whole.y, pixels));
    screenshots_.erase(wanted);
  }

  /// Writes pictures that keys and scripts have asked for.
  void keepPictures() {
    if (!screenshots_.empty()) drawAgain_ = std::max(drawAgain_, 1);
    if (!picture_.film) return;
    std::erase_if(screenshots_, [&](const script::Screenshot& wanted) {
      if (!wanted.window) writeFilm(wanted.file, *picture_.film, session_.settings().display);
      return !wanted.window;
    });
    for (const std::string_view ending : std::exchange(session_.screenshots, {})) {
      try {
        const std::filesystem::path file = unusedName(".", screenshotName(sceneName_), ending);
        writeFilm(file, *picture_.film, session_.settings().display);
        notice_ = "kept " + file.filename().string();
      } catch (const Error& error) {
        notice_ = error.what();
      }
      drawAgain_ = 2;
    }
  }

  const std::string& sceneName_;
  Window& window_;
  Session& session_;
  ScriptPlayer* script_;
  const TraceScene& trace_;
  FilmTexture texture_;
  RenderLoop loop_;
  const Job& job_;
  RenderedPicture picture_;
  std::uint64_t asked_ = 0;
  Pace pace_;
  vec2 pointer_{-1};
  float autoEv_ = 0;
  bool metered_ = false;  ///< autoEv_ is that of the picture.
  bool busy_ = false;
  int drawAgain_ = 3;  ///< Frames until the panels have settled.
  Clock::time_point ticked_ = Clock::now();
  std::string shownError_, notice_;
  std::vector<script::Screenshot> screenshots_;
};

}  // namespace

Viewer::Viewer(std::string sceneName, std::vector<ScriptCommand> script, std::filesystem::path scriptFile)
    : sceneName_(std::move(sceneName)),
      script_(std::move(script)),
      scriptFile_(std::move(scriptFile)),
      window_(std::make_unique<Window>("isophote", !scriptFile_.empty())) {}

Viewer::~Viewer() = default;

void Viewer::run(Session& session, TraceScene& trace, const Job& job) {
  ScriptPlayer player(script_, scriptFile_);
  const bool scripted = !scriptFile_.empty();
  window_->setVsync(!scripted);
  Run(sceneName_, *window_, session, trace, job, scripted ? &player : nullptr).untilClosed();
}

}  // namespace isophote::viewer

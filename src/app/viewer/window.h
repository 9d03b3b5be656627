// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/gl.h"
#include "app/viewer/key_table.h"
#include "app/viewer/session.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

struct GLFWwindow;

namespace isophote::viewer {

struct KeyEvent {
  KeyPress press;
  bool down;
};
struct ButtonEvent {
  MouseButton button;
  bool down;
  bool shift, control;
};
struct PointerEvent {
  vec2 place;  ///< In the window [its pixels].
};
struct WheelEvent {
  float notches;
};
struct FocusLost {};
using InputEvent = std::variant<KeyEvent, ButtonEvent, PointerEvent, WheelEvent, FocusLost>;

/// A window of the desktop with OpenGL 3.3 and Dear ImGui in it. One at a time, on one thread; only
/// window.cpp knows GLFW.
class Window {
 public:
  /// Hidden until resize(). Throws Error(kDevice) where there is no display, or no OpenGL 3.3. A scripted
  /// window takes its input from inject() alone.
  Window(const std::string& title, bool scripted);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Asks for a framebuffer of that size [pixels], and shows the window.
  void resize(int width, int height);
  void setTitle(const std::string& title);
  /// Of the framebuffer [pixels].
  ivec2 size() const;
  bool closed() const;
  /// Pixels of the framebuffer for one of the desktop's.
  float pixelScale() const;

  /// Waits for input, wake() or the end of the time [s], then takes what has happened.
  void wait(double seconds);
  /// Ends wait(), from any thread.
  static void wake();
  /// As if a person had done it.
  void inject(const InputEvent& event);
  /// What has happened since the last time, in order.
  std::vector<InputEvent> takeEvents();

  /// Between the two, ImGui's widgets may be used; endFrame() draws them over what OpenGL has drawn.
  void beginFrame();
  /// `keep` receives what is shown: 3 bytes a pixel, rows from the top.
  void endFrame(std::vector<std::uint8_t>* keep = nullptr);
  /// Waits for the display before showing a frame, so that none is torn.
  void setVsync(bool on);

  const Gl& gl() const { return gl_; }
  /// OpenGL's words for what draws.
  std::string renderer() const;

 private:
  struct Callbacks;
  std::vector<std::uint8_t> readPixels() const;

  GLFWwindow* window_ = nullptr;
  bool scripted_;
  Gl gl_;
  std::vector<InputEvent> events_;
  vec2 pointer_{-1};
  bool down_[3] = {};
};

}  // namespace isophote::viewer

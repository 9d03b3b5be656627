// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/window.h"

#include "base/error.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <utility>

namespace isophote::viewer {

static_assert(kKeySpace == GLFW_KEY_SPACE && kKeyMinus == GLFW_KEY_MINUS && kKeyEqual == GLFW_KEY_EQUAL &&
              kKeyEscape == GLFW_KEY_ESCAPE && kKeyTab == GLFW_KEY_TAB && 'A' == GLFW_KEY_A &&
              '0' == GLFW_KEY_0);

namespace {

constexpr std::array<std::pair<int, MouseButton>, 3> kButtons{
    {{GLFW_MOUSE_BUTTON_LEFT, MouseButton::kLeft},
     {GLFW_MOUSE_BUTTON_RIGHT, MouseButton::kRight},
     {GLFW_MOUSE_BUTTON_MIDDLE, MouseButton::kMiddle}}};

/// GLFW's words for its last mistake, and what helps.
[[noreturn]] void failWindow(std::string_view what) {
  const char* words = nullptr;
  glfwGetError(&words);
  fail(ErrorKind::kDevice, "",
       "{}{}{}; the viewer needs a display with OpenGL 3.3, isophote render needs none", what,
       words ? ": " : "", words ? words : "");
}

/// A key of the keypad counts as the one of the same meaning.
Key plainKey(int key) {
  if (key == GLFW_KEY_KP_ADD) return kKeyEqual;
  if (key == GLFW_KEY_KP_SUBTRACT) return kKeyMinus;
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return '0' + key - GLFW_KEY_KP_0;
  return key;
}

}  // namespace

/// What GLFW calls; hands everything to ImGui as well.
struct Window::Callbacks {
  static Window& of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

  static void key(GLFWwindow* window, int key, int code, int action, int mods) {
    if (action == GLFW_REPEAT) return ImGui_ImplGlfw_KeyCallback(window, key, code, action, mods);
    const KeyPress press{plainKey(key), (mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0};
    of(window).events_.emplace_back(KeyEvent{press, action == GLFW_PRESS});
    ImGui_ImplGlfw_KeyCallback(window, key, code, action, mods);
  }

  static void button(GLFWwindow* window, int button, int action, int mods) {
    ImGui_ImplGlfw_MouseButtonCallback(window, button, action, mods);
    for (const auto& [number, name] : kButtons)
      if (number == button)
        of(window).events_.emplace_back(ButtonEvent{name, action == GLFW_PRESS, (mods & GLFW_MOD_SHIFT) != 0,
                                                    (mods & GLFW_MOD_CONTROL) != 0});
  }

  static void pointer(GLFWwindow* window, double x, double y) {
    const float scale = of(window).pixelScale();
    of(window).events_.emplace_back(PointerEvent{vec2(float(x), float(y)) * scale});
  }

  static void wheel(GLFWwindow* window, double x, double y) {
    ImGui_ImplGlfw_ScrollCallback(window, x, y);
    of(window).events_.emplace_back(WheelEvent{float(y)});
  }

  static void focus(GLFWwindow* window, int focused) {
    ImGui_ImplGlfw_WindowFocusCallback(window, focused);
    if (focused == GLFW_FALSE) of(window).events_.emplace_back(FocusLost{});
  }

  static void install(GLFWwindow* window) {
    glfwSetKeyCallback(window, key);
    glfwSetMouseButtonCallback(window, button);
    glfwSetCursorPosCallback(window, pointer);
    glfwSetScrollCallback(window, wheel);
    glfwSetWindowFocusCallback(window, focus);
    glfwSetCharCallback(window, ImGui_ImplGlfw_CharCallback);
    glfwSetCursorEnterCallback(window, ImGui_ImplGlfw_CursorEnterCallback);
  }
};

Window::Window(const std::string& title, bool scripted) : scripted_(scripted) {
  if (glfwInit() == GLFW_FALSE) failWindow("no window can be opened");
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  window_ = glfwCreateWindow(640, 360, title.c_str(), nullptr, nullptr);
  if (!window_) {
    try {
      failWindow("no window can be opened");
    } catch (...) {
      glfwTerminate();
      throw;
    }
  }
  glfwMakeContextCurrent(window_);
  glfwSetWindowUserPointer(window_, this);
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // Nothing is written that nobody asked for.
  ImGui_ImplGlfw_InitForOpenGL(window_, false);
  try {
    gl_ = Gl::load(glfwGetProcAddress);
    if (!ImGui_ImplOpenGL3_Init("#version 330 core"))
      fail(ErrorKind::kDevice, "", "OpenGL cannot draw panels");
  } catch (...) {
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwTerminate();
    throw;
  }
  if (!scripted_) Callbacks::install(window_);
  float scale = 1;
  glfwGetWindowContentScale(window_, &scale, nullptr);
  ImGui::GetIO().FontGlobalScale = std::max(1.0f, scale / pixelScale());
  ImGui::GetStyle().ScaleAllSizes(ImGui::GetIO().FontGlobalScale);
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwTerminate();
}

void Window::resize(int width, int height) {
  const float scale = pixelScale();
  glfwSetWindowSize(window_, int(float(width) / scale), int(float(height) / scale));
  glfwShowWindow(window_);
  glfwPollEvents();
}

void Window::setTitle(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

ivec2 Window::size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return {width, height};
}

bool Window::closed() const { return glfwWindowShouldClose(window_) != GLFW_FALSE; }

float Window::pixelScale() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  return width > 0 ? float(size().x) / float(width) : 1.0f;
}

void Window::wait(double seconds) {
  if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
}

void Window::wake() { glfwPostEmptyEvent(); }

void Window::inject(const InputEvent& event) {
  if (const auto* pointer = std::get_if<PointerEvent>(&event)) pointer_ = pointer->place;
  if (const auto* button = std::get_if<ButtonEvent>(&event)) {
    for (const auto& [number, name] : kButtons)
      if (name == button->button) down_[number] = button->down;
  }
  if (const auto* wheel = std::get_if<WheelEvent>(&event))
    ImGui_ImplGlfw_ScrollCallback(window_, 0.0, double(wheel->notches));
  events_.push_back(event);
}

std::vector<InputEvent> Window::takeEvents() { return std::exchange(events_, {}); }

void Window::beginFrame() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (scripted_) {
    // The desktop's own pointer is not the script's.
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(pointer_.x / pixelScale(), pointer_.y / pixelScale());
    std::copy(std::begin(down_), std::end(down_), io.MouseDown);
  }
  ImGui::NewFrame();
  const ivec2 frame = size();
  gl_.Viewport(0, 0, frame.x, frame.y);
  gl_.ClearColor(0.08f, 0.08f, 0.08f, 1.0f);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
}

void Window::endFrame(std::vector<std::uint8_t>* keep) {
  const ivec2 frame = size();
  gl_.Viewport(0, 0, frame.x, frame.y);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (keep) *keep = readPixels();
  glfwSwapBuffers(window_);
}

void Window::setVsync(bool on) { glfwSwapInterval(on ? 1 : 0); }

std::vector<std::uint8_t> Window::readPixels() const {
  const ivec2 frame = size();
  const std::size_t row = std::size_t(frame.x) * 3;
  std::vector<std::uint8_t> upward(row * std::size_t(frame.y)), pixels(upward.size());
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, frame.x, frame.y, GL_RGB, GL_UNSIGNED_BYTE, upward.data());
  for (int y = 0; y < frame.y; ++y)
    std::copy_n(upward.begin() + std::ptrdiff_t(row) * (frame.y - 1 - y), row,
                pixels.begin() + std::ptrdiff_t(row) * y);
  return pixels;
}

std::string Window::renderer() const {
  const GLubyte* words = gl_.GetString(GL_RENDERER);
  return words ? reinterpret_cast<const char*>(words) : "unknown";
}

}  // namespace isophote::viewer

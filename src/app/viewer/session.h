// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/camera_control.h"
#include "app/viewer/key_table.h"
#include "app/viewer/light_drag.h"
#include "app/viewer/render_loop.h"
#include "app/viewer/view_settings.h"
#include "scene/scene.h"

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace isophote::viewer {

enum class MouseButton { kLeft, kRight, kMiddle };

/// The settings that a preset stands for in this viewer, by its name; empty: the defaults.
using SettingsOfPreset = std::function<RenderSettings(std::string_view preset)>;

/// What a person looks at, and what hands on mouse and keys do to it. Knows no window: places are in pixels
/// of the window's picture, from its upper left.
class Session {
 public:
  /// `scene` must outlive the session; `settings` are those of `preset`, by its name.
  Session(const Scene& scene, const Camera& camera, const ViewerSettings& settings, std::string preset,
          SettingsOfPreset presets);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Input.
  void pressKey(KeyPress press);
  void releaseKey(Key key);
  void pressButton(MouseButton button, vec2 place, bool shift, bool control);
  void releaseButton(MouseButton button);
  void movePointer(vec2 place);
  void turnWheel(float notches);
  /// Lets go of everything that is held: the window has lost the keyboard.
  void releaseAll();
  /// So much time has gone by with the keys that are held.
  void tick(float seconds);
  /// Whether tick() changes anything.
  bool flies() const;

  // What panels and scripts change.
  const Scene& scene() const { return scene_; }
  const KeyTable& keys() const { return keys_; }
  const ViewerSettings& settings() const { return settings_; }
  const CameraControl& camera() const { return camera_; }
  const std::vector<Light>& lights() const { return lights_; }
  std::optional<std::size_t> selected() const { return selected_; }
  std::string_view preset() const { return preset_; }

  /// "photon_trace.photons=1e6". Throws Error(kBadUsage).
  void set(std::string_view key, std::string_view value);
  void usePreset(std::string_view name);
  void setCamera(const Camera& camera);
  void setCameraMode(CameraMode mode) { camera_.setMode(mode); }
  void setSpeed(float metresPerSecond) { camera_.setSpeed(metresPerSecond); }
  void frameScene();
  void select(std::optional<std::size_t> light) { selected_ = light; }
  /// Throws Error(kBadUsage) where there is no such light, or it cannot be moved.
  void moveLight(std::size_t light, vec3 position);
  void aimLight(std::size_t light, vec3 direction);
  /// Size of the window's picture [pixels]; times view.scale, that of the rendered one.
  void setPictureSize(int width, int height);
  ivec2 pictureSize() const { return pictureSize_; }

  PictureView pictureView() const;
  /// Where the lights are seen, by light.
  std::vector<std::optional<vec2>> markers() const;

  /// What shall be rendered, where that has changed since the last time. `busy`: a panel's widget is being
  /// dragged.
  std::optional<RenderRequest> request(bool busy = false);

  bool helpShown = false;
  bool panelShown = true;
  bool closed = false;
  bool animated = false;  ///< Something moves without a hand: a script's light.
  /// Endings of pictures that are to be kept: ".png", ".exr".
  std::vector<std::string_view> screenshots;

 private:
  enum class Drag { kNone, kTurn, kPan, kLight, kAim };

  void addCameraKeys();
  void addLightKeys();
  void addPictureKeys();
  void nextCamera();
  void selectNextLight();
  void dragLight(vec2 place);
  const Light& lightOf(std::size_t index) const;
  bool moves() const { return drag_ != Drag::kNone || animated || flies(); }
  void change() { changed_ = true; }

  const Scene& scene_;
  ViewerSettings settings_;
  SettingsOfPreset settingsOfPreset_;
  Camera home_;
  CameraControl camera_;
  std::vector<Light> lights_;
  std::optional<std::size_t> selected_;
  std::string preset_;
  std::size_t cameraIndex_ = 0;
  KeyTable keys_;
  std::set<Key> held_;
  bool fast_ = false;
  Drag drag_ = Drag::kNone;
  MouseButton dragButton_ = MouseButton::kLeft;
  vec2 pointer_{0};
  ivec2 pictureSize_{1280, 720};
  bool changed_ = true;
  bool moved_ = false;  ///< As the last request said.
};

}  // namespace isophote::viewer

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/session.h"

#include "base/error.h"
#include "scene/light_place.h"
#include "settings/apply.h"

#include <algorithm>
#include <cmath>

namespace isophote::viewer {

namespace {

/// How near to a light's marker the pointer picks it [pixels].
constexpr float kMarkerReach = 14.0f;
constexpr float kExposureStep = 1.0f / 3.0f;

std::uint32_t scaled(int pixels, float scale) {
  return std::uint32_t(std::clamp(std::lround(double(pixels) * double(scale)), 1l, 16384l));
}

}  // namespace

Session::Session(const Scene& scene, const Camera& camera, const ViewerSettings& settings, std::string preset,
                 SettingsOfPreset presets)
    : scene_(scene),
      settings_(settings),
      settingsOfPreset_(std::move(presets)),
      home_(camera),
      camera_(camera, scene.bounds),
      lights_(scene.lights),
      preset_(std::move(preset)) {
  addCameraKeys();
  addLightKeys();
  addPictureKeys();
}

void Session::addCameraKeys() {
  const auto fly = [&](Key key, vec3 way, const char* help) {
    keys_.add({.press = {key}, .help = help, .action = {}, .way = way});
  };
  fly('W', {0, 0, 1}, "Fly forward while held; with Shift five times as fast, as all of these");
  fly('S', {0, 0, -1}, "Fly back");
  fly('A', {-1, 0, 0}, "Fly to the left");
  fly('D', {1, 0, 0}, "Fly to the right");
  fly('E', {0, 1, 0}, "Fly up");
  fly('Q', {0, -1, 0}, "Fly down");
  keys_.add({{'O'}, "Orbit about what is looked at, or fly again", [this] {
               camera_.setMode(camera_.mode() == CameraMode::kFly ? CameraMode::kOrbit : CameraMode::kFly);
             }});
  keys_.add({{'F'}, "Frame the whole scene", [this] { frameScene(); }});
  keys_.add({{'C'}, "Next camera of the scene", [this] { nextCamera(); }});
  keys_.add({{'R'}, "Back to the camera of the start", [this] { setCamera(home_); }});
}

void Session::addLightKeys() {
  keys_.add({{'L'}, "Choose the next light", [this] { selectNextLight(); }});
  keys_.add({{kKeyEscape}, "Choose no light", [this] { select(std::nullopt); }});
  const auto axis = [&](Key key, vec3 along, const char* help) {
    keys_.add({.press = {key}, .help = help, .action = {}, .axis = along});
  };
  axis('X', {1, 0, 0}, "Drag a light along x while held");
  axis('Y', {0, 1, 0}, "Drag a light along y while held");
  axis('Z', {0, 0, 1}, "Drag a light along z while held");
  keys_.add({{'R', true}, "Put all lights back", [this] {
               lights_ = scene_.lights;
               change();
             }});
}

void Session::addPictureKeys() {
  keys_.add({{'0'}, "Settings without a preset", [this] { usePreset(""); }});
  Key digit = '1';
  for (const PresetInfo& info : presets()) {
    if (digit > '9') break;
    keys_.add(
        {{digit++}, fmt::format("Preset {}", info.name), [this, name = info.name] { usePreset(name); }});
  }
  DisplayOptions& display = settings_.display;
  keys_.add(
      {{kKeyMinus}, "Darker by a third of a stop", [&display] { display.exposureEv -= kExposureStep; }});
  keys_.add(
      {{kKeyEqual}, "Brighter by a third of a stop", [&display] { display.exposureEv += kExposureStep; }});
  keys_.add(
      {{'G'}, "Automatic exposure, or none", [&display] { display.autoExposure = !display.autoExposure; }});
  keys_.add({{'T'}, "Next tone map", [&display] {
               constexpr auto kCount = EnumNames<ToneMap>::names.size();
               display.toneMap = ToneMap((std::size_t(display.toneMap) + 1) % kCount);
             }});
  keys_.add({{kKeySpace}, "Refine the picture while nothing moves, or do not", [this] {
               settings_.view.refine = !settings_.view.refine;
               change();
             }});
  keys_.add({{'P'}, "Keep the picture as PNG", [this] { screenshots.emplace_back(".png"); }});
  keys_.add({{'P', true}, "Keep the picture as OpenEXR", [this] { screenshots.emplace_back(".exr"); }});
  keys_.add({{kKeyTab}, "Show or hide the panel", [this] { panelShown = !panelShown; }});
  keys_.add({{'H'}, "Show or hide this table", [this] { helpShown = !helpShown; }});
  keys_.add({{'Q', false, true}, "Close the viewer", [this] { closed = true; }});
}

void Session::pressKey(KeyPress press) {
  fast_ = press.shift;
  const KeyBinding* binding = keys_.find(press);
  if (!binding) return;
  if (binding->action)
    binding->action();
  else
    held_.insert(press.key);
}

void Session::releaseKey(Key key) { held_.erase(key); }

void Session::releaseAll() {
  held_.clear();
  drag_ = Drag::kNone;
}

bool Session::flies() const {
  return std::ranges::any_of(held_, [&](Key key) { return keys_.find({key})->way.has_value(); });
}

void Session::tick(float seconds) {
  if (!flies() || !(seconds > 0.0f)) return;
  vec3 way(0.0f);
  for (const Key key : held_) way += keys_.find({key})->way.value_or(vec3(0.0f));
  if (way == vec3(0.0f)) return;
  camera_.fly(way, seconds, fast_);
  change();
}

void Session::pressButton(MouseButton button, vec2 place, bool shift, bool control) {
  pointer_ = place;
  if (drag_ != Drag::kNone) return;
  dragButton_ = button;
  if (button == MouseButton::kMiddle || (button == MouseButton::kLeft && shift)) {
    drag_ = Drag::kPan;
    return;
  }
  drag_ = Drag::kTurn;
  if (button != MouseButton::kLeft) return;
  if (control && selected_ && hasAim(lights_[*selected_])) {
    drag_ = Drag::kAim;
  } else if (const auto light = markerAt(markers(), place, kMarkerReach)) {
    selected_ = light;
    drag_ = Drag::kLight;
  }
}

void Session::releaseButton(MouseButton button) {
  if (button == dragButton_) drag_ = Drag::kNone;
}

void Session::movePointer(vec2 place) {
  const vec2 step = place - pointer_;
  if (step == vec2(0.0f)) return;
  switch (drag_) {
    case Drag::kNone:
      break;
    case Drag::kTurn:
      camera_.turn(step);
      break;
    case Drag::kPan:
      camera_.pan(step, float(pictureSize_.y));
      break;
    case Drag::kLight:
      dragLight(place);
      break;
    case Drag::kAim:
      aimLight(*selected_, turnedDirection(pictureView(), lights_[*selected_].direction, pointer_, place));
      break;
  }
  if (drag_ != Drag::kNone) change();
  pointer_ = place;
}

void Session::dragLight(vec2 place) {
  const vec3 from = lightPosition(lights_[*selected_]).value();
  const PictureView view = pictureView();
  vec3 to = draggedInPlane(view, from, pointer_, place);
  for (const Key key : held_)
    if (const std::optional<vec3> axis = keys_.find({key})->axis)
      to = draggedAlong(view, from, *axis, pointer_, place);
  moveLight(*selected_, to);
}

void Session::turnWheel(float notches) {
  camera_.wheel(notches);
  change();
}

void Session::set(std::string_view key, std::string_view value) {
  ViewerSettings changed = settings_;
  setSetting(fieldsOfGroups(changed), key, value, {ErrorKind::kBadUsage, ""});
  settings_ = changed;
  if (!key.starts_with("display.")) change();  // Those are the window's alone.
}

void Session::usePreset(std::string_view name) {
  settings_.render = settingsOfPreset_(name);
  preset_ = name;
  change();
}

void Session::setCamera(const Camera& camera) {
  camera_.setCamera(camera);
  change();
}

void Session::nextCamera() {
  cameraIndex_ = (cameraIndex_ + 1) % scene_.cameras.size();
  setCamera(scene_.cameras[cameraIndex_]);
}

void Session::frameScene() {
  camera_.frameScene(float(pictureSize_.x) / float(pictureSize_.y));
  change();
}

void Session::selectNextLight() {
  if (lights_.empty()) return;
  selected_ = selected_ ? (*selected_ + 1) % lights_.size() : 0;
}

const Light& Session::lightOf(std::size_t index) const {
  if (index >= lights_.size())
    failUsage("", "there is no light {}; the scene has {}, counted from 0", index, lights_.size());
  return lights_[index];
}

void Session::moveLight(std::size_t light, vec3 position) {
  lights_[light] = movedLight(lightOf(light), position);
  change();
}

void Session::aimLight(std::size_t light, vec3 direction) {
  lights_[light] = aimedLight(lightOf(light), direction, scene_.bounds);
  change();
}

void Session::setPictureSize(int width, int height) {
  const ivec2 size(std::max(width, 1), std::max(height, 1));
  if (size == pictureSize_) return;
  pictureSize_ = size;
  change();
}

PictureView Session::pictureView() const {
  return {cameraRays(camera_.camera(), pictureSize_.x, pictureSize_.y), vec2(pictureSize_)};
}

std::vector<std::optional<vec2>> Session::markers() const {
  const PictureView view = pictureView();
  std::vector<std::optional<vec2>> markers(lights_.size());
  for (std::size_t i = 0; i < lights_.size(); ++i)
    if (const std::optional<vec3> position = lightPosition(lights_[i])) markers[i] = pixelOf(view, *position);
  return markers;
}

std::optional<RenderRequest> Session::request(bool busy) {
  const bool moving = moves() || busy;
  if (!changed_ && moving == moved_) return std::nullopt;
  // A button that is held but does not move has changed nothing yet.
  if (!changed_ && moving) return std::nullopt;
  changed_ = false;
  moved_ = moving;
  RenderRequest request{settings_.render, settings_.view, camera_.camera(), lights_, moving};
  request.settings.frame.width = scaled(pictureSize_.x, settings_.view.scale);
  request.settings.frame.height = scaled(pictureSize_.y, settings_.view.scale);
  return request;
}

}  // namespace isophote::viewer

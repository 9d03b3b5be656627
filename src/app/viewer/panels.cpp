// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/panels.h"

#include "app/viewer/setting_widgets.h"
#include "base/error.h"
#include "scene/light_place.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace isophote::viewer {

namespace {

constexpr float kPanelWidth = 340;  ///< At a font scale of 1.
constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                    ImGuiWindowFlags_NoSavedSettings;
const ImVec4 kErrorColour(1.0f, 0.45f, 0.4f, 1.0f);
const ImVec4 kWarningColour(1.0f, 0.8f, 0.4f, 1.0f);
const ImVec4 kBarColour(0.2f, 0.42f, 0.66f, 1.0f);  // White figures are read on it.

float fontScale() { return ImGui::GetIO().FontGlobalScale; }

constexpr std::array<std::pair<const char*, const char*>, 5> kMouseHelp{{
    {"left drag", "Turn, or move the light that is beneath"},
    {"right drag", "Turn"},
    {"middle drag", "Pan; so does Shift with the left button"},
    {"Ctrl left drag", "Turn the spot or sun that is chosen"},
    {"wheel", "Speed while flying, distance while orbiting"},
}};

const char* kindOf(const Light& light) {
  constexpr std::array<const char*, 6> kKinds{"point",     "spot",          "sun",
                                              "rectangle", "emissive mesh", "environment"};
  return kKinds.at(light.type);
}

void wrapped(const ImVec4& colour, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

void drawStatus(const Session& session, const PanelFacts& facts) {
  const RenderedPicture& picture = facts.picture;
  if (picture.number == 0) {
    ImGui::TextUnformatted("The first picture is on its way");
  } else {
    ImGui::Text("%5.1f pictures/s   %.0f ms", facts.picturesPerSecond, picture.milliseconds);
    const FrameSettings& frame = session.settings().render.frame;
    const std::uint32_t most = frame.passes > 1 ? frame.passes : session.settings().view.refinePasses;
    const Image& image = picture.film->colour;
    if (picture.divisor > 1)
      ImGui::Text("%d x %d, a draft of 1/%d", image.width, image.height, picture.divisor);
    else
      ImGui::Text("%d x %d, pass %u of %u", image.width, image.height, picture.passes, most);
  }
  if (!facts.error.empty()) wrapped(kErrorColour, facts.error);
  for (const std::string& warning : facts.warnings) wrapped(kWarningColour, warning);
  if (!facts.notice.empty()) wrapped(ImGui::GetStyle().Colors[ImGuiCol_Text], facts.notice);
}

template <class Names, class Choose>
void combo(const char* label, const std::string& current, const Names& names, const Choose& choose) {
  ImGui::SetNextItemWidth(14.0f * ImGui::GetFontSize());
  if (!ImGui::BeginCombo(label, current.c_str())) return;
  for (std::size_t i = 0; i < names.size(); ++i) {
    ImGui::PushID(int(i));
    if (ImGui::Selectable(names[i].c_str(), names[i] == current)) choose(i);
    ImGui::PopID();
  }
  ImGui::EndCombo();
}

void drawView(Session& session) {
  if (!ImGui::CollapsingHeader("camera and preset", ImGuiTreeNodeFlags_DefaultOpen)) return;
  std::vector<std::string> names{"none"};
  for (const PresetInfo& info : presets()) names.emplace_back(info.name);
  combo("preset", session.preset().empty() ? "none" : std::string(session.preset()), names,
        [&](std::size_t i) { session.usePreset(i == 0 ? "" : names[i]); });
  const std::vector<Camera>& cameras = session.scene().cameras;
  names.clear();
  for (std::size_t i = 0; i < cameras.size(); ++i)
    names.push_back(cameras[i].name.empty() ? fmt::format("camera {}", i) : cameras[i].name);
  combo("camera", session.camera().camera().name.empty() ? "camera 0" : session.camera().camera().name, names,
        [&](std::size_t i) { session.setCamera(cameras[i]); });
  const CameraMode mode = session.camera().mode();
  if (ImGui::RadioButton("fly", mode == CameraMode::kFly)) session.setCameraMode(CameraMode::kFly);
  ImGui::SameLine();
  if (ImGui::RadioButton("orbit", mode == CameraMode::kOrbit)) session.setCameraMode(CameraMode::kOrbit);
  ImGui::SameLine();
  if (ImGui::Button("frame")) session.frameScene();
  ImGui::SameLine();
  if (ImGui::Button("keys")) session.helpShown = !session.helpShown;
  float speed = session.camera().speed();
  ImGui::SetNextItemWidth(9.5f * ImGui::GetFontSize());
  if (ImGui::DragFloat("speed [m/s]", &speed, 0.01f * speed, 0.0f, 0.0f, "%.3g")) session.setSpeed(speed);
}

void drawLight(Session& session, std::size_t index) {
  const Light& light = session.lights()[index];
  const float pace = 0.002f * session.scene().bounds.radius();
  if (const std::optional<vec3> place = lightPosition(light)) {
    vec3 position = *place;
    if (ImGui::DragFloat3("at [m]", &position.x, pace, 0.0f, 0.0f, "%.2f"))
      session.moveLight(index, position);
  }
  if (!hasAim(light)) return;
  vec3 direction = light.direction;
  if (ImGui::DragFloat3("shines", &direction.x, 0.005f, -1.0f, 1.0f, "%.2f") && length(direction) > 1e-3f)
    session.aimLight(index, direction);
}

void drawLights(Session& session) {
  const std::vector<Light>& lights = session.lights();
  if (!ImGui::CollapsingHeader("lights", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const float row = ImGui::GetTextLineHeightWithSpacing();
  const float height = row * float(std::clamp<std::size_t>(lights.size(), 1, 5)) + row;
  ImGui::BeginChild("list", ImVec2(0, height), true);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const std::string label = fmt::format("{}: {}, {:.3g} W##{}", i, kindOf(lights[i]), lights[i].power, i);
    if (ImGui::Selectable(label.c_str(), session.selected() == i)) session.select(i);
  }
  ImGui::EndChild();
  if (session.selected()) drawLight(session, *session.selected());
}

void drawTimes(const Stats& stats) {
  if (!ImGui::CollapsingHeader("times", ImGuiTreeNodeFlags_DefaultOpen)) return;
  double longest = 1e-9;
  for (const auto& [name, milliseconds] : stats.stages()) longest = std::max(longest, milliseconds);
  if (!ImGui::BeginTable("times", 2, ImGuiTableFlags_SizingStretchProp)) return;
  ImGui::TableSetupColumn("stage", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("time", ImGuiTableColumnFlags_WidthFixed, 8.0f * ImGui::GetFontSize());
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, kBarColour);
  for (const auto& [name, milliseconds] : stats.stages()) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name.c_str());
    ImGui::TableNextColumn();
    ImGui::ProgressBar(float(milliseconds / longest), ImVec2(-1, ImGui::GetTextLineHeight()),
                       fmt::format("{:.1f} ms", milliseconds).c_str());
  }
  ImGui::PopStyleColor();
  ImGui::EndTable();
}

void drawSettings(Session& session) {
  ViewerSettings shown = session.settings();
  std::vector<Field> fields = fieldsOfGroups(shown);
  // The window decides on the picture's size, and layers are not shown.
  std::erase_if(fields, [](const Field& field) {
    return field.key == "frame.width" || field.key == "frame.height" || field.key == "frame.layers" ||
           field.key == "frame.densityLayer";
  });
  if (const auto chosen = settingWidgets(fields, "display")) session.set(chosen->key, chosen->value);
}

void drawPanel(Session& session, const PanelFacts& facts, vec2 place, vec2 size) {
  ImGui::SetNextWindowPos(ImVec2(place.x, place.y));
  ImGui::SetNextWindowSize(ImVec2(size.x, size.y));
  if (ImGui::Begin("panel", nullptr, kFixed)) {
    drawStatus(session, facts);
    drawView(session);
    drawLights(session);
    drawTimes(facts.picture.stats);
    drawSettings(session);
  }
  ImGui::End();
}

void row(const std::string& key, const std::string& help) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(key.c_str());
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(help.c_str());
}

/// The key table itself, and the mouse.
void drawHelp(Session& session, vec2 picture) {
  ImGui::SetNextWindowPos(ImVec2(0.5f * picture.x, 0.5f * picture.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  ImGui::SetNextWindowBgAlpha(0.9f);
  ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(picture.x, picture.y));
  const ImGuiWindowFlags flags = (kFixed & ~ImGuiWindowFlags_NoTitleBar) | ImGuiWindowFlags_AlwaysAutoResize;
  if (ImGui::Begin("keys and mouse", &session.helpShown, flags) &&
      ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const KeyBinding& binding : session.keys().bindings()) row(keyName(binding.press), binding.help);
    for (const auto& [what, help] : kMouseHelp) row(what, help);
    ImGui::EndTable();
  }
  ImGui::End();
}

void drawMarkers(const Session& session, float pixelScale) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const vec2 size = vec2(session.pictureSize()) / pixelScale;
  list.PushClipRect(ImVec2(0, 0), ImVec2(size.x, size.y));
  const std::vector<std::optional<vec2>> markers = session.markers();
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!markers[i]) continue;
    const bool chosen = session.selected() == i;
    const ImVec2 at(markers[i]->x / pixelScale, markers[i]->y / pixelScale);
    const float radius = 7.0f * fontScale();
    // Dark and bright, so that it is seen on any picture.
    list.AddCircle(at, radius, IM_COL32(0, 0, 0, 200), 0, 4.0f);
    list.AddCircle(at, radius, chosen ? IM_COL32(255, 200, 60, 255) : IM_COL32(255, 255, 255, 220), 0, 2.0f);
    if (!chosen) continue;
    const std::string label = fmt::format("light {}", i);
    const ImVec2 text(at.x + 1.6f * radius, at.y - 0.5f * ImGui::GetFontSize());
    list.AddText(ImVec2(text.x + 1, text.y + 1), IM_COL32(0, 0, 0, 255), label.c_str());
    list.AddText(text, IM_COL32(255, 200, 60, 255), label.c_str());
  }
  list.PopClipRect();
}

}  // namespace

int panelWidth(float pixelScale) { return int(std::lround(kPanelWidth * fontScale() * pixelScale)); }

bool drawPanels(Session& session, const PanelFacts& facts, float pixelScale) {
  const vec2 picture = vec2(session.pictureSize()) / pixelScale;
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  drawMarkers(session, pixelScale);
  if (session.panelShown)
    drawPanel(session, facts, vec2(picture.x, 0), vec2(std::max(whole.x - picture.x, 1.0f), whole.y));
  if (session.helpShown) drawHelp(session, picture);
  return ImGui::IsAnyItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left);
}

bool panelsWantPointer() { return ImGui::GetIO().WantCaptureMouse; }
bool panelsWantKeys() { return ImGui::GetIO().WantTextInput; }

}  // namespace isophote::viewer

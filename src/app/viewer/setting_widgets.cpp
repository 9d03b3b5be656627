// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/setting_widgets.h"

#include "settings/apply.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace isophote::viewer {

namespace {

/// The longest range that a slider's width still tells apart.
constexpr double kSliderSteps = 64;

template <class T>
constexpr ImGuiDataType kDataType = std::is_same_v<T, int>             ? ImGuiDataType_S32
                                    : std::is_same_v<T, std::uint32_t> ? ImGuiDataType_U32
                                    : std::is_same_v<T, std::uint64_t> ? ImGuiDataType_U64
                                                                       : ImGuiDataType_Float;

/// Draws one widget over a copy of the value.
struct Drawer {
  const Field& field;
  std::string label;

  bool operator()(bool* value) {
    bool copy = *value;
    const bool changed = ImGui::Checkbox(label.c_str(), &copy);
    if (changed) text = copy ? "true" : "false";
    return changed;
  }

  bool operator()(const EnumRef& value) {
    bool changed = false;
    const std::size_t current = value.get();
    if (!ImGui::BeginCombo(label.c_str(), std::string(value.names[current]).c_str())) return false;
    for (std::size_t i = 0; i < value.names.size(); ++i)
      if (ImGui::Selectable(std::string(value.names[i]).c_str(), i == current) && i != current) {
        text = value.names[i];
        changed = true;
      }
    ImGui::EndCombo();
    return changed;
  }

  bool operator()(std::string* value) {
    std::string copy = *value;
    const bool changed = ImGui::InputText(label.c_str(), &copy, ImGuiInputTextFlags_EnterReturnsTrue);
    if (changed) text = "\"" + copy + "\"";
    return changed;
  }

  template <class T>
  bool operator()(T* value) {
    T copy = *value;
    const T low = limit<T>(field.info.min), high = limit<T>(field.info.max);
    bool changed = false;
    if (widgetKind(field) == WidgetKind::kSlider) {
      changed = ImGui::SliderScalar(label.c_str(), kDataType<T>, &copy, &low, &high, nullptr,
                                    ImGuiSliderFlags_AlwaysClamp);
    } else {
      // A drag over the panel's width changes a value by a good part of itself.
      const float pace =
          std::max(0.01f * std::abs(float(copy)), std::is_floating_point_v<T> ? 0.001f : 0.05f);
      const char* format = std::is_floating_point_v<T> ? "%.4g" : nullptr;
      changed = ImGui::DragScalar(label.c_str(), kDataType<T>, &copy, pace, &low, &high, format,
                                  ImGuiSliderFlags_AlwaysClamp);
    }
    if (changed && copy != *value) text = fmt::format("{}", copy);
    return !text.empty();
  }

  /// A bound within what the type holds.
  template <class T>
  static T limit(double bound) {
    constexpr double kLow = double(std::numeric_limits<T>::lowest());
    // The largest value that is below the type's own, as a double and back.
    constexpr double kHigh =
        std::is_same_v<T, std::uint64_t> ? 9007199254740992.0 : double(std::numeric_limits<T>::max());
    return T(std::clamp(bound, kLow, kHigh));
  }

  std::string text{};
};

std::string headingOf(std::string_view group) {
  std::string heading(group);
  std::replace(heading.begin(), heading.end(), '_', ' ');
  return heading + "##" + std::string(group);
}

}  // namespace

WidgetKind widgetKind(const Field& field) {
  if (std::holds_alternative<bool*>(field.value)) return WidgetKind::kCheckbox;
  if (std::holds_alternative<EnumRef>(field.value)) return WidgetKind::kCombo;
  if (std::holds_alternative<std::string*>(field.value)) return WidgetKind::kText;
  const double span = field.info.max - field.info.min;
  const bool fine = std::holds_alternative<float*>(field.value) ? span <= 20 : span <= kSliderSteps;
  return std::isfinite(span) && fine ? WidgetKind::kSlider : WidgetKind::kNumber;
}

std::string widgetLabel(const Field& field) {
  const std::string name = field.key.substr(field.key.find('.') + 1);
  return field.info.unit.empty() ? name : fmt::format("{} [{}]", name, field.info.unit);
}

std::optional<ChosenSetting> settingWidget(const Field& field) {
  Drawer drawer{field, widgetLabel(field) + "##" + field.key};
  ImGui::SetNextItemWidth(9.5f * ImGui::GetFontSize());
  const bool changed = std::visit(drawer, field.value);
  if (ImGui::IsItemHovered()) {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(26.0f * ImGui::GetFontSize());
    const std::string range = rangeText(field);
    ImGui::TextUnformatted(field.key.c_str());
    ImGui::TextUnformatted(field.info.help.data(), field.info.help.data() + field.info.help.size());
    if (!range.empty()) ImGui::TextDisabled("%s", range.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
  if (!changed || drawer.text.empty()) return std::nullopt;
  return ChosenSetting{field.key, drawer.text};
}

std::optional<ChosenSetting> settingWidgets(std::span<const Field> fields, std::string_view open) {
  std::optional<ChosenSetting> chosen;
  std::string_view group;
  bool unfolded = false;
  for (const Field& field : fields) {
    const std::string_view its = std::string_view(field.key).substr(0, field.key.find('.'));
    if (its != group) {
      group = its;
      unfolded = ImGui::CollapsingHeader(headingOf(group).c_str(),
                                         group == open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    }
    if (!unfolded) continue;
    if (auto changed = settingWidget(field)) chosen = std::move(changed);
  }
  return chosen;
}

}  // namespace isophote::viewer

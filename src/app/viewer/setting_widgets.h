// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "settings/visit.h"

#include <optional>
#include <span>
#include <string>

namespace isophote::viewer {

/// A widget for each setting, made from its declaration alone: a box to tick, a list of names, a slider where
/// the range is short, else a number that is dragged or typed. The label names the unit, the tooltip is the
/// setting's own sentence and range.
enum class WidgetKind { kCheckbox, kCombo, kSlider, kNumber, kText };
WidgetKind widgetKind(const Field& field);

/// "radius [m]"
std::string widgetLabel(const Field& field);

/// A value that a person has chosen.
struct ChosenSetting {
  std::string key;
  std::string value;  ///< As setSetting() reads it.
};

/// Draws the widgets, group by group beneath its heading; returns what was changed. Where `open` names a
/// group, that one starts unfolded.
std::optional<ChosenSetting> settingWidgets(std::span<const Field> fields, std::string_view open = {});

/// The widget of one setting, whose tooltip is its help.
std::optional<ChosenSetting> settingWidget(const Field& field);

}  // namespace isophote::viewer

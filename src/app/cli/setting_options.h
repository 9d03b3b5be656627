// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "settings/visit.h"

#include <CLI/CLI.hpp>

#include <span>
#include <string>
#include <vector>

namespace isophote::cli {

/// A short way to write settings: --width N sets frame.width.
struct SettingOption {
  std::string option;
  std::string valueName;          ///< In the help: "N", "METRES".
  std::vector<std::string> keys;  ///< All of them receive the value; the first one's help is shown...
  std::string help = {};          ///< ...unless the option says more, or
  std::string byDefault = {};     ///< has another default.
};

/// A value that was given to such an option.
struct GivenSetting {
  std::string option;
  std::vector<std::string> keys;
  std::string value;
};

/// Adds the options to a command, with help, range and default of the settings themselves. `given`, which
/// must live until the command line has been parsed, receives what a person wrote.
void addSettingOptions(CLI::App& parser, std::span<const SettingOption> options,
                       std::span<const Field> fields, std::vector<GivenSetting>& given);

/// Sets what was given; errors name the option.
void applyGiven(std::span<const Field> fields, std::span<const GivenSetting> given);

}  // namespace isophote::cli

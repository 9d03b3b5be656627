// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/setting_options.h"

#include "settings/apply.h"

#include <algorithm>

namespace isophote::cli {
namespace {

std::string helpOf(const SettingOption& option, const Field& field) {
  const std::string range = rangeText(field);
  return fmt::format("{} [{}{}{}]", option.help.empty() ? field.info.help : option.help,
                     option.byDefault.empty() ? valueText(field) : option.byDefault,
                     range.empty() ? "" : "; ", range);
}

}  // namespace

void addSettingOptions(CLI::App& parser, std::span<const SettingOption> options,
                       std::span<const Field> fields, std::vector<GivenSetting>& given) {
  for (const SettingOption& option : options) {
    const auto field = std::find_if(fields.begin(), fields.end(),
                                    [&](const Field& f) { return f.key == option.keys.front(); });
    if (field == fields.end()) fail(ErrorKind::kInternal, option.option, "names no setting");
    const auto remember = [&given, name = option.option, keys = option.keys](const std::string& value) {
      given.push_back({name, keys, value});
    };
    parser.add_option_function<std::string>(option.option, remember, helpOf(option, *field))
        ->type_name(option.valueName)
        ->take_last()
        ->group("Settings");
  }
}

void applyGiven(std::span<const Field> fields, std::span<const GivenSetting> given) {
  for (const GivenSetting& setting : given)
    for (const std::string& key : setting.keys)
      setSetting(fields, key, setting.value, {ErrorKind::kBadUsage, setting.option});
}

}  // namespace isophote::cli

// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "isophote/settings.h"

#include "api/content.h"
#include "render/quality.h"
#include "settings/apply.h"
#include "settings/suggest.h"

namespace isophote {

namespace {

const SettingOrigin kOrigin{ErrorKind::kBadUsage, ""};

}  // namespace

Settings::Settings() : content_(std::make_unique<Content>()) {}
Settings::~Settings() = default;
Settings::Settings(const Settings& other) : content_(std::make_unique<Content>(*other.content_)) {}
Settings& Settings::operator=(const Settings& other) {
  *content_ = *other.content_;
  return *this;
}
Settings::Settings(Settings&&) noexcept = default;
Settings& Settings::operator=(Settings&&) noexcept = default;

Settings Settings::preset(std::string_view name) {
  return api::guarded([&] {
    Settings settings;
    settings.content_->render = presetSettings(name);
    return settings;
  });
}

Settings& Settings::apply(const World& world) {
  return api::guarded([&]() -> Settings& {
    const std::vector<Field> fields = fieldsOfGroups(content_->render);
    for (const auto& [key, value] : world.content().scene.settings)
      setSetting(fields, key, value, {ErrorKind::kBadInput, world.content().scene.name});
    return *this;
  });
}

Settings& Settings::applyQuality(std::string_view name) {
  return api::guarded([&]() -> Settings& {
    const std::vector<Field> fields = fieldsOfGroups(content_->render);
    for (const std::string_view assignment : qualityNamed(name).assignments)
      setFromAssignment(fields, assignment, kOrigin);
    return *this;
  });
}

Settings& Settings::set(std::string_view key, std::string_view value) {
  return api::guarded([&]() -> Settings& {
    setSetting(fieldsOfGroups(content_->render), key, value, kOrigin);
    return *this;
  });
}

Settings& Settings::set(std::string_view key, double value) { return set(key, fmt::format("{}", value)); }

Settings& Settings::setJson(std::string_view json) {
  return api::guarded([&]() -> Settings& {
    Content changed = *content_;  // A key may be wrong after others were set.
    setFromJson(fieldsOfGroups(changed.render), json, kOrigin);
    *content_ = changed;
    return *this;
  });
}

std::string Settings::get(std::string_view key) const {
  std::vector<std::string> keys;
  for (const SettingInfo& setting : list()) {
    if (setting.key == key) return setting.value;
    keys.push_back(setting.key);
  }
  failUsage("", "there is no setting \"{}\"{}", key, suggestion(key, keys));
}

std::string Settings::json() const { return settingsJson(fieldsOfGroups(content_->render)); }

std::vector<SettingInfo> Settings::list() const {
  std::vector<SettingInfo> settings;
  for (const Field& field : fieldsOfGroups(content_->render))
    settings.push_back({field.key, valueText(field), rangeText(field), std::string(field.info.unit),
                        std::string(field.info.help)});
  return settings;
}

}  // namespace isophote

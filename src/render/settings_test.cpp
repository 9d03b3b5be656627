// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/settings.h"

#include "base/error.h"
#include "settings/apply.h"

#include <gtest/gtest.h>

#include <set>

namespace isophote {
namespace {

TEST(RenderSettings, EveryDefaultIsInItsRangeAndEveryKeyIsUsedOnce) {
  RenderSettings settings;
  const std::vector<Field> fields = fieldsOfGroups(settings);
  std::set<std::string> keys;
  for (const Field& field : fields) {
    EXPECT_TRUE(keys.insert(field.key).second) << field.key;
    EXPECT_TRUE(field.info.help.ends_with(".")) << field.key;
    EXPECT_NO_THROW(setSetting(fields, field.key, valueText(field), {})) << field.key;
  }
  EXPECT_GE(keys.size(), 15u);
}

TEST(RenderSettings, PresetsAreKnownByName) {
  EXPECT_FALSE(presets().empty());
  for (const PresetInfo& preset : presets()) EXPECT_NO_THROW(presetSettings(preset.name));
  EXPECT_EQ(presetSettings("jensen").frame.estimator, Estimator::kKdtree);
  try {
    presetSettings("jenson");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadUsage);
    EXPECT_NE(std::string_view(error.what()).find("did you mean \"jensen\"?"), std::string_view::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace isophote

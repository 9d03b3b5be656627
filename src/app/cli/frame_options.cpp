// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/frame_options.h"

#include "base/files.h"
#include "render/quality.h"
#include "settings/apply.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace isophote::cli {
namespace {

const std::vector<SettingOption>& settingOptions() {
  static const std::vector<SettingOption> options{
      {"--width", "N", {"frame.width"}, "", "by the camera's shape"},
      {"--height", "N", {"frame.height"}, "", "720, or by the width and the camera's shape"},
      {"--aa", "N", {"frame.aa"}},
      {"--bounces", "N", {"frame.bounces"}},
      {"--estimator", "NAME", {"frame.estimator"}},
      {"--photons", "N", {"photon_trace.photons"}},
      {"--photons-stored", "N", {"photon_trace.photonsStored"}},
      {"--radius",
       "METRES",
       {"photon_volumes.radius", "photon_kdtree.radius", "photon_tiles.radius", "photon_clusters.radius",
        "photon_bvh.radius", "photon_quads.radius", "photon_directional.radius"},
       "Radius in which a photon is felt (volumes, tiles, clusters, quads, directional; bvh: the middle one) "
       "or photons are "
       "gathered (kdtree); 0: automatic."},
      {"--passes", "N", {"frame.passes"}},
      {"--time", "SECONDS", {"frame.seconds"}},
      {"--shadows", "NAME", {"direct.shadows"}},
      {"--subsample", "N", {"frame.subsample"}},
      {"--seed", "N", {"frame.seed"}},
  };
  return options;
}

std::uint32_t& passesIn(std::span<const Field> fields) {
  return *std::get<std::uint32_t*>(std::ranges::find(fields, "frame.passes", &Field::key)->value);
}

float secondsIn(std::span<const Field> fields) {
  return *std::get<float*>(std::ranges::find(fields, "frame.seconds", &Field::key)->value);
}

}  // namespace

void FrameOptions::addPresetTo(CLI::App& parser) {
  parser.add_option("--preset", preset, "Settings of a published system (isophote info --settings)")
      ->type_name("NAME")
      ->take_last();
  parser
      .add_option("--quality", quality,
                  "draft, preview or final: how many photons, pixels and passes; all other options hold over "
                  "it (isophote info --settings)")
      ->type_name("NAME")
      ->take_last();
}

void FrameOptions::addShortTo(CLI::App& parser) {
  RenderSettings defaults;
  addSettingOptions(parser, settingOptions(), fieldsOfGroups(defaults), given);
}

void FrameOptions::addSettingsTo(CLI::App& parser) {
  parser.add_option("--settings", settingsFile, "JSON file of settings")->type_name("FILE")->take_last();
  parser
      .add_option("--set", assignments,
                  "Any setting, for example photon_trace.photons=1e6; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

RenderSettings FrameOptions::presetOrDefaults() const {
  return preset.empty() ? RenderSettings{} : presetSettings(preset);
}

void FrameOptions::apply(std::span<const Field> fields, const Scene* scene,
                         const std::string& sceneName) const {
  if (scene)
    for (const auto& [key, value] : scene->settings)
      setSetting(fields, key, value, {ErrorKind::kBadInput, sceneName});
  constexpr std::uint32_t kNoneSet = 0;  // Which no one else can set.
  std::uint32_t passes = kNoneSet;
  if (!quality.empty()) {
    for (const std::string_view assignment : qualityNamed(quality).assignments)
      setFromAssignment(fields, assignment, {ErrorKind::kBadUsage, "--quality"});
    passes = std::exchange(passesIn(fields), kNoneSet);
  }
  if (!settingsFile.empty())
    setFromJson(fields, readFile(settingsFile), {ErrorKind::kBadInput, settingsFile.string()});
  applyGiven(fields, given);
  for (const std::string& assignment : assignments)
    setFromAssignment(fields, assignment, {ErrorKind::kBadUsage, "--set"});
  if (passesIn(fields) == kNoneSet) passesIn(fields) = secondsIn(fields) > 0.0f ? 1 : passes;
}

}  // namespace isophote::cli
